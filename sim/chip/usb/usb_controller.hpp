// The USB controller as a device (RP2040 datasheet, 4.1): registers at 0x50110000, DPRAM at
// 0x50100000.
//
// In:  register accesses of the firmware; its words in the DPRAM, read when a token comes;
//      packets, resets and silence from the host end (DeviceEnd).
// Out: answers to the host end, words and data written back to the DPRAM, USBCTRL_IRQ.
// Who: the bus for registers; the time wheel for suspend; usb_host/ for the cable.
//
// The bus maps the DPRAM as plain memory of any access width; its owner may report stores to the
// buffer control words (dpram_stored), so that unsafe ones are noticed.
// Not modelled, reported by name: host mode, isochronous endpoints, direct drive of the PHY.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/chip/fabric/interrupt_registers.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/usb/wire.hpp"

namespace lamplock::sim::chip {

/// Errata of the device controller that can be switched on. Defaults: stepping B2.
struct UsbErrata {
  /// RP2040-E2 (B0, B1): clearing a bit of EP_ABORT does not end the abort; the endpoint keeps
  /// answering NAK.
  bool e2_abort_sticks = false;
  /// RP2040-E5 (B0, B1): after a bus reset the controller needs 800 us of idle bus before it takes
  /// part; on a busy bus it never does.
  bool e5_reset_needs_idle = false;
  /// RP2040-E15 (all steppings): a packet that breaks off in a bit stuffing error during an IN
  /// transfer hangs the controller until it is reset. Hubs break packets off at the end of a frame,
  /// hence the work-around of arming no bulk IN buffer in the last 200 us.
  bool e15_broken_packet_hangs = true;
};

class UsbController final : public Peripheral, public Timed, public usb::DeviceEnd {
 public:
  static constexpr std::uint32_t base = 0x5011'0000;
  static constexpr std::uint32_t dpram_base = 0x5010'0000;
  /// Values that the documents do not give.
  struct Assumed {
    /// SE0 that counts as a bus reset; USB 2.0, 7.1.7.5 permits 2.5 us to 10 ms.
    static constexpr Picoseconds reset_detect = 2'500 * ps_per_ns;
    /// K that counts as resume; not given for this controller.
    static constexpr Picoseconds resume_detect = 2'500 * ps_per_ns;
  };

  /// `dpram` of 4096 bytes must outlive the controller.
  UsbController(TimeWheel& wheel, IrqLines& irq, std::span<std::uint8_t> dpram,
                NotModelled not_modelled, UsbErrata errata = {});
  UsbController(const UsbController&) = delete;
  UsbController& operator=(const UsbController&) = delete;

  // Peripheral
  std::string_view name() const override { return "USBCTRL_REGS"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;

  // Timed
  void run(Cycle to) override;
  void clock_changed() override;

  // usb::DeviceEnd
  void connect(usb::HostEnd* host, Picoseconds at) override;
  bool pull_up() const override { return pull_up_; }
  void begin_reset(Picoseconds at) override;
  void end_reset(Picoseconds at) override;
  void begin_resume(Picoseconds at) override;
  void end_resume(Picoseconds at) override;
  void start_of_frame(std::uint16_t number, Picoseconds at) override;
  void other_traffic(Picoseconds at) override;
  std::optional<usb::Packet> in(std::uint8_t address, std::uint8_t endpoint,
                                Picoseconds at) override;
  void in_end(bool ack, usb::Fault fault, Picoseconds at) override;
  void out(std::uint8_t address, std::uint8_t endpoint, bool setup, Picoseconds at) override;
  std::optional<usb::Pid> out_data(const usb::Packet& packet, usb::Fault fault,
                                   Picoseconds at) override;
  void out_end(Picoseconds at) override;

  /// Level of the VBUS_DETECT function of a GPIO pin; low unless a pin is given that function.
  void set_vbus_pin(bool level);
  /// Frequency of clk_usb, 0 if stopped. The controller works at 48 MHz only (datasheet, 4.1.2.1).
  void set_usb_clock(std::uint64_t hz);
  /// A store has changed an aligned word of the DPRAM; checks the rule of concurrent access
  /// (datasheet, 4.1.2.5.1): AVAILABLE is set at least one cycle of clk_usb after the fields that
  /// belong to it, unless clk_sys runs at 48 MHz too.
  void dpram_stored(std::uint32_t offset, std::uint32_t before, std::uint32_t after);

  /// Violations of the datasheet's rules by the firmware, each text once.
  const std::vector<std::string>& violations() const { return violations_; }
  /// Locked up by RP2040-E15; only reset() helps.
  bool hung() const { return hung_; }
  /// Bulk IN buffers that were armed in the last 200 us of a frame, where RP2040-E15 can strike,
  /// after the host had asked for them in vain within the same 200 us.
  std::uint64_t armed_late() const { return armed_late_; }

 private:
  /// One direction of one endpoint, as set in the DPRAM when a token comes.
  struct Endpoint {
    std::uint32_t index = 0;  ///< bit in BUFF_STATUS: 2 x number, + 1 if OUT
    std::uint32_t control = 0;
    std::uint32_t buffer = 0;  ///< 0 or 1
    std::uint16_t word = 0;    ///< half of the buffer control word
    bool number_zero() const { return index < 2; }
    bool doubled() const;
    std::uint32_t address() const;
  };
  /// State between token and handshake.
  enum class Phase : std::uint8_t { idle, in_sent, out_token, out_taken };
  enum class Answer : std::uint8_t { nothing, data, discard, nak, stall, setup };
  struct Transaction {
    Phase phase = Phase::idle;
    Answer answer = Answer::nothing;
    Endpoint endpoint;
    std::uint32_t length = 0;
    bool data1 = false;
  };
  /// Buffers done and not yet acknowledged by the processor.
  struct Done {
    std::uint8_t buffers = 0;  ///< bit per buffer
    std::uint8_t first = 0;
    std::uint8_t count = 0;  ///< for an interrupt per two buffers
  };

  std::uint32_t status() const;
  std::uint32_t raw_interrupts() const;
  std::uint32_t should_handle() const;
  void write_main_ctrl(std::uint32_t value);
  void write_sie_ctrl(std::uint32_t value);
  void write_sie_status(std::uint32_t value);
  void write_buff_status(std::uint32_t value);
  void write_abort(std::uint32_t value);
  void write_phy(std::uint32_t offset, std::uint32_t value);
  void write_host_register(std::uint32_t offset, std::uint32_t value);

  void update_interrupt();
  void update_pull_up();
  bool vbus_detected() const;
  void set_connected(bool on);
  void set_suspended(bool on);
  void plan();
  void activity(Picoseconds at);
  bool listens() const;

  std::optional<Endpoint> find_endpoint(std::uint8_t number, bool out);
  std::optional<Answer> refusal(const Endpoint& endpoint);
  void note_refusal(const Endpoint& endpoint, Answer answer);
  void note_late_arm(const Endpoint& endpoint, bool armed, Picoseconds at);
  void set_up(const usb::Packet& packet);
  void finish_buffer(const Transaction& done, bool full);
  void report_buffer(const Endpoint& endpoint);
  void end_transaction();
  void violation(const std::string& text);

  std::uint32_t word(std::uint32_t offset) const;
  std::uint16_t half(std::uint32_t offset) const;
  void set_half(std::uint32_t offset, std::uint16_t value);

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  IrqLines& irq_;
  std::span<std::uint8_t> dpram_;
  NotModelled not_modelled_;
  UsbErrata errata_;
  usb::HostEnd* host_ = nullptr;
  std::uint64_t usb_hz_ = 48'000'000;
  bool vbus_pin_ = false;

  // Registers
  std::uint32_t addr_endp_ = 0, main_ctrl_ = 0, sie_ctrl_ = 0, muxing_ = 0, pwr_ = 0;
  std::uint32_t phy_direct_ = 0, phy_override_ = 0, phy_trim_ = 0;
  std::uint32_t latched_ = 0;  ///< sticky bits of SIE_STATUS
  std::uint32_t changes_ = 0;  ///< DEV_CONN_DIS, DEV_SUSPEND, DEV_RESUME_FROM_HOST, DEV_SOF
  std::uint32_t buff_status_ = 0, abort_ = 0, abort_done_ = 0, stall_arm_ = 0, stall_nak_ = 0;
  InterruptRegisters interrupts_;
  std::uint16_t frame_ = 0;

  // Bus state.
  enum class Bus : std::uint8_t { idle, reset, resume };
  Bus bus_ = Bus::idle;
  bool pull_up_ = false;
  bool connected_ = false;
  bool suspended_ = false;
  bool hung_ = false;
  std::uint32_t abort_stuck_ = 0;
  std::uint32_t select_ = 0;  ///< buffer select, a bit per endpoint and direction
  std::array<Done, 32> done_{};
  Transaction transaction_;
  Picoseconds last_activity_ = 0;
  Picoseconds last_frame_ = 0;
  Picoseconds bus_since_ = 0;       ///< start of reset or resume signalling
  bool bus_seen_ = false;           ///< and it has lasted long enough
  Picoseconds connect_after_ = -1;  ///< end of the idle time after reset (E5); -1: not waiting
  std::array<Picoseconds, 16> refused_at_{};
  std::uint64_t armed_late_ = 0;
  std::array<Picoseconds, 64> fields_written_{};  ///< per half of a buffer control word
  std::vector<std::string> violations_;
};

}  // namespace lamplock::sim::chip
