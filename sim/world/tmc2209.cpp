#include "sim/world/tmc2209.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lamplock::sim {
namespace {

constexpr std::uint8_t sync = 0x05, of_master = 0xff, write_flag = 0x80;
constexpr std::size_t request_bytes = 4, write_bytes = 8;

/// Registers that can be read (5.1 to 5.5, column R/W); the others read as 0.
bool is_readable(std::uint8_t address) {
  switch (address) {
    case 0x00:  // GCONF
    case 0x01:  // GSTAT
    case 0x02:  // IFCNT
    case 0x05:  // OTP_READ
    case 0x06:  // IOIN
    case 0x07:  // FACTORY_CONF
    case 0x12:  // TSTEP
    case 0x41:  // SG_RESULT
    case 0x6a:  // MSCNT
    case 0x6b:  // MSCURACT
    case 0x6c:  // CHOPCONF
    case 0x6f:  // DRV_STATUS
    case 0x70:  // PWMCONF
    case 0x71:  // PWM_SCALE
    case 0x72:  // PWM_AUTO
      return true;
    default:
      return false;
  }
}
std::uint32_t field(std::uint32_t value, unsigned from, unsigned bits) {
  return value >> from & ((1u << bits) - 1);
}

}  // namespace

std::uint8_t tmc_crc(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes)
    for (unsigned bit = 0; bit < 8; ++bit) {
      const bool differs = ((crc >> 7) ^ (unsigned{byte} >> bit & 1)) != 0;
      crc = (crc << 1 ^ (differs ? 0x07u : 0u)) & 0xff;
    }
  return static_cast<std::uint8_t>(crc);
}

void Tmc2209::power_up() {
  registers_.fill(0);
  registers_[gconf] = 0x101;  // i_scale_analog, multistep_filt
  registers_[gstat] = gstat_reset;
  registers_[ioin] = 0x21000000;  // VERSION
  registers_[chopconf] = 0x10000053;
  registers_[pwmconf] = 0xc10d0024;
  writes_ = 0;
  flags_ = 0;
}

void Tmc2209::set_powered(bool powered) {
  if (powered && !powered_) power_up();
  powered_ = powered;
}

void Tmc2209::set_status(std::uint32_t flags) {
  flags_ = flags;
  if ((flags & (too_hot | short_a | short_b)) != 0) registers_[gstat] |= gstat_drv_err;
}

std::uint32_t Tmc2209::read(std::uint8_t address) const {
  if (!is_readable(address)) return 0;
  if (address == ifcnt) return writes_;
  if (address == drv_status) return flags_;
  if (address == gstat) return registers_[gstat] | (low_supply_ ? gstat_uv_cp : 0);  // not latched
  return registers_[address];
}

void Tmc2209::write(std::uint8_t address, std::uint32_t value) {
  ++writes_;
  if (address == gstat)
    registers_[gstat] &= ~value;
  else
    registers_[address & 0x7f] = value;
}

double Tmc2209::current_ma(unsigned sense_mohm) const {
  const double full_scale_v = field(registers_[chopconf], 17, 1) != 0 ? 0.18 : 0.325;
  const double scale = (field(registers_[ihold_irun], 8, 5) + 1) / 32.0;
  return scale * full_scale_v / (sense_mohm / 1000.0 + 0.02) / std::numbers::sqrt2 * 1000;
}

unsigned Tmc2209::microsteps() const {
  constexpr std::array<unsigned, 4> by_pins{8, 32, 64, 16};
  if (field(registers_[gconf], 7, 1) == 0) return by_pins[address_ & 3];
  return 256u >> field(registers_[chopconf], 24, 4);
}

std::vector<std::uint8_t> TmcWire::receive(std::uint8_t byte, Picoseconds at, Picoseconds bit) {
  if (at - last_ > max_pause_bits * bit) datagram_.clear();
  last_ = at;
  datagram_.push_back(byte);
  if ((datagram_[0] & 0x0f) != sync) datagram_.clear();
  if (datagram_.size() < request_bytes) return {};
  const bool writes = (datagram_[2] & write_flag) != 0;
  if (datagram_.size() < (writes ? write_bytes : request_bytes)) return {};
  std::vector<std::uint8_t> reply = take();
  datagram_.clear();
  return reply;
}

bool TmcWire::may_reply(const Tmc2209& drive) const {
  constexpr std::uint32_t min_delay = 2;
  const auto powered = std::count_if(drives.begin(), drives.end(),
                                     [](const Tmc2209& one) { return one.is_powered(); });
  return powered < 2 || field(drive.written(Tmc2209::nodeconf), 8, 4) >= min_delay;
}

/// Obeys a complete datagram.
std::vector<std::uint8_t> TmcWire::take() {
  const std::span<const std::uint8_t> all(datagram_);
  if (tmc_crc(all.first(all.size() - 1)) != all.back()) return {};
  const auto reg = static_cast<std::uint8_t>(all[2] & 0x7f);
  for (Tmc2209& drive : drives) {
    if (drive.address() != all[1] || !drive.is_powered()) continue;
    if (all.size() == write_bytes) {
      drive.write(reg, std::uint32_t{all[3]} << 24 | std::uint32_t{all[4]} << 16 |
                           std::uint32_t{all[5]} << 8 | all[6]);
      return {};
    }
    const std::uint32_t value = drive.read(reg);
    std::vector<std::uint8_t> reply{sync, of_master, reg};
    for (int shift = 24; shift >= 0; shift -= 8)
      reply.push_back(static_cast<std::uint8_t>(value >> shift));
    reply.push_back(tmc_crc(reply));
    if (!may_reply(drive)) reply[reply.size() / 2] ^= 0xff;
    // 8 bits, or 24 for SENDDELAY 2 and 3, 40 for 4 and 5, and so on.
    reply_delay_bits_ =
        static_cast<int>(8 * (field(drive.written(Tmc2209::nodeconf), 8, 4) / 2 * 2 + 1));
    return reply;
  }
  return {};
}

}  // namespace lamplock::sim
