#include <gtest/gtest.h>

#include <random>

#include "sim/chip/usb_host/transactions.hpp"
#include "tests/chip/usb_bench.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::usb_test {
namespace {

using rigs::Bytes;
using rigs::UsbBench;
using usb::Fault;
using usb::Pid;
namespace bc = usb::buffer_control;
namespace in = usb::interrupt;
namespace reg = usb::reg;
namespace st = usb::sie_status;

/// The other end of the cable, for single transactions.
struct Wire : UsbBench, usb::HostEnd {
  explicit Wire(UsbErrata errata = {}) : UsbBench(errata), engine(wheel, controller) {
    controller.connect(this, now());
    engine.on_done([this](const usb::Transaction&, const usb::Result& r) { result = r; });
  }
  void pull_up_changed(bool on, Picoseconds) override { pulled_up = on; }
  void remote_wakeup(Picoseconds) override { ++wakeups; }

  void wait(Picoseconds duration) { wheel.advance_to(wheel.cycle_at(now() + duration)); }
  /// The driver enables the pull-up; the host resets.
  void attach() {
    write(reg::usb_muxing, 1);
    write(reg::usb_pwr, 4 | 8);
    write(reg::main_ctrl, 1);
    write(reg::sie_ctrl, usb::sie_ctrl::ep0_int_1buf | usb::sie_ctrl::pullup_en);
    reset_bus();
    write(reg::sie_status, 0xffffffff);
  }
  void reset_bus() {
    controller.begin_reset(now());
    wait(10 * ps_per_ms);
    controller.end_reset(now());
  }
  usb::Result transact(const usb::Transaction& transaction) {
    engine.start(transaction, now());
    while (engine.busy()) wheel.advance_to(wheel.next());
    if (now() < result.end) wait(result.end - now());
    return result;
  }
  usb::Result ask(std::uint8_t endpoint, Fault data = Fault::none, Fault hand = Fault::none) {
    return transact({.token = Pid::in,
                     .address = address,
                     .endpoint = endpoint,
                     .data = {},
                     .data_fault = data,
                     .handshake_fault = hand});
  }
  usb::Result give(std::uint8_t endpoint, const Bytes& bytes, bool data1 = false,
                   Fault data = Fault::none, Fault hand = Fault::none, Pid token = Pid::out) {
    usb::Transaction t{.token = token,
                       .address = address,
                       .endpoint = endpoint,
                       .data = {},
                       .data_fault = data,
                       .handshake_fault = hand};
    t.data.pid = data1 ? Pid::data1 : Pid::data0;
    t.data.size = bytes.size();
    std::copy(bytes.begin(), bytes.end(), t.data.bytes.begin());
    return transact(t);
  }
  usb::Result setup(const Bytes& bytes, bool data1 = false, Fault fault = Fault::none) {
    return give(0, bytes, data1, fault, Fault::none, Pid::setup);
  }
  /// EP3 IN and OUT, bulk.
  void open_ep3(std::uint32_t flags = 1u << 29) {
    store(0x08 + 8 * 2, 1u << 31 | flags | 2u << 26 | 0x400);
    store(0x0c + 8 * 2, 1u << 31 | flags | 2u << 26 | 0x500);
  }
  static constexpr std::uint32_t ep3_in = 6, ep3_out = 7;

  usb::TransactionEngine engine;
  usb::Result result;
  std::uint8_t address = 0;
  bool pulled_up = false;
  int wakeups = 0;
};

/// A wire to a device with EP3 IN and OUT.
struct OpenWire : Wire {
  explicit OpenWire(UsbErrata errata = {}, std::uint32_t flags = 1u << 29) : Wire(errata) {
    attach();
    open_ep3(flags);
  }
  explicit OpenWire(std::uint32_t flags) : OpenWire({}, flags) {}
};

const Bytes get_descriptor = {0x80, 6, 0, 1, 0, 0, 18, 0};

TEST(UsbController, PullsUpOnlyWhenEverythingIsConfigured) {
  const auto set = [](Wire& wire, unsigned parts) {
    if ((parts & 1) != 0) wire.write(reg::usb_muxing, 1);
    if ((parts & 2) != 0) wire.write(reg::usb_pwr, 12);
    if ((parts & 4) != 0) wire.write(reg::main_ctrl, 1);
    if ((parts & 8) != 0) wire.write(reg::sie_ctrl, usb::sie_ctrl::pullup_en);
  };
  for (unsigned parts = 0; parts < 16; ++parts) {
    Wire wire;
    set(wire, parts);
    EXPECT_EQ(wire.pulled_up, parts == 15) << parts;
  }
  Wire pin;
  set(pin, 13);
  pin.controller.set_vbus_pin(true);
  EXPECT_TRUE(pin.pulled_up);
  EXPECT_NE(pin.read(reg::sie_status) & st::vbus_detected, 0u);
  EXPECT_NE(pin.read(reg::intr) & in::vbus_detect, 0u);
  pin.controller.set_vbus_pin(false);
  EXPECT_FALSE(pin.pulled_up);
  // By the PHY's own bits, as the work-around of RP2040-E5 does.
  Wire direct;
  set(direct, 7);
  direct.write(reg::usbphy_direct, 2);
  direct.write(reg::usbphy_direct_override, 4);
  EXPECT_TRUE(direct.pulled_up);
  direct.write(reg::usbphy_direct, 0);
  EXPECT_FALSE(direct.pulled_up);
  EXPECT_TRUE(direct.unknown.empty());
  direct.controller.reset();
  EXPECT_EQ(direct.read(reg::usbphy_trim), 0x1f1fu);
  EXPECT_EQ(direct.read(reg::nak_poll), 0x100010u);
}

TEST(UsbController, HostModeIsRefusedByName) {
  Wire wire;
  for (std::uint32_t offset = 0; offset < 0xa0; offset += 4) wire.write(offset, 0);
  EXPECT_TRUE(wire.unknown.empty()) << "zeros request nothing";
  wire.write(reg::main_ctrl, 3);
  EXPECT_TRUE(wire.unknown.contains("USBCTRL_REGS host mode"));
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> more = {
      {reg::addr_endp1, 1},
      {reg::sof_wr, 1},
      {reg::int_ep_ctrl, 2},
      {reg::nak_poll, 1},
      {reg::sie_ctrl, 2},
      {reg::sie_ctrl, 1u << 26},
      {0x88, 1},
      {reg::usb_muxing, 4},
      {reg::usbphy_direct_override, 8}};
  for (std::size_t i = 0; i < more.size(); ++i) {
    wire.write(more[i].first, more[i].second);
    EXPECT_EQ(wire.unknown.size(), i + 2) << i;
  }
}

TEST(UsbController, BusResetConnectsAndInterrupts) {
  Wire wire;
  wire.attach();
  wire.write(reg::inte, in::bus_reset | in::dev_conn_dis);
  EXPECT_FALSE(wire.interrupt());
  wire.controller.begin_reset(wire.now());
  wire.wait(2 * ps_per_us);
  EXPECT_EQ(wire.read(reg::sie_status) & st::bus_reset, 0u) << "not long enough";
  EXPECT_EQ(wire.read(reg::sie_status) >> 2 & 3, 0u) << "SE0";
  wire.wait(ps_per_us);
  EXPECT_NE(wire.read(reg::sie_status) & st::bus_reset, 0u);
  EXPECT_EQ(wire.read(reg::sie_status) & st::connected, 0u);
  EXPECT_TRUE(wire.interrupt());
  EXPECT_EQ(wire.read(reg::ints), in::bus_reset | in::dev_conn_dis);
  wire.write(reg::sie_status, st::bus_reset);
  EXPECT_EQ(wire.read(reg::ints), in::dev_conn_dis);
  wire.write(reg::sie_status, st::connected);
  EXPECT_FALSE(wire.interrupt());
  wire.controller.end_reset(wire.now());
  EXPECT_NE(wire.read(reg::sie_status) & st::connected, 0u);
  EXPECT_EQ(wire.read(reg::sie_status) >> 2 & 3, 1u) << "J";
  EXPECT_TRUE(wire.interrupt());
  wire.write(reg::inte, 0);
  EXPECT_FALSE(wire.interrupt());
  wire.write(reg::intf, in::stall);
  EXPECT_EQ(wire.read(reg::ints), in::stall);
  EXPECT_TRUE(wire.interrupt());
}

TEST(UsbController, SetupIsAlwaysAccepted) {
  Wire wire;
  wire.attach();
  wire.write(reg::ep_stall_arm, 3);
  wire.store_half(0x80, bc::stall);
  wire.store_half(0x84, bc::stall);
  EXPECT_EQ(wire.ask(0).answer, Pid::stall);
  EXPECT_EQ(wire.give(0, {}).answer, Pid::stall);
  EXPECT_EQ(wire.setup(get_descriptor).answer, Pid::ack);
  EXPECT_TRUE(std::equal(get_descriptor.begin(), get_descriptor.end(), wire.dpram.begin()));
  EXPECT_EQ(wire.read(reg::ep_stall_arm), 0u);
  EXPECT_NE(wire.read(reg::sie_status) & st::setup_rec, 0u);
  EXPECT_NE(wire.read(reg::intr) & in::setup_req, 0u);
  EXPECT_EQ(wire.ask(0).answer, Pid::nak) << "the bit in the word no longer stalls by itself";
  wire.write(reg::sie_status, st::setup_rec);
  EXPECT_EQ(wire.read(reg::intr) & in::setup_req, 0u);

  EXPECT_FALSE(wire.setup(get_descriptor, true).answer) << "DATA1";
  EXPECT_NE(wire.read(reg::sie_status) & st::data_seq_error, 0u);
  EXPECT_FALSE(wire.setup(get_descriptor, false, Fault::crc).answer);
  EXPECT_NE(wire.read(reg::sie_status) & st::crc_error, 0u);
  EXPECT_FALSE(wire.setup({1, 2, 3}).answer);
  EXPECT_EQ(wire.read(reg::sie_status) & st::setup_rec, 0u);
  // A buffer of a transfer that the host has abandoned stays armed.
  wire.arm(0, 0, bc::full | bc::pid | 5);
  EXPECT_EQ(wire.setup(get_descriptor).answer, Pid::ack);
  EXPECT_EQ(wire.ask(0).answer, Pid::data1);
}

TEST(UsbController, AnswersItsAddressAndItsEndpointsOnly) {
  OpenWire wire;
  EXPECT_EQ(wire.ask(3).answer, Pid::nak);
  EXPECT_FALSE(wire.ask(4).answer);
  EXPECT_FALSE(wire.give(4, {1}).answer);
  wire.write(reg::addr_endp, 9);
  EXPECT_FALSE(wire.ask(3).answer);
  EXPECT_FALSE(wire.setup(get_descriptor).answer);
  wire.address = 9;
  EXPECT_EQ(wire.ask(3).answer, Pid::nak);
  wire.store(0x18, 1u << 31 | 1u << 26 | 0x400);
  EXPECT_FALSE(wire.ask(3).answer);
  EXPECT_TRUE(wire.unknown.contains("USBCTRL_REGS isochronous endpoint"));
}

TEST(UsbController, InPacket) {
  OpenWire wire;
  wire.write(reg::inte, in::buff_status | in::trans_complete);
  EXPECT_EQ(wire.ask(3).answer, Pid::nak);
  for (std::uint32_t i = 0; i < 64; ++i) wire.dpram[0x400 + i] = static_cast<std::uint8_t>(i);
  wire.arm(Wire::ep3_in, 0, bc::full | bc::pid | bc::last | 10);

  // The host receives garbage, then its ACK is lost: the packet stays.
  EXPECT_FALSE(wire.ask(3, Fault::crc).answer);
  EXPECT_NE(wire.read(reg::sie_status) & st::rx_timeout, 0u);
  EXPECT_EQ(wire.ask(3, Fault::none, Fault::lost).answer, Pid::data1);
  EXPECT_FALSE(wire.interrupt());
  EXPECT_EQ(wire.read(reg::sie_status) & st::ack_rec, 0u);

  const usb::Result result = wire.ask(3);
  EXPECT_EQ(result.answer, Pid::data1);
  EXPECT_EQ(result.data.size, 10u);
  EXPECT_EQ(result.data.bytes[9], 9);
  EXPECT_EQ(wire.load_half(UsbBench::control_word(Wire::ep3_in)), bc::pid | bc::last | 10);
  EXPECT_EQ(wire.read(reg::buff_status), 1u << Wire::ep3_in);
  EXPECT_EQ(wire.read(reg::buff_cpu_should_handle), 0u);
  EXPECT_NE(wire.read(reg::sie_status) & st::ack_rec, 0u);
  EXPECT_EQ(wire.read(reg::ints), in::buff_status | in::trans_complete);
  wire.write(reg::sie_status, st::trans_complete);
  EXPECT_TRUE(wire.interrupt());
  wire.write(reg::buff_status, 1u << Wire::ep3_in);
  EXPECT_FALSE(wire.interrupt());
  EXPECT_EQ(wire.ask(3).answer, Pid::nak);
  // FULL without AVAILABLE, or AVAILABLE without FULL, sends nothing.
  wire.store_half(UsbBench::control_word(Wire::ep3_in), bc::full | 3);
  EXPECT_EQ(wire.ask(3).answer, Pid::nak);
  wire.arm(Wire::ep3_in, 0, 3);
  EXPECT_EQ(wire.ask(3).answer, Pid::nak);
  EXPECT_TRUE(wire.controller.violations().empty());
}

TEST(UsbController, OutPacket) {
  OpenWire wire;
  const Bytes bytes = {1, 2, 3};
  EXPECT_EQ(wire.give(3, bytes).answer, Pid::nak);
  wire.arm(Wire::ep3_out, 0, 64);
  EXPECT_FALSE(wire.give(3, bytes, false, Fault::crc).answer);
  EXPECT_FALSE(wire.give(3, bytes, false, Fault::lost).answer);
  EXPECT_EQ(wire.read(reg::buff_status), 0u);
  EXPECT_FALSE(wire.give(3, bytes, false, Fault::none, Fault::lost).answer) << "ACK lost";
  EXPECT_EQ(wire.load_half(UsbBench::control_word(Wire::ep3_out)), bc::full | 3);
  EXPECT_EQ(wire.dpram[0x502], 3);
  EXPECT_EQ(wire.read(reg::buff_status), 1u << Wire::ep3_out);
  wire.write(reg::buff_status, 1u << Wire::ep3_out);
  wire.write(reg::sie_status, 0xffffffff);

  // The host retransmits: no room yet, then acknowledged and dropped.
  EXPECT_EQ(wire.give(3, bytes).answer, Pid::nak);
  wire.arm(Wire::ep3_out, 0, bc::pid | 64);
  wire.dpram[0x500] = 0x77;
  EXPECT_EQ(wire.give(3, bytes).answer, Pid::ack);
  EXPECT_NE(wire.read(reg::sie_status) & st::data_seq_error, 0u);
  EXPECT_EQ(wire.dpram[0x500], 0x77);
  EXPECT_EQ(wire.read(reg::buff_status), 0u);
  EXPECT_EQ(wire.give(3, {}, true).answer, Pid::ack) << "an empty packet is a packet";
  EXPECT_EQ(wire.load_half(UsbBench::control_word(Wire::ep3_out)), bc::full | bc::pid);

  wire.write(reg::buff_status, 1u << Wire::ep3_out);
  wire.arm(Wire::ep3_out, 0, bc::full | 64);
  EXPECT_EQ(wire.give(3, bytes).answer, Pid::nak) << "a full buffer accepts nothing";
  wire.store_half(UsbBench::control_word(Wire::ep3_out), bc::stall);
  EXPECT_EQ(wire.give(3, bytes).answer, Pid::stall);
  EXPECT_TRUE(wire.controller.violations().empty());
  wire.arm(Wire::ep3_out, 0, 2);
  EXPECT_EQ(wire.give(3, bytes).answer, Pid::ack);
  EXPECT_EQ(wire.controller.violations().size(), 1u) << "longer than the buffer";
}

TEST(UsbController, DoubleBuffersPingPong) {
  OpenWire wire(1u << 30 | 1u << 29);
  const std::uint32_t bit = 1u << Wire::ep3_out;
  wire.arm(Wire::ep3_out, 0, 64);
  wire.arm(Wire::ep3_out, 1, bc::pid | 64);
  EXPECT_EQ(wire.give(3, {1}).answer, Pid::ack);
  EXPECT_EQ(wire.read(reg::buff_cpu_should_handle) & bit, 0u);
  EXPECT_EQ(wire.give(3, {2}, true).answer, Pid::ack);
  EXPECT_EQ(wire.give(3, {3}).answer, Pid::nak) << "both are full";
  EXPECT_EQ(wire.dpram[0x500], 1);
  EXPECT_EQ(wire.dpram[0x540], 2);
  EXPECT_EQ(wire.read(reg::buff_cpu_should_handle) & bit, 0u);
  wire.write(reg::buff_status, bit);
  EXPECT_EQ(wire.read(reg::buff_status), bit) << "set again for the other buffer";
  EXPECT_EQ(wire.read(reg::buff_cpu_should_handle) & bit, bit);
  wire.write(reg::buff_status, bit);
  EXPECT_EQ(wire.read(reg::buff_status), 0u);

  // One packet through buffer 0: the select is then 1, where no buffer is armed.
  wire.arm(Wire::ep3_out, 0, 64);
  EXPECT_EQ(wire.give(3, {3}).answer, Pid::ack);
  wire.write(reg::buff_status, bit);
  wire.arm(Wire::ep3_out, 0, bc::pid | 64);
  EXPECT_EQ(wire.give(3, {4}, true).answer, Pid::nak);
  wire.arm(Wire::ep3_out, 0, bc::pid | bc::select_reset | 64);
  EXPECT_EQ(wire.give(3, {4}, true).answer, Pid::ack);
  EXPECT_EQ(wire.dpram[0x500], 4);
  EXPECT_EQ(wire.load_half(UsbBench::control_word(Wire::ep3_out)) & bc::select_reset, 0);
}

TEST(UsbController, SingleBufferDoesNotFlipTheSelect) {
  OpenWire wire;
  wire.arm(Wire::ep3_out, 0, 64);
  EXPECT_EQ(wire.give(3, {1}).answer, Pid::ack);
  wire.open_ep3(1u << 30 | 1u << 29);
  wire.arm(Wire::ep3_out, 0, bc::pid | 64);
  EXPECT_EQ(wire.give(3, {2}, true).answer, Pid::ack);
}

TEST(UsbController, InterruptPerTwoBuffersOrNone) {
  for (const std::uint32_t flags : {1u << 30 | 1u << 28, 1u << 30, 1u << 28}) {
    OpenWire wire(flags);
    wire.arm(Wire::ep3_in, 0, bc::full | 1);
    wire.arm(Wire::ep3_in, 1, bc::full | bc::pid | 1);
    EXPECT_EQ(wire.ask(3).answer, Pid::data0);
    EXPECT_EQ(wire.read(reg::buff_status), 0u);
    wire.ask(3);
    const bool reported = flags == (1u << 30 | 1u << 28);
    EXPECT_EQ(wire.read(reg::buff_status), reported ? 1u << Wire::ep3_in : 0u) << flags;
  }
}

TEST(UsbController, NakAndStallInterrupts) {
  OpenWire wire(1u << 29 | 1u << 17 | 1u << 16);
  wire.write(reg::inte, in::ep_stall_nak);
  wire.ask(3);
  EXPECT_EQ(wire.read(reg::ep_status_stall_nak), 1u << Wire::ep3_in);
  EXPECT_TRUE(wire.interrupt());
  wire.write(reg::ep_status_stall_nak, 1u << Wire::ep3_in);
  EXPECT_FALSE(wire.interrupt());
  wire.store_half(UsbBench::control_word(Wire::ep3_out), bc::stall);
  wire.give(3, {1});
  EXPECT_EQ(wire.read(reg::ep_status_stall_nak), 1u << Wire::ep3_out);
  wire.ask(0);
  EXPECT_EQ(wire.read(reg::ep_status_stall_nak) & 1, 0u);
  wire.write(reg::sie_ctrl, wire.read(reg::sie_ctrl) | usb::sie_ctrl::ep0_int_nak);
  wire.ask(0);
  EXPECT_EQ(wire.read(reg::ep_status_stall_nak) & 1, 1u);
}

TEST(UsbController, AbortTakesABufferBack) {
  for (const bool e2 : {false, true}) {
    UsbErrata errata;
    errata.e2_abort_sticks = e2;
    OpenWire wire(errata);
    const std::uint32_t bit = 1u << Wire::ep3_in;
    wire.arm(Wire::ep3_in, 0, bc::full | 1);
    wire.write(reg::ep_abort, bit);
    EXPECT_EQ(wire.read(reg::ep_abort_done), bit);
    EXPECT_NE(wire.read(reg::intr) & in::abort_done, 0u);
    EXPECT_EQ(wire.ask(3).answer, Pid::nak);
    wire.write(reg::ep_abort_done, bit);
    EXPECT_EQ(wire.read(reg::ep_abort_done), 0u);
    wire.write(reg::ep_abort, 0);
    EXPECT_EQ(wire.ask(3).answer, e2 ? Pid::nak : Pid::data0);
  }
  // During a transaction the abort waits for its end.
  OpenWire wire;
  wire.arm(Wire::ep3_out, 0, 64);
  wire.engine.start({.token = Pid::out, .endpoint = 3, .data = {}}, wire.now());
  wire.wait(3 * ps_per_us);
  wire.write(reg::ep_abort, 1u << Wire::ep3_out);
  EXPECT_EQ(wire.read(reg::ep_abort_done), 0u);
  wire.wait(20 * ps_per_us);
  EXPECT_EQ(wire.read(reg::ep_abort_done), 1u << Wire::ep3_out);
}

TEST(UsbController, FramesAreCounted) {
  Wire wire;
  wire.attach();
  wire.write(reg::inte, in::dev_sof);
  wire.controller.start_of_frame(0x7ff, wire.now());
  EXPECT_TRUE(wire.interrupt());
  EXPECT_EQ(wire.controller.peek(reg::sof_rd), 0x7ffu);
  EXPECT_TRUE(wire.interrupt()) << "peeking clears nothing";
  EXPECT_EQ(wire.read(reg::sof_rd), 0x7ffu);
  EXPECT_FALSE(wire.interrupt());
}

TEST(UsbController, SleepsAfterThreeMillisecondsAndWakesByResumeOnly) {
  Wire wire;
  wire.attach();
  wire.write(reg::inte, in::dev_suspend | in::dev_resume_from_host);
  for (std::uint16_t i = 0; i < 5; ++i) {
    wire.wait(ps_per_ms);
    wire.controller.start_of_frame(i, wire.now());
  }
  EXPECT_FALSE(wire.interrupt());
  wire.wait(ps_per_ms);
  wire.wheel.set_frequency(48'000'000);  // idle time is real time
  wire.wait(2 * ps_per_ms - ps_per_us);
  EXPECT_EQ(wire.read(reg::sie_status) & st::suspended, 0u);
  wire.wait(2 * ps_per_us);
  EXPECT_NE(wire.read(reg::sie_status) & st::suspended, 0u);
  EXPECT_EQ(wire.read(reg::ints), in::dev_suspend);
  wire.write(reg::sie_status, st::suspended);
  EXPECT_FALSE(wire.interrupt());
  EXPECT_NE(wire.read(reg::sie_status) & st::suspended, 0u) << "still asleep";
  EXPECT_FALSE(wire.ask(0).answer);

  wire.write(reg::sie_ctrl, wire.read(reg::sie_ctrl) | usb::sie_ctrl::resume);
  EXPECT_EQ(wire.wakeups, 1);
  EXPECT_EQ(wire.read(reg::sie_ctrl) & usb::sie_ctrl::resume, 0u) << "clears itself";
  wire.controller.begin_resume(wire.now());
  wire.wait(ps_per_ms);
  EXPECT_EQ(wire.read(reg::sie_status) >> 2 & 3, 2u) << "K";
  EXPECT_EQ(wire.read(reg::sie_status) & st::suspended, 0u);
  EXPECT_NE(wire.read(reg::ints) & in::dev_resume_from_host, 0u);
  wire.write(reg::sie_status, st::resume | st::suspended);
  EXPECT_FALSE(wire.interrupt());
  wire.controller.end_resume(wire.now());
  EXPECT_EQ(wire.ask(0).answer, Pid::nak);
}

TEST(UsbController, BrokenPacketHangsItUntilReset) {
  for (const bool e15 : {true, false}) {
    UsbErrata errata;
    errata.e15_broken_packet_hangs = e15;
    OpenWire wire(errata);
    wire.arm(Wire::ep3_in, 0, bc::full | 4);
    wire.ask(3, Fault::none, Fault::bit_stuff);
    EXPECT_NE(wire.read(reg::sie_status) & st::bit_stuff_error, 0u);
    EXPECT_EQ(wire.controller.hung(), e15);
    EXPECT_EQ(wire.ask(3).answer.has_value(), !e15);
    wire.reset_bus();
    EXPECT_EQ(wire.setup(get_descriptor).answer.has_value(), !e15);
    wire.controller.reset();
    wire.attach();
    EXPECT_EQ(wire.setup(get_descriptor).answer, Pid::ack);
  }
}

TEST(UsbController, AvailableTogetherWithItsFieldsIsReported) {
  Wire wire;
  wire.arm(Wire::ep3_in, 0, bc::full | 4);
  wire.arm(Wire::ep3_in, 1, bc::full | bc::pid | 4);
  EXPECT_TRUE(wire.controller.violations().empty());
  // A write of the same fields is safe.
  wire.store_half(UsbBench::control_word(Wire::ep3_in), bc::full | 4);
  wire.wait(ps_per_us);
  wire.store_half(UsbBench::control_word(Wire::ep3_in), bc::full | bc::available | 4);
  EXPECT_TRUE(wire.controller.violations().empty());
  wire.store_half(UsbBench::control_word(Wire::ep3_out), bc::available | 64);
  ASSERT_EQ(wire.controller.violations().size(), 1u);
  EXPECT_NE(wire.controller.violations()[0].find("EP3 OUT buffer 0"), std::string::npos);
  wire.store_half(UsbBench::control_word(8), 64);
  wire.wheel.advance_to(wire.wheel.now() + 2);
  wire.store_half(UsbBench::control_word(8), bc::available | 64);
  EXPECT_EQ(wire.controller.violations().size(), 2u) << "16 ns are less than a cycle";
  wire.wheel.set_frequency(48'000'000);
  wire.store_half(UsbBench::control_word(9), bc::available | 64);
  EXPECT_EQ(wire.controller.violations().size(), 2u) << "the rule does not apply at the same clock";
}

TEST(UsbController, NeedsItsClock) {
  Wire wire;
  wire.controller.set_usb_clock(0);
  wire.attach();
  EXPECT_FALSE(wire.setup(get_descriptor).answer);
  EXPECT_EQ(wire.controller.violations().size(), 1u);
  wire.controller.set_usb_clock(48'000'000);
  EXPECT_EQ(wire.setup(get_descriptor).answer, Pid::ack);
}

TEST(UsbController, WriteClearBitsAreDeclared) {
  const Wire wire;
  EXPECT_EQ(wire.controller.write_clear_bits(reg::buff_status), 0xffffffffu);
  EXPECT_NE(wire.controller.write_clear_bits(reg::sie_status) & st::bus_reset, 0u);
  EXPECT_EQ(wire.controller.write_clear_bits(reg::inte), 0u);
}

/// Any mixture of packets, faults and arming, against the rules of USB 2.0, 8.6: each side counts
/// the packets that it believes delivered, and both agree.
TEST(UsbController, TogglesKeepBothEndsInStep) {
  for (int seed = 0; seed < test::scaled(20); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    UsbErrata errata;
    errata.e15_broken_packet_hangs = false;
    Wire wire(errata);
    wire.attach();
    const bool doubled = seed % 2 == 0;
    wire.open_ep3(1u << 29 | (doubled ? 1u << 30 : 0));
    Bytes sent, received, produced, collected;
    bool host_out1 = false, host_in1 = false, device_out1 = false, device_in1 = false;
    std::uint32_t out_buffer = 0, in_buffer = 0, out_armed = 0, in_armed = 0;
    std::uint8_t next = 0;
    const auto fault = [&] {
      return random() % 4 == 0 ? static_cast<Fault>(1 + random() % 3) : Fault::none;
    };
    for (int i = 0; i < 2000; ++i) {
      const std::uint32_t buffers = doubled ? 2 : 1;
      if (random() % 2 == 0 && out_armed < buffers) {
        wire.arm(Wire::ep3_out, out_buffer, 64u | (device_out1 ? bc::pid : 0u));
        device_out1 = !device_out1;
        out_buffer = (out_buffer + 1) % buffers;
        ++out_armed;
      }
      if (random() % 2 == 0 && in_armed < buffers) {
        wire.dpram[0x400 + 64 * in_buffer] = ++next;
        produced.push_back(next);
        wire.arm(Wire::ep3_in, in_buffer, 1u | bc::full | (device_in1 ? bc::pid : 0u));
        device_in1 = !device_in1;
        in_buffer = (in_buffer + 1) % buffers;
        ++in_armed;
      }
      if (random() % 2 == 0) {
        const auto value = static_cast<std::uint8_t>(sent.size());
        if (wire.give(3, {value}, host_out1, fault(), fault()).answer == Pid::ack) {
          sent.push_back(value);
          host_out1 = !host_out1;
        }
      } else {
        const usb::Result result = wire.ask(3, fault(), fault());
        const Pid expected = host_in1 ? Pid::data1 : Pid::data0;
        if (result.answer == expected) {
          collected.push_back(result.data.bytes[0]);
          host_in1 = !host_in1;
        }
      }
      while (wire.read(reg::buff_status) != 0) {
        const std::uint32_t status = wire.read(reg::buff_status);
        const std::uint32_t index =
            (status & 1u << Wire::ep3_in) != 0 ? Wire::ep3_in : Wire::ep3_out;
        const std::uint32_t buffer = wire.read(reg::buff_cpu_should_handle) >> index & 1;
        if (index == Wire::ep3_in) --in_armed;
        if (index == Wire::ep3_out) {
          --out_armed;
          received.push_back(wire.dpram[0x500 + 64 * buffer]);
        }
        wire.write(reg::buff_status, 1u << index);
      }
    }
    ASSERT_GT(sent.size(), 100u);
    // The last packet may have arrived with its ACK lost.
    if (received.size() == sent.size() + 1) received.pop_back();
    EXPECT_EQ(received, sent) << seed;
    ASSERT_GT(collected.size(), 100u);
    produced.resize(collected.size());
    EXPECT_EQ(collected, produced) << seed;
  }
}

TEST(UsbTransactions, TakeTheirTimeOnTheBus) {
  // USB 2.0, table 5-9: 19 packets of 64 bytes in a frame, 71 of 8 bytes.
  EXPECT_EQ(12000 / usb::transaction_bits(64), 19);
  EXPECT_EQ(12000 / usb::transaction_bits(8), 71);
  OpenWire wire;
  wire.arm(Wire::ep3_in, 0, bc::full | 64);
  const Picoseconds start = wire.now();
  EXPECT_NEAR(static_cast<double>(wire.ask(3).end - start),
              static_cast<double>(usb::bit_times(usb::transaction_bits(64))), 10.0);
  const Picoseconds again = wire.now();
  EXPECT_NEAR(static_cast<double>(wire.ask(3).end - again), static_cast<double>(usb::bit_times(64)),
              10.0)
      << "NAK";
}

}  // namespace
}  // namespace lamplock::sim::chip::usb_test
