// Registers and datagrams of the TMC2209 (Trinamic, TMC2209 datasheet, rev. 1.09: 4 UART, 5
// register map, 9 current).
//
// In:  settings of an axis, the row of the board. Out: values of registers, datagrams, checked
// replies. Who: DriveSetup (drive_setup.hpp). Main loop; no hardware access.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "shared/boards/board_row.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::rp2040::tmc {

inline constexpr std::uint8_t gconf = 0x00, gstat = 0x01, ifcnt = 0x02, nodeconf = 0x03,
                              ihold_irun = 0x10, tpowerdown = 0x11, tpwmthrs = 0x13,
                              tcoolthrs = 0x14, vactual = 0x22, coolconf = 0x42, chopconf = 0x6c,
                              drv_status = 0x6f, pwmconf = 0x70;
/// GSTAT: the registers were reset; heat or a short has switched the drive off; its charge pump has
/// too low a voltage, so that it is off now.
inline constexpr std::uint32_t gstat_reset = 1, gstat_drv_err = 2, gstat_uv_cp = 4, gstat_all = 7;
/// DRV_STATUS: warning of heat; too hot; shorts to ground and to the supply.
inline constexpr std::uint32_t warm = 1, too_hot = 2, shorts = 0x3c;

/// A datagram without its CRC's check: request 4 bytes, write and reply 8.
using Datagram = std::array<std::uint8_t, 8>;
inline constexpr std::size_t request_bytes = 4, full_bytes = 8;
inline constexpr std::uint8_t sync = 0x05, of_master = 0xff, write_flag = 0x80;

/// CRC of all bytes but the last (4.2): polynomial 0x07, each byte from its lowest bit on.
[[gnu::cold]] constexpr std::uint8_t crc_of(std::span<const std::uint8_t> bytes) {
  unsigned crc = 0;
  for (unsigned byte : bytes)
    for (int bit = 0; bit < 8; ++bit, byte >>= 1) {
      const bool differs = ((crc >> 7 ^ byte) & 1) != 0;
      crc = (crc << 1 ^ (differs ? 0x07u : 0u)) & 0xff;
    }
  return static_cast<std::uint8_t>(crc);
}
[[gnu::cold]] constexpr Datagram write_datagram(std::uint8_t address, std::uint8_t reg,
                                                std::uint32_t value) {
  Datagram d{sync, address, static_cast<std::uint8_t>(reg | write_flag)};
  for (std::size_t i = 0; i < 4; ++i) d[3 + i] = static_cast<std::uint8_t>(value >> (24 - 8 * i));
  d[7] = crc_of(std::span(d).first(full_bytes - 1));
  return d;
}
/// Only the first 4 bytes count.
[[gnu::cold]] constexpr Datagram read_datagram(std::uint8_t address, std::uint8_t reg) {
  Datagram d{sync, address, reg};
  d[3] = crc_of(std::span(d).first(request_bytes - 1));
  return d;
}
/// The reply is to a request of this register, and undamaged.
[[gnu::cold]] constexpr bool is_reply(const Datagram& d, std::uint8_t reg) {
  return d[0] == sync && d[1] == of_master && d[2] == reg &&
         d[7] == crc_of(std::span(d).first(full_bytes - 1));
}
constexpr std::uint32_t data_of(const Datagram& d) {
  return std::uint32_t{d[3]} << 24 | std::uint32_t{d[4]} << 16 | std::uint32_t{d[5]} << 8 | d[6];
}

/// Registers that the set-up writes, in this order.
inline constexpr std::array<std::uint8_t, 11> written{gstat,      nodeconf, gconf,     ihold_irun,
                                                      tpowerdown, tpwmthrs, tcoolthrs, vactual,
                                                      coolconf,   chopconf, pwmconf};

/// Values for an axis.
struct Config {
  std::uint16_t current_ma = 0;
  std::uint16_t microsteps = 1;
  std::uint8_t hold_percent = 0;
  bool spread_cycle = false;
  friend constexpr bool operator==(const Config&, const Config&) = default;
};
#if LAMPLOCK_DRIVE_SETTINGS
[[gnu::cold]] inline Config config_of(const settings::Values& values, int axis) {
  using settings::Id;
  return {static_cast<std::uint16_t>(values.whole(Id::drive_current_x, axis)),
          static_cast<std::uint16_t>(values.whole(Id::microsteps_x, axis)),
          static_cast<std::uint8_t>(values.whole(Id::drive_hold)),
          (values.whole(Id::spread_cycle) >> axis & 1) != 0};
}
#endif

/// Current scale (9): CS + 1 = 32 I sqrt(2) (R + 20 mOhm) / V with V = 180 mV, the finer range, if
/// that suffices, else 325 mV. Never above the current asked for, but at least 1/32 of a range.
struct Scale {
  bool fine;
  std::uint8_t cs;
};
[[gnu::cold]] constexpr Scale scale_of(std::uint32_t current_ma, std::uint32_t sense_mohm) {
  const auto steps = [&](std::uint32_t millivolt) {
    // 46341 / 2^15 = sqrt 2, rounded up.
    const std::uint32_t microvolt = current_ma * (sense_mohm + 20);
    return static_cast<std::uint32_t>(std::uint64_t{microvolt} * 46341 * 32 /
                                      (std::uint64_t{millivolt} * 1000 << 15));
  };
  const bool fine = steps(180) <= 32;
  const std::uint32_t n = steps(fine ? 180 : 325);
  return {fine, static_cast<std::uint8_t>(n == 0 ? 0 : n > 32 ? 31 : n - 1)};
}

/// Value of a register in `written`.
[[gnu::cold]] constexpr std::uint32_t value_of(std::uint8_t reg, const Config& config,
                                               std::uint32_t sense_mohm) {
  const Scale scale = scale_of(config.current_ma, sense_mohm);
  switch (reg) {
    case gstat:
      return gstat_all;  // a one clears
    case nodeconf:
      // SENDDELAY 2: replies begin 3 x 8 bits after the request. The 8 bits that it is after a
      // reset are not allowed where drives share the wire (5.1).
      return 2u << 8;
    case gconf:
      // pdn_disable, mstep_reg_select, multistep_filt; the current is that of the register.
      return 1u << 6 | 1u << 7 | 1u << 8 | (config.spread_cycle ? 1u << 2 : 0);
    case ihold_irun:
      // IHOLDDELAY 8: the current falls within 8 x 2^18 clocks of 12 MHz, 0.2 s.
      return 8u << 16 | std::uint32_t{scale.cs} << 8 | scale.cs * config.hold_percent / 100u;
    case tpowerdown:
      return 20;
    case chopconf: {
      std::uint32_t mres = 8;
      for (unsigned n = config.microsteps; n > 1; n >>= 1) --mres;
      // TOFF 3 and HSTRT 5 as after a reset, TBL 2 (32 clocks), interpolation to 256 microsteps.
      return 1u << 28 | mres << 24 | (scale.fine ? 1u << 17 : 0) | 2u << 15 | 5u << 4 | 3u;
    }
    case pwmconf:
      return 0xc10d0024;  // as after a reset
    default:
      return 0;
  }
}
/// The set-up reads it back.
constexpr bool is_readable(std::uint8_t reg) {
  return reg == gconf || reg == chopconf || reg == pwmconf;
}

static_assert(crc_of(std::array<std::uint8_t, 3>{0x05, 0x00, 0x02}) == 0x8f);
static_assert(scale_of(500, 110).fine && scale_of(500, 110).cs == 15);
static_assert(!scale_of(1200, 110).fine && scale_of(1200, 110).cs == 20);

}  // namespace lamplock::rp2040::tmc
