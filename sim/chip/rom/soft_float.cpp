#include "sim/chip/rom/soft_float.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

namespace lamplock::sim::chip::soft_float {

namespace {

template <class Real>
struct Format;
template <>
struct Format<float> {
  using Bits = std::uint32_t;
  static constexpr int fraction_bits = 23, bias = 127;
  static constexpr unsigned words = 1;
  static constexpr float trigonometric_limit = 128;
};
template <>
struct Format<double> {
  using Bits = std::uint64_t;
  static constexpr int fraction_bits = 52, bias = 1023;
  static constexpr unsigned words = 2;
  static constexpr double trigonometric_limit = 1024;
};
static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);

/// Denormals to zeros, NaNs to infinities, signs kept.
template <class Real>
Real cleaned(Real value) {
  if (std::isnan(value)) return std::copysign(std::numeric_limits<Real>::infinity(), value);
  if (std::fpclassify(value) == FP_SUBNORMAL) return std::copysign(Real{0}, value);
  return value;
}

template <class Real>
Real infinity(bool negative) {
  return std::copysign(std::numeric_limits<Real>::infinity(), negative ? Real{-1} : Real{1});
}

std::uint64_t pair(const Registers& r, unsigned first) {
  return r[first] | static_cast<std::uint64_t>(r[first + 1]) << 32;
}
void set_pair(Registers& r, unsigned first, std::uint64_t value) {
  r[first] = static_cast<std::uint32_t>(value);
  r[first + 1] = static_cast<std::uint32_t>(value >> 32);
}

template <class Real>
Real argument(const Registers& r, unsigned number) {
  if constexpr (std::is_same_v<Real, float>)
    return cleaned(std::bit_cast<float>(r[number]));
  else
    return cleaned(std::bit_cast<double>(pair(r, 2 * number)));
}
template <class Real>
void give(Registers& r, Real value, unsigned number = 0) {
  if constexpr (std::is_same_v<Real, float>)
    r[number] = std::bit_cast<std::uint32_t>(cleaned(value));
  else
    set_pair(r, 2 * number, std::bit_cast<std::uint64_t>(cleaned(value)));
}

// --- conversions ---

/// The largest multiple of 2^-places not above `value`, as an integer, clamped.
template <class Integer, class Real>
Integer to_fixed(Real value, std::int32_t places) {
  using Limits = std::numeric_limits<Integer>;
  using F = Format<Real>;
  const bool negative = std::signbit(value);
  if (value == 0) return 0;
  const Integer clamped = negative ? Limits::min() : Limits::max();
  if (std::isinf(value)) return clamped;
  if (negative && !Limits::is_signed) return 0;
  const auto bits = std::bit_cast<typename F::Bits>(value);
  const std::uint64_t one = std::uint64_t{1} << F::fraction_bits;
  const std::uint64_t mantissa = (bits & (one - 1)) | one;
  const auto exponent = static_cast<std::int64_t>(bits >> F::fraction_bits & (2u * F::bias + 1));
  const std::int64_t shift = exponent - F::bias - F::fraction_bits + places;
  std::uint64_t magnitude = 0;
  bool rest = false;
  if (shift >= 0) {
    if (static_cast<std::int64_t>(std::bit_width(mantissa)) + shift > 64) return clamped;
    magnitude = mantissa << shift;
  } else {
    const auto down = static_cast<unsigned>(std::min<std::int64_t>(-shift, 63));
    magnitude = mantissa >> down;
    rest = (mantissa & ((std::uint64_t{1} << down) - 1)) != 0;
  }
  const auto most = static_cast<std::uint64_t>(Limits::max());
  if (!negative) return magnitude > most ? clamped : static_cast<Integer>(magnitude);
  if (magnitude > most || (magnitude == most && rest)) return clamped;
  // Towards minus infinity.
  return static_cast<Integer>(-static_cast<std::int64_t>(magnitude) - (rest ? 1 : 0));
}

template <class Real, class Integer>
Real from_fixed(Integer value, std::int32_t places) {
  // The integer is rounded once; scaling is exact unless the result is not a normal number.
  return std::ldexp(static_cast<Real>(value), -std::clamp(places, -10'000, 10'000));
}

template <class Integer>
void give_integer(Registers& r, Integer value) {
  if constexpr (sizeof value == 8)
    set_pair(r, 0, static_cast<std::uint64_t>(value));
  else
    r[0] = static_cast<std::uint32_t>(value);
}

template <class Integer, class Real>
void convert_to(Registers& r, bool fixed) {
  const auto places = static_cast<std::int32_t>(fixed ? r[Format<Real>::words] : 0);
  give_integer(r, to_fixed<Integer>(argument<Real>(r, 0), places));
}

template <class Integer, class Real>
void convert_from(Registers& r, bool fixed) {
  constexpr bool wide = sizeof(Integer) == 8;
  const auto places = static_cast<std::int32_t>(fixed ? r[wide ? 2 : 1] : 0);
  Integer value{};
  if constexpr (wide)
    value = static_cast<Integer>(pair(r, 0));
  else
    value = static_cast<Integer>(r[0]);
  give(r, from_fixed<Real>(value, places));
}

// --- functions of real numbers ---

template <class Real>
Real sum(Real a, Real b) {
  const Real result = a + b;
  return std::isnan(result) ? a : result;  // infinities that cancel
}
template <class Real>
Real product(Real a, Real b) {
  const Real result = a * b;
  return std::isnan(result) ? infinity<Real>(std::signbit(a) != std::signbit(b)) : result;
}
template <class Real>
Real quotient(Real a, Real b) {
  const Real result = a / b;
  return std::isnan(result) ? infinity<Real>(std::signbit(a) != std::signbit(b)) : result;
}
template <class Real>
Real square_root(Real a) {
  return a < 0 ? infinity<Real>(true) : std::sqrt(a);
}
template <class Real>
Real logarithm(Real a) {
  return a <= 0 ? infinity<Real>(true) : std::log(a);
}
template <class Real>
std::uint32_t comparison(Real a, Real b) {
  return static_cast<std::uint32_t>(a < b ? -1 : a > b ? 1 : 0);
}

/// Uses double: the host's functions are then rounded correctly except in very rare cases.
template <class Real, class Operation>
Real scientific(Operation operation, Real a) {
  return static_cast<Real>(operation(static_cast<double>(a)));
}

constexpr auto sine = [](double x) { return std::sin(x); };
constexpr auto cosine = [](double x) { return std::cos(x); };

template <class Real>
void conversion(Function function, Registers& r) {
  const auto fixed = [&](Function plain) { return function != plain; };
  switch (function) {
    case Function::to_int:
    case Function::to_fix:
      return convert_to<std::int32_t, Real>(r, fixed(Function::to_int));
    case Function::to_uint:
    case Function::to_ufix:
      return convert_to<std::uint32_t, Real>(r, fixed(Function::to_uint));
    case Function::to_int64:
    case Function::to_fix64:
      return convert_to<std::int64_t, Real>(r, fixed(Function::to_int64));
    case Function::to_uint64:
    case Function::to_ufix64:
      return convert_to<std::uint64_t, Real>(r, fixed(Function::to_uint64));
    case Function::from_int:
    case Function::from_fix:
      return convert_from<std::int32_t, Real>(r, fixed(Function::from_int));
    case Function::from_uint:
    case Function::from_ufix:
      return convert_from<std::uint32_t, Real>(r, fixed(Function::from_uint));
    case Function::from_int64:
    case Function::from_fix64:
      return convert_from<std::int64_t, Real>(r, fixed(Function::from_int64));
    case Function::from_uint64:
    case Function::from_ufix64:
      return convert_from<std::uint64_t, Real>(r, fixed(Function::from_uint64));
    default:
      break;
  }
  if constexpr (std::is_same_v<Real, float>)
    give(r, static_cast<double>(argument<float>(r, 0)));
  else
    give(r, static_cast<float>(argument<double>(r, 0)));
}

template <class Real>
void operation(Function function, Registers& r) {
  const Real a = argument<Real>(r, 0), b = argument<Real>(r, 1);
  switch (function) {
    case Function::add:
      return give(r, sum(a, b));
    case Function::subtract:
      return give(r, sum(a, -b));
    case Function::multiply:
      return give(r, product(a, b));
    case Function::divide:
      return give(r, quotient(a, b));
    case Function::compare:
    case Function::compare_fast:
    case Function::compare_fast_flags:
      r[0] = comparison(a, b);
      return;
    case Function::square_root:
      return give(r, square_root(a));
    case Function::sine:
      // pico-sdk takes the cosine from here too: in r1, or by sine_cosine for doubles.
      give(r, scientific(sine, a));
      if constexpr (std::is_same_v<Real, float>) give(r, scientific(cosine, a), 1);
      return;
    case Function::sine_cosine:
      give(r, scientific(sine, a));
      return give(r, scientific(cosine, a), 1);
    case Function::cosine:
      return give(r, scientific(cosine, a));
    case Function::tangent:
      return give(r, scientific([](double x) { return std::tan(x); }, a));
    case Function::exponential:
      return give(r, scientific([](double x) { return std::exp(x); }, a));
    case Function::logarithm:
      return give(r, scientific([](double x) { return logarithm(x); }, a));
    case Function::arc_tangent2:
      return give(r, static_cast<Real>(std::atan2(static_cast<double>(a), static_cast<double>(b))));
    default:
      return conversion<Real>(function, r);
  }
}

}  // namespace

Registers call(Function function, Precision precision, Registers registers, unsigned version) {
  constexpr std::uint32_t sign_and_exponent = 0xff80'0000, minus_zero = 0x8000'0000;
  const bool truncates = function == Function::to_int || function == Function::to_fix;
  if (version == 1 && truncates && (registers[0] & sign_and_exponent) == minus_zero) {
    registers[0] = ~0u;
    return registers;
  }
  if (precision == Precision::float32)
    operation<float>(function, registers);
  else
    operation<double>(function, registers);
  return registers;
}

bool out_of_range(Function function, Precision precision, const Registers& registers) {
  if (function != Function::sine && function != Function::cosine && function != Function::tangent &&
      function != Function::sine_cosine)
    return false;
  if (precision == Precision::float32)
    return std::abs(argument<float>(registers, 0)) >= Format<float>::trigonometric_limit;
  return std::abs(argument<double>(registers, 0)) >= Format<double>::trigonometric_limit;
}

}  // namespace lamplock::sim::chip::soft_float
