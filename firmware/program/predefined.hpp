// Values of the machine that a program reads as parameters: #5001 to #5602, #<_x> and so on.
//
// In:  the state of the interpreter before the line, offsets, results of probes and inputs.
// Out: values, 10^-9. Places of the program (#5420, #<_x>) in its units, all other lengths in
//      millimetres (numbers and names: LinuxCNC, "G-code Overview").
// Who: expressions (expression.hpp), main loop.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/program/modal.hpp"
#include "firmware/program/parameters.hpp"

namespace lamplock::program {

inline constexpr std::uint32_t max_predefined = 5602;

/// What the machine has found out for the program, and what A is.
struct Results {
  Place probe_e7{};  ///< where the last probe met, machine coordinates
  bool probe_met = false;
  std::int8_t input = 0;  ///< of the last M66: 1 on, 0 off, -1 after the time-out
  /// A bit for A if it is in degrees (Options::rotary). Here it needs no room of its own.
  const std::uint8_t* rotary;
};

class Predefined {
 public:
  /// All must outlive this object; the first points to the state in force.
  Predefined(const State* const& state, const Parameters& parameters, const std::uint8_t& rotary)
      : results{.rotary = &rotary}, state_(state), parameters_(parameters) {}

  /// Of a number from 5001 to 5602; 0 if it has no meaning here.
  [[gnu::cold]] std::int64_t value_e9(std::uint32_t number) const;
  /// Of a name in lower case; false if it is not one of them.
  [[gnu::cold]] bool find(std::string_view name, std::int64_t& value_e9) const;

  Results results;

 private:
  std::int64_t position_e9(std::uint32_t axis) const;

  const State* const& state_;
  const Parameters& parameters_;
};

}  // namespace lamplock::program
