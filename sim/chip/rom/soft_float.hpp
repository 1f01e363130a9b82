// The floating-point library of the boot ROM (RP2040 datasheet, 2.8.3.2), computed by the host.
//
// In:  a function of the tables 'SF' or 'SD' and the core's r0..r3.
// Out: r0..r3 after the function.
// Who: BootRom, when a core calls through one of the tables; tests.
//
// Documented (2.8.3.2.1): denormals are zero on the way in and out, NaNs are infinities on the way
// in and out; rounding is to nearest, ties to even; add, subtract, multiply, divide and square root
// are correctly rounded; scientific functions are within one unit in the last place, less near
// zeros of the result. Conversions to integers round towards minus infinity and clamp. Logarithms
// of what is not positive are minus infinity. Sine, cosine and tangent work for |x| < 128
// (double: 1024).
// Assumed: the sign of an infinity that replaces a NaN (that of a product or quotient; of the first
// operand in sums); square roots of negative numbers are minus infinity and that of minus zero is
// itself, as in the SDK's wrappers; results are rounded as denormals before they become zero;
// scientific functions are those of the host's library, which may differ from the chip's by one
// unit in the last place; version 1 converts minus zero to the integer -1 (wrappers avoid it); the
// deprecated comparisons of version 1 are the later one.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::sim::chip::soft_float {

/// Functions in the order of both tables, four bytes each, from offset 0.
enum class Function : std::uint8_t {
  add,
  subtract,
  multiply,
  divide,
  compare_fast,        ///< deprecated
  compare_fast_flags,  ///< deprecated
  square_root,
  to_int,
  to_fix,
  to_uint,
  to_ufix,
  from_int,
  from_fix,
  from_uint,
  from_ufix,
  cosine,
  sine,
  tangent,
  sine_cosine,  ///< version 3
  exponential,
  logarithm,
  compare,  ///< version 2 from here on
  arc_tangent2,
  from_int64,
  from_fix64,
  from_uint64,
  from_ufix64,
  to_int64,
  to_fix64,
  to_uint64,
  to_ufix64,
  convert  ///< float to double in 'SF', double to float in 'SD'
};
inline constexpr unsigned version1_functions = 21;  ///< 0x54 bytes
inline constexpr unsigned functions = 32;           ///< 0x80 bytes

enum class Precision : std::uint8_t { float32, float64 };

using Registers = std::array<std::uint32_t, 4>;

/// Effect of a function on r0..r3. Registers that it does not return keep their values; on the chip
/// they are lost. `version` of the ROM: 1 to 3.
Registers call(Function function, Precision precision, Registers registers, unsigned version = 3);
/// True if the argument is outside the range in which sine, cosine and tangent work.
bool out_of_range(Function function, Precision precision, const Registers& registers);
/// True if the function uses the integer divider of its core (pico-sdk saves that around these).
constexpr bool uses_divider(Function function) {
  return function == Function::divide || function == Function::tangent;
}

}  // namespace lamplock::sim::chip::soft_float
