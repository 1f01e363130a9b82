// The boot ROM's USB loader on a whole chip, with a host that sends PICOBOOT commands (RP2040
// datasheet, 2.8.5): from a chip without a program to a chip that runs the host's program.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "shared/boards/boot2_crc32.hpp"
#include "sim/chip/chip.hpp"
#include "sim/chip/usb_host/usb_host.hpp"
#include "sim/chip/usb_host/vendor_host.hpp"

namespace lamplock::sim::chip::rom_usb_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using picoboot::Command;
using picoboot::Status;
using End = VendorHost::End;

constexpr std::uint32_t flash = 0x1000'0000, sram = 0x2000'0000;
/// Waiting time for events that must not occur.
constexpr Picoseconds silence = 50 * ps_per_ms;
constexpr std::uint8_t to_interface = 0x41, from_interface = 0xc1;

/// The flashing program's side of the protocol.
class RomUsb : public testing::Test {
 protected:
  RomUsb() { chip_.power_on(); }

  /// An empty flash: the ROM gives up after half a second.
  void enter() {
    run(700 * ps_per_ms);
    ASSERT_EQ(chip_.rom().state(), RomState::bootsel);
    ASSERT_TRUE(host_.enumerate());
  }
  void run(Picoseconds time) { host_.wait(time); }
  Picoseconds now() const { return chip_.time(); }

  VendorHost::Transfer send(Command command, const std::vector<std::uint32_t>& arguments,
                            std::uint32_t transfer, int size = -1,
                            std::uint32_t magic = picoboot::magic) {
    Bytes packet(picoboot::command_size);
    const auto put = [&](std::size_t at, std::uint32_t value) {
      for (std::size_t i = 0; i < 4; ++i)
        packet[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
    };
    put(0, magic);
    put(4, ++token_);
    packet[8] = static_cast<std::uint8_t>(command);
    packet[9] =
        static_cast<std::uint8_t>(size >= 0 ? size : static_cast<int>(4 * arguments.size()));
    put(12, transfer);
    for (std::size_t i = 0; i < arguments.size(); ++i) put(16 + 4 * i, arguments[i]);
    return host_.bulk_out(UsbLoader::out_endpoint, packet);
  }
  /// Sends a command without data; returns the result of its empty IN packet.
  End order(Command command, const std::vector<std::uint32_t>& arguments, int size = -1) {
    const VendorHost::Transfer sent = send(command, arguments, 0, size);
    if (!sent.done()) return sent.end;
    const VendorHost::Transfer answer = host_.bulk_in(UsbLoader::in_endpoint, 64);
    EXPECT_TRUE(answer.data.empty());
    return answer.end;
  }
  End write(std::uint32_t address, const Bytes& data) {
    const auto size = static_cast<std::uint32_t>(data.size());
    if (const auto sent = send(Command::write, {address, size}, size); !sent.done())
      return sent.end;
    if (const auto sent = host_.bulk_out(UsbLoader::out_endpoint, data); !sent.done())
      return sent.end;
    return host_.bulk_in(UsbLoader::in_endpoint, 64).end;
  }
  Bytes read(std::uint32_t address, std::uint32_t size) {
    EXPECT_TRUE(send(Command::read, {address, size}, size).done());
    const VendorHost::Transfer answer = host_.bulk_in(UsbLoader::in_endpoint, size);
    EXPECT_TRUE(answer.done());
    EXPECT_TRUE(host_.bulk_out(UsbLoader::out_endpoint, {}).done());
    return answer.data;
  }
  struct CommandStatus {
    std::uint32_t token = 0;
    Status code = Status::ok;
    std::uint8_t command = 0, in_progress = 0;
  };
  CommandStatus status() {
    const VendorHost::Transfer answer = host_.control({from_interface, 0x42, 0, 0, 0, 0, 16, 0});
    EXPECT_EQ(answer.data.size(), picoboot::status_size);
    if (answer.data.size() != picoboot::status_size) return {};
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      std::memcpy(&value, answer.data.data() + at, 4);
      return value;
    };
    return {word(0), static_cast<Status>(word(4)), answer.data[8], answer.data[9]};
  }
  /// Recovers as a host does after a stall.
  void recover() {
    EXPECT_TRUE(host_.clear_halt(0x80 | UsbLoader::in_endpoint));
    EXPECT_TRUE(host_.clear_halt(UsbLoader::out_endpoint));
    EXPECT_TRUE(host_.control({to_interface, 0x41, 0, 0, 0, 0, 0, 0}).done());
  }
  /// Checks the status of the last command; the next command must work.
  void check_status(Status why) {
    const CommandStatus found = status();
    EXPECT_EQ(found.code, why) << static_cast<int>(found.command);
    EXPECT_EQ(found.token, token_);
    EXPECT_EQ(found.in_progress, 0);
    recover();
    EXPECT_EQ(order(Command::exclusive_access, {0}, 1), End::done) << "works again";
  }
  /// An invalid command halts both endpoints.
  void refused(Command command, const std::vector<std::uint32_t>& arguments, Status why,
               std::uint32_t transfer = 0, int size = -1) {
    send(command, arguments, transfer, size);
    EXPECT_EQ(host_.bulk_in(UsbLoader::in_endpoint, 64).end, End::stalled);
    EXPECT_EQ(host_.bulk_out(UsbLoader::out_endpoint, {}).end, End::stalled);
    check_status(why);
  }
  /// Unreadable data halt only IN.
  void read_refused(std::uint32_t address, std::uint32_t size, Status why) {
    ASSERT_TRUE(send(Command::read, {address, size}, size).done());
    host_.set_timeout(silence);
    EXPECT_EQ(host_.bulk_in(UsbLoader::in_endpoint, size).end, End::stalled);
    EXPECT_EQ(host_.bulk_out(UsbLoader::out_endpoint, {}).end, End::timed_out);
    check_status(why);
  }
  /// Unwritable data halt only OUT, after 256 bytes: with the last 256 bytes all data are accepted,
  /// and the end is missing.
  void write_refused(std::uint32_t address, std::uint32_t size, bool by_the_last, Status why) {
    ASSERT_TRUE(send(Command::write, {address, size}, size).done());
    EXPECT_EQ(host_.bulk_out(UsbLoader::out_endpoint, noise(size)).end,
              by_the_last ? End::done : End::stalled);
    host_.set_timeout(silence);
    EXPECT_EQ(host_.bulk_in(UsbLoader::in_endpoint, 64).end, End::timed_out);
    EXPECT_EQ(host_.bulk_out(UsbLoader::out_endpoint, {}).end, End::stalled);
    check_status(why);
  }
  /// A function of the flash, at sram + 0x2000, that fails with `result` at one offset.
  void fail_at(picoboot::Service service, std::uint32_t offset, std::uint8_t result) {
    ASSERT_EQ(order(Command::vectorize_flash, {sram + 0x1000}), End::done);
    // LDR r2, [pc, #12]; MOVS r1, #0; CMP r0, r2; BNE 1f; MOVS r1, #result; 1: MOVS r0, r1; BX LR.
    const std::array<std::uint16_t, 8> code = {
        0x4a03, 0x2100, 0x4290, 0xd100, static_cast<std::uint16_t>(0x2100 | result),
        0x0008, 0x4770, 0x46c0};
    Bytes function(sizeof code + 4), entry(4);
    std::memcpy(function.data(), code.data(), sizeof code);
    std::memcpy(function.data() + sizeof code, &offset, 4);
    ASSERT_EQ(write(sram + 0x2000, function), End::done);
    const std::uint32_t at = sram + 0x2001;
    std::memcpy(entry.data(), &at, 4);
    ASSERT_EQ(write(sram + 0x1004 + 4 * static_cast<std::uint32_t>(service), entry), End::done);
  }
  Bytes noise(std::size_t size) {
    Bytes bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random_());
    return bytes;
  }

  Chip chip_;
  VendorHost host_{chip_.wheel(), chip_.usb(), [this](Cycle to) { chip_.run_until(to); }};
  std::uint32_t token_ = 100;
  std::mt19937_64 random_{21};
};

TEST_F(RomUsb, EnumeratesAsTheDatasheetSays) {  // 2.8.5.1 to 2.8.5.3
  enter();
  const Bytes& device = host_.device_descriptor();
  ASSERT_EQ(device.size(), 18u);
  EXPECT_EQ(device[8] | device[9] << 8, 0x2e8a);
  EXPECT_EQ(device[10] | device[11] << 8, 0x0003);
  EXPECT_EQ(device[2] | device[3] << 8, 0x0110);
  const Bytes& configuration = host_.configuration_descriptor();
  ASSERT_EQ(configuration.size(), 32u);
  EXPECT_EQ(configuration[4], 1) << "one interface";
  EXPECT_EQ(configuration[9 + 5], 0xff) << "vendor specific";
  EXPECT_EQ(configuration[9 + 6] | configuration[9 + 7], 0);
  EXPECT_EQ(configuration[9 + 4], 2) << "two bulk endpoints";
  // Strings, and an unknown request.
  const VendorHost::Transfer name = host_.control({0x80, 6, 2, 3, 9, 4, 255, 0});
  EXPECT_EQ(name.data.size(), 2u + 2 * 8);
  EXPECT_EQ(host_.control({0x80, 6, 9, 3, 9, 4, 255, 0}).end, End::stalled);
  EXPECT_EQ(host_.control({0x80, 6, 0, 6, 0, 0, 10, 0}).end, End::stalled) << "full speed only";
  EXPECT_TRUE(chip_.usb().violations().empty());
  ASSERT_EQ(chip_.not_modelled().size(), 1u);
  EXPECT_EQ(chip_.not_modelled()[0],
            "ROM USB boot loader: mass storage (UF2) is not modelled, PICOBOOT only");
}

TEST_F(RomUsb, WritesAndReadsMemory) {
  enter();
  for (const std::uint32_t size : {1u, 63u, 64u, 65u, 128u, 1000u}) {
    const Bytes data = noise(size);
    ASSERT_EQ(write(sram + 0x40 + size, data), End::done) << size;
    EXPECT_EQ(read(sram + 0x40 + size, size), data) << size;
    EXPECT_EQ(status().code, Status::ok);
  }
  // The host may write all of SRAM: the loader's stack and buffers are in the controller's memory.
  const Bytes all = noise(264 * 1024);
  ASSERT_EQ(write(sram, all), End::done);
  EXPECT_EQ(read(sram, 264 * 1024), all);
  const Bytes rom = read(0, 16 * 1024);
  EXPECT_TRUE(std::equal(rom.begin(), rom.end(), chip_.bus().rom().begin()));
  EXPECT_TRUE(chip_.usb().violations().empty());
}

TEST_F(RomUsb, ErasesProgramsAndReadsFlash) {
  enter();
  const std::span<std::uint8_t> storage = chip_.flash().storage();
  for (std::size_t i = 0; i < 0x40000; ++i) storage[i] = static_cast<std::uint8_t>(random_());
  const Bytes before(storage.begin(), storage.begin() + 0x40000);
  ASSERT_EQ(order(Command::exclusive_access, {1}, 1), End::done);
  ASSERT_EQ(order(Command::exit_xip, {}), End::done);

  const Picoseconds begin = now();
  ASSERT_EQ(order(Command::flash_erase, {flash + 0x8000, 0x2000}), End::done);
  EXPECT_GE(now() - begin, 2 * 45 * ps_per_ms) << "two sectors";
  EXPECT_LE(now() - begin, 95 * ps_per_ms);
  const Bytes data = noise(1000);
  ASSERT_EQ(write(flash + 0x8100, data), End::done);
  Bytes wanted = before;
  std::fill_n(wanted.begin() + 0x8000, 0x2000, std::uint8_t{0xff});
  std::copy(data.begin(), data.end(), wanted.begin() + 0x8100);
  // 2.8.5.4.5: the last page is padded with zeros.
  std::fill_n(wanted.begin() + 0x8100 + 1000, 24, std::uint8_t{0});
  EXPECT_TRUE(std::equal(wanted.begin(), wanted.end(), storage.begin()));

  EXPECT_EQ(read(flash + 0x8000, 700),
            Bytes(wanted.begin() + 0x8000, wanted.begin() + 0x8000 + 700));
  // A block of 64 KiB is erased at once.
  const Picoseconds block = now();
  ASSERT_EQ(order(Command::flash_erase, {flash + 0x1'0000, 0x1'0000}), End::done);
  EXPECT_LE(now() - block, 155 * ps_per_ms);
  EXPECT_EQ(order(Command::enter_command_xip, {}), End::done);
  EXPECT_EQ(chip_.bus().read(flash + 0x8100, Width::byte, Master::core0, chip_.now()).value,
            data[0]);
  EXPECT_TRUE(chip_.usb().violations().empty());
}

TEST_F(RomUsb, StatusIsReadWhileTheFlashIsBusy) {
  enter();
  ASSERT_EQ(order(Command::exit_xip, {}), End::done);
  ASSERT_TRUE(send(Command::flash_erase, {flash, 0x1000}, 0).done());
  const CommandStatus busy = status();
  EXPECT_EQ(busy.in_progress, 1);
  EXPECT_EQ(busy.command, 0x03);
  EXPECT_EQ(busy.token, token_);
  EXPECT_EQ(host_.bulk_in(UsbLoader::in_endpoint, 64).end, End::done);
  EXPECT_EQ(status().in_progress, 0);
  // After a reset of the interface during an erase the next command waits for the flash.
  ASSERT_TRUE(send(Command::flash_erase, {flash, 0x1000}, 0).done());
  EXPECT_TRUE(host_.control({to_interface, 0x41, 0, 0, 0, 0, 0, 0}).done());
  EXPECT_EQ(status().token, 0u);
  EXPECT_EQ(order(Command::exit_xip, {}), End::done);
  EXPECT_EQ(read(flash, 16), Bytes(16, 0xff));
}

TEST_F(RomUsb, RefusesWithTheStatusThatFits) {
  enter();
  refused(static_cast<Command>(0x55), {}, Status::unknown_command);
  refused(Command::exec, {sram}, Status::unknown_command);
  EXPECT_EQ(chip_.not_modelled().back(), "ROM USB boot loader: PICOBOOT EXEC refused");
  refused(Command::exit_xip, {}, Status::invalid_command_length, 0, 4);
  refused(Command::read, {sram, 64}, Status::invalid_transfer_length, 32);
  refused(Command::exit_xip, {}, Status::invalid_transfer_length, 1);
  for (const std::uint32_t size : {4u, 256u, 257u, 1'000u}) {
    const bool by_the_last = size <= 256;
    read_refused(0x4000'0000, size, Status::invalid_address);
    read_refused(flash + 1, size, Status::bad_alignment);
    write_refused(0, size, by_the_last, Status::invalid_address);
    write_refused(0x4000'0000, size, by_the_last, Status::invalid_address);
    write_refused(flash + 1, size, by_the_last, Status::bad_alignment);
  }
  // At the end of a region the part that fits is transferred.
  read_refused(sram + 264 * 1024 - 256, 257, Status::invalid_address);
  write_refused(sram + 264 * 1024 - 256, 257, true, Status::invalid_address);
  // A command without data is acknowledged.
  chip_.flash().storage()[0] = 0x55;
  for (const auto& [address, size] :
       {std::pair{flash + 256, 4096u}, {flash, 100u}, {sram, 4096u}}) {
    EXPECT_EQ(order(Command::flash_erase, {address, size}), End::done);
    EXPECT_EQ(status().code, Status::ok);
  }
  EXPECT_EQ(chip_.flash().counts().sectors_erased, 0u);
  EXPECT_EQ(chip_.flash().storage()[0], 0x55);
  EXPECT_EQ(order(Command::vectorize_flash, {sram + 1}), End::done);
  EXPECT_EQ(order(Command::vectorize_flash, {flash}), End::done);
  EXPECT_EQ(status().code, Status::ok);
  // A wrong magic number, and an invalid command.
  send(Command::exit_xip, {}, 0, 0, 0x431f'd10c);
  EXPECT_EQ(host_.bulk_in(UsbLoader::in_endpoint, 64).end, End::stalled);
  recover();
  host_.bulk_out(UsbLoader::out_endpoint, Bytes(31));
  EXPECT_EQ(host_.bulk_in(UsbLoader::in_endpoint, 64).end, End::stalled);
  // Without clearing the halts, the interface's reset is enough (2.8.5.5.1).
  EXPECT_TRUE(host_.control({to_interface, 0x41, 0, 0, 0, 0, 0, 0}).done());
  EXPECT_EQ(order(Command::exclusive_access, {0}, 1), End::done);
}

TEST_F(RomUsb, FlashesAProgramThatThenRuns) {
  enter();
  // boot2: LDR r0, [pc, #4]; LDR r1, [pc, #8]; STR r1, [r0]; B .
  Bytes program(256);
  const std::array<std::uint16_t, 4> code = {0x4801, 0x4902, 0x6001, 0xe7fe};
  std::memcpy(program.data(), code.data(), sizeof code);
  const std::array<std::uint32_t, 2> words = {sram + 0x100, 0x600d'f00d};
  std::memcpy(program.data() + 8, words.data(), sizeof words);
  const std::uint32_t crc = boards::boot2_crc32(std::span(program).first(252));
  std::memcpy(program.data() + 252, &crc, 4);

  ASSERT_EQ(order(Command::exit_xip, {}), End::done);
  ASSERT_EQ(order(Command::flash_erase, {flash, 0x1000}), End::done);
  ASSERT_EQ(write(flash, program), End::done);
  EXPECT_EQ(read(flash, 256), program);
  const Picoseconds asked = now();
  ASSERT_EQ(order(Command::reboot, {0, 0, 20}), End::done);
  ASSERT_EQ(order(Command::exit_xip, {}), End::done) << "acknowledged, not done";
  ASSERT_TRUE(send(Command::read, {flash, 4}, 4).done());
  EXPECT_EQ(host_.bulk_in(UsbLoader::in_endpoint, 4).end, End::stalled);
  EXPECT_EQ(status().code, Status::rebooting);
  while (chip_.rom().state() == RomState::bootsel && now() < asked + 100 * ps_per_ms)
    run(ps_per_ms / 10);
  EXPECT_NEAR(static_cast<double>(now() - asked) / ps_per_ms, 10, 1)
      << "half of dDelayMS (2.8.5.4.2), by erratum E1";
  run(20 * ps_per_ms);
  EXPECT_FALSE(host_.connected());
  EXPECT_EQ(chip_.rom().state(), RomState::running);
  EXPECT_EQ(chip_.bus().read(sram + 0x100, Width::word, Master::core0, chip_.now()).value,
            0x600d'f00du);
}

TEST_F(RomUsb, RebootsIntoRam) {
  enter();
  const Bytes code = {0xfe, 0xe7};  // B .
  ASSERT_EQ(write(sram + 0x2000, code), End::done);
  ASSERT_EQ(order(Command::reboot, {sram + 0x2001, sram + 0x8000, 1}), End::done);
  run(10 * ps_per_ms);
  EXPECT_EQ(chip_.core(0).reg(15), sram + 0x2000);
  EXPECT_EQ(chip_.core(0).reg(13), sram + 0x8000);
}

TEST_F(RomUsb, FlashFunctionsCanBeReplaced) {  // 2.8.5.4.9
  enter();
  ASSERT_EQ(order(Command::vectorize_flash, {sram + 0x1000}), End::done);
  const Bytes table = read(sram + 0x1000, 28);
  std::uint32_t size = 0;
  std::memcpy(&size, table.data(), 4);
  EXPECT_EQ(size, 28u);
  // The range erase becomes: LDR r2, [pc, #4]; STR r1, [r2]; MOVS r0, #0; BX LR; the address.
  const std::array<std::uint16_t, 4> code = {0x4a01, 0x6011, 0x2000, 0x4770};
  Bytes function(12);
  std::memcpy(function.data(), code.data(), sizeof code);
  const std::uint32_t mark = sram + 0x3000, at = sram + 0x2001;
  std::memcpy(function.data() + 8, &mark, 4);
  ASSERT_EQ(write(sram + 0x2000, function), End::done);
  Bytes address(4);
  std::memcpy(address.data(), &at, 4);
  ASSERT_EQ(write(sram + 0x1000 + 16, address), End::done);
  ASSERT_EQ(order(Command::flash_erase, {flash, 0x3000}), End::done);
  EXPECT_EQ(read(mark, 4), (Bytes{0, 0x30, 0, 0}));
  EXPECT_EQ(chip_.flash().counts().sectors_erased, 0u);
}

TEST_F(RomUsb, TheResultOfAFlashFunctionIsTheStatus) {
  enter();
  ASSERT_EQ(order(Command::exit_xip, {}), End::done);
  for (std::uint8_t result = 1; result <= 17; ++result)
    for (const std::uint32_t page : {0u, 2u}) {  // the first of three, the last
      const auto why = static_cast<Status>(result);
      fail_at(picoboot::Service::page_program, 0x8000 + 256 * page, result);
      write_refused(flash + 0x8000, 600, page == 2, why);
      fail_at(picoboot::Service::page_read, 0x8000 + 256 * page, result);
      read_refused(flash + 0x8000, 600, why);
      fail_at(picoboot::Service::erase_range, 0x8000, result);
      EXPECT_EQ(order(Command::flash_erase, {flash + 0x8000, 4096}), End::done);
      EXPECT_EQ(status().code, Status::ok);
    }
  EXPECT_TRUE(chip_.usb().violations().empty());
}

TEST(RomUsbOrdinaryHost, FindsADeviceWithoutASerialPort) {
  Chip chip;
  UsbHost host(chip.wheel(), chip.usb());
  chip.power_on();
  while (!host.failed() && !host.enumerated() && chip.time() < 2'000 * ps_per_ms)
    chip.run_until(chip.wheel().cycle_at(chip.time() + ps_per_ms));
  EXPECT_EQ(chip.rom().state(), RomState::bootsel);
  EXPECT_EQ(host.device_info().vendor, UsbLoader::vendor);
  EXPECT_EQ(host.device_info().product, UsbLoader::product);
  EXPECT_FALSE(host.port().found());
  EXPECT_FALSE(host.enumerated());
  // Each attempt reports the same four missing properties of a serial port, and no others.
  const std::set<std::string> texts(host.violations().begin(), host.violations().end());
  EXPECT_EQ(texts.size(), 4u + 1);
  EXPECT_EQ(host.violations().back(), "enumeration failed: no serial port");
}

/// A program in SRAM that calls reset_to_usb_boot as images do.
TEST_F(RomUsb, ResetToUsbBootTakesItsTwoMasks) {  // 2.8.3.1.4
  run(700 * ps_per_ms);
  ASSERT_EQ(chip_.rom().state(), RomState::bootsel);
  ASSERT_TRUE(host_.enumerate());
  // BLX r7 with the arguments loaded: LDR r0, [pc, #8]; LDR r1, [pc, #12]; LDR r7, [pc, #12]; ...
  const std::array<std::uint16_t, 6> code = {0x4802, 0x4903, 0x4f03, 0x47b8, 0xe7fe, 0x46c0};
  Bytes program(24);
  std::memcpy(program.data(), code.data(), sizeof code);
  const std::array<std::uint32_t, 3> words = {1u << 25, UsbLoader::no_mass_storage,
                                              chip_.rom().function('U', 'B')};
  std::memcpy(program.data() + 12, words.data(), sizeof words);
  ASSERT_EQ(write(sram + 0x2000, program), End::done);
  ASSERT_EQ(order(Command::reboot, {sram + 0x2001, sram + 0x8000, 1}), End::done);
  while (chip_.rom().state() != RomState::running) {
    ASSERT_LT(now(), 2'000 * ps_per_ms);
    run(ps_per_ms / 10);
  }
  const Picoseconds called = now();
  while (chip_.rom().state() == RomState::running && now() < called + 100 * ps_per_ms)
    run(ps_per_ms / 10);
  EXPECT_NEAR(static_cast<double>(now() - called) / ps_per_ms, 5, 0.3)
      << "half of the requested 10 ms, by erratum E1";
  run(30 * ps_per_ms);
  ASSERT_EQ(chip_.rom().state(), RomState::bootsel);
  ASSERT_TRUE(host_.enumerate());
  EXPECT_EQ(order(Command::exit_xip, {}), End::done);
  // The pin for activity is an output, low.
  EXPECT_EQ(chip_.bus().peek(0xd000'0020, Master::core0).value_or(0), 1u << 25);
  EXPECT_EQ(chip_.bus().peek(0xd000'0010, Master::core0).value_or(1), 0u);
  EXPECT_EQ(chip_.bus().peek(0x4001'40cc, Master::core0).value_or(0) & 0x1f, 5u) << "GPIO25: SIO";
}

}  // namespace
}  // namespace lamplock::sim::chip::rom_usb_test
