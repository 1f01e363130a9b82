// Runs of pixels: neighbours of one power, 16 bits a run.
//
// The same format in the pulse stream (row_records.hpp) and on the board until they are burnt
// (firmware/stepper/power_table.hpp): received runs are not recoded.
//
//   bits 15..5  power in 2048 steps, a little more than the 2000 counts of a duty of LASER PWM
//   bits 4..0   how many cells: 1 to 16, or a power of two from 32 to 65536
//
// Longer runs, and lengths in between, are divided.
#pragma once

#include <bit>
#include <cstdint>

namespace lamplock::wire {

inline constexpr int run_power_bits = 11, run_code_bits = 5;
/// Codes below this one mean one cell more than the code.
inline constexpr std::uint32_t run_short_codes = 16;

namespace detail {

constexpr std::uint32_t run_cells_of(std::uint32_t code) {
  return code < run_short_codes ? code + 1 : 2 * run_short_codes << (code - run_short_codes);
}
/// Code of the longest run that is not longer than this.
constexpr std::uint32_t run_code_of(std::uint32_t cells) {
  if (cells < 2 * run_short_codes) return (cells < run_short_codes ? cells : run_short_codes) - 1;
  return run_short_codes + static_cast<std::uint32_t>(std::bit_width(cells / run_short_codes)) - 2;
}

}  // namespace detail

/// Power of a run, 65535 = full.
constexpr std::uint16_t run_power(std::uint16_t run) {
  const std::uint32_t power = run >> run_code_bits;
  return static_cast<std::uint16_t>(power << run_code_bits |
                                    power >> (run_power_bits - run_code_bits));
}

/// Cells of a run.
constexpr std::uint32_t run_cells(std::uint16_t run) {
  return detail::run_cells_of(run & ((1u << run_code_bits) - 1));
}

/// The first run for this number of cells of one power, at least one: as long as possible.
constexpr std::uint16_t max_run(std::uint16_t power, std::uint32_t cells) {
  // Rounded to the nearest of 2048, of which the last is full power.
  const std::uint32_t steps =
      (power - (std::uint32_t{power} >> run_power_bits) + run_short_codes) >> run_code_bits;
  return static_cast<std::uint16_t>(steps << run_code_bits | detail::run_code_of(cells));
}

/// Number of runs for this number of cells of one power.
constexpr std::uint32_t runs_of(std::uint32_t cells) {
  std::uint32_t runs = 0;
  for (; cells != 0; ++runs) cells -= detail::run_cells_of(detail::run_code_of(cells));
  return runs;
}

}  // namespace lamplock::wire
