// TMC2209 stepper drives and the one-wire UART that they share (Trinamic, TMC2209 datasheet, rev.
// 1.09: 4 UART, 5 register map, 9 current).
//
// In:  bytes on the wire with their times; power of the motors, heat and shorts (tests).
// Out: the bytes of replies; registers, current and microsteps.
// Who: the chip simulator, which connects the wire to two pads; tests of the firmware's set-up.
//
// A datagram is "05 address register|80 data crc" (write) or "05 address register crc" (read), the
// reply to the latter "05 FF register data crc"; data are 32 bits, the upper byte first. A drive
// ignores datagrams with a wrong CRC, and those for other addresses. The wire is one: what is sent
// on it comes back to the sender. The reply of a drive with SENDDELAY 0 or 1, which is not allowed
// where several share the wire (5.1), is damaged.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/world/time.hpp"

namespace lamplock::sim {

/// CRC of a datagram (4.2): polynomial x^8 + x^2 + x + 1, each byte from its lowest bit on.
std::uint8_t tmc_crc(std::span<const std::uint8_t> bytes);

/// One drive.
class Tmc2209 {
 public:
  /// Registers that are more than memory here (5.1 to 5.5).
  static constexpr std::uint8_t gconf = 0x00, gstat = 0x01, ifcnt = 0x02, ioin = 0x06,
                                nodeconf = 0x03, ihold_irun = 0x10, vactual = 0x22, chopconf = 0x6c,
                                drv_status = 0x6f, pwmconf = 0x70;
  /// GSTAT: the registers have been reset; the drive was switched off because of heat or a short;
  /// the charge pump has too low a voltage.
  static constexpr std::uint32_t gstat_reset = 1, gstat_drv_err = 2, gstat_uv_cp = 4;
  /// DRV_STATUS: warning of heat, too hot, short to ground of A and B.
  static constexpr std::uint32_t warm = 1, too_hot = 2, short_a = 4, short_b = 8;

  /// Address by the levels of MS1 (1) and MS2 (2).
  explicit Tmc2209(unsigned address) : address_(address) { power_up(); }

  unsigned address() const { return address_; }
  /// The supply of the motors returns: all registers as after a reset.
  void power_up();
  /// Without its supply a drive neither answers nor moves.
  void set_powered(bool powered);
  bool is_powered() const { return powered_; }
  /// Flags of DRV_STATUS; heat and shorts switch the drive off.
  void set_status(std::uint32_t flags);
  /// The supply is too low for the charge pump: the drive is off meanwhile.
  void set_low_supply(bool low) { low_supply_ = low; }

  std::uint32_t read(std::uint8_t address) const;
  /// Counted by IFCNT.
  void write(std::uint8_t address, std::uint32_t value);
  /// What was written last, also of registers that cannot be read.
  std::uint32_t written(std::uint8_t address) const { return registers_[address & 0x7f]; }

  /// Effective value in motion with sense resistors of that many milliohm (9.).
  double current_ma(unsigned sense_mohm) const;
  /// Set by the register, or by MS1 and MS2 if GCONF says so (8, 32, 64, 16 for addresses 0 to 3).
  unsigned microsteps() const;

 private:
  unsigned address_;
  bool powered_ = true, low_supply_ = false;
  std::array<std::uint32_t, 128> registers_{};
  std::uint8_t writes_ = 0;
  std::uint32_t flags_ = 0;
};

/// The wire with its drives.
class TmcWire {
 public:
  explicit TmcWire(std::span<const std::uint8_t> addresses) {
    for (const std::uint8_t address : addresses) drives.emplace_back(address);
  }
  /// A byte has been received by the drives without an error of its frame. Bytes of replies, if
  /// this one completes a request; they begin `reply_delay_bits` later.
  std::vector<std::uint8_t> receive(std::uint8_t byte, Picoseconds at, Picoseconds bit);
  /// Delay of the last reply, by SENDDELAY of its drive (5.1).
  int reply_delay_bits() const { return reply_delay_bits_; }

  std::vector<Tmc2209> drives;

 private:
  /// A longer pause between the starts of two bytes ends a datagram (4.1.1).
  static constexpr int max_pause_bits = 63;

  std::vector<std::uint8_t> take();

  bool may_reply(const Tmc2209& drive) const;

  int reply_delay_bits_ = 8;
  std::vector<std::uint8_t> datagram_;
  Picoseconds last_ = 0;
};

}  // namespace lamplock::sim
