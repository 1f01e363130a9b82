// The floating-point tables of the boot ROM: the functions against the host's arithmetic over many
// operands, and a core that looks them up and calls them as images do (RP2040 datasheet, 2.8.3.2).
#include "sim/chip/rom/soft_float.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "sim/chip/chip.hpp"
#include "tests/scale.hpp"

namespace lamplock::sim::chip::rom_float_test {
namespace {

using soft_float::call;
using soft_float::Function;
using soft_float::Precision;
using soft_float::Registers;

constexpr float inf_f = std::numeric_limits<float>::infinity();
constexpr double inf_d = std::numeric_limits<double>::infinity();

std::uint32_t bits(float value) { return std::bit_cast<std::uint32_t>(value); }
std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }
std::uint64_t joined(const Registers& r) { return r[0] | static_cast<std::uint64_t>(r[1]) << 32; }
Registers registers(double a, double b = 0) {
  return {static_cast<std::uint32_t>(bits(a)), static_cast<std::uint32_t>(bits(a) >> 32),
          static_cast<std::uint32_t>(bits(b)), static_cast<std::uint32_t>(bits(b) >> 32)};
}

Registers registers(float a, float b = 0) { return {bits(a), bits(b), 0, 0}; }

template <class Real>
constexpr bool is_single = std::is_same_v<Real, float>;
template <class Real>
Registers call_of(Function function, const Registers& operands) {
  return call(function, is_single<Real> ? Precision::float32 : Precision::float64, operands);
}
template <class Real>
Real apply(Function function, Real a, Real b = 0) {
  const Registers result = call_of<Real>(function, registers(a, b));
  if constexpr (is_single<Real>)
    return std::bit_cast<float>(result[0]);
  else
    return std::bit_cast<double>(joined(result));
}
float single(Function function, float a, float b = 0) { return apply(function, a, b); }
double twice(Function function, double a, double b = 0) { return apply(function, a, b); }

/// The datasheet's conditions for operands and results: no denormals, no NaNs.
template <class Real>
Real clean(Real value) {
  if (std::isnan(value)) return std::copysign(std::numeric_limits<Real>::infinity(), value);
  if (value != 0 && std::abs(value) < std::numeric_limits<Real>::min())
    return std::copysign(Real{0}, value);
  return value;
}

/// Bit patterns of all kinds: anything, near each other, near one, integers, special values.
template <class Real>
class Operands {
  using Bits = std::conditional_t<is_single<Real>, std::uint32_t, std::uint64_t>;

 public:
  Real one() {
    switch (random_() % 6) {
      case 0:
        return std::bit_cast<Real>(static_cast<Bits>(random_()));
      case 1:
        return std::ldexp(static_cast<Real>(static_cast<std::int32_t>(random_())),
                          static_cast<int>(random_() % 40) - 35);
      case 2:
        return static_cast<Real>(static_cast<std::int64_t>(random_()) >> random_() % 64);
      case 3:
        return last_ = std::nextafter(last_, random_() % 2 == 0 ? Real{0} : Real{1000});
      case 4: {
        constexpr Real inf = std::numeric_limits<Real>::infinity();
        constexpr Real small = std::numeric_limits<Real>::min();
        constexpr Real special[] = {0, inf, small, small / 2, std::numeric_limits<Real>::max(), 1};
        const Real value = special[random_() % std::size(special)];
        return random_() % 2 == 0 ? value : -value;
      }
      default:
        return last_ =
                   static_cast<Real>(static_cast<double>(random_() % 2'000'000) / 1'000'000 - 1);
    }
  }
  std::mt19937_64& random() { return random_; }

 private:
  std::mt19937_64 random_{17};
  Real last_ = 1;
};

template <class Real>
class SoftFloatOf : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(SoftFloatOf, Reals);

TYPED_TEST(SoftFloatOf, BasicOperationsAreRoundedOnce) {
  using Real = TypeParam;
  Operands<Real> operands;
  for (int i = 0; i < test::scaled(200'000); ++i) {
    const Real x = operands.one(), y = operands.one();
    const double a = clean(x), b = clean(y);
    // 53 bits of intermediate result are more than twice 24 and two, so rounding twice is exact.
    const auto check = [&](Function function, double exact) {
      if (std::isnan(exact)) return;
      EXPECT_EQ(bits(apply(function, x, y)), bits(clean(static_cast<Real>(exact))))
          << static_cast<int>(function) << " of " << x << ", " << y;
    };
    check(Function::add, a + b);
    check(Function::subtract, a - b);
    check(Function::multiply, a * b);
    check(Function::divide, a / b);
    check(Function::square_root, std::sqrt(a));
    if (is_single<Real>) continue;
    // A quotient is right when its remainder is less than half its last place.
    const double q = apply(Function::divide, x, y);
    if (!std::isnormal(q) || std::abs(q) < 1e-200 || std::abs(q) > 1e200 || std::abs(b) < 1e-50 ||
        std::abs(b) > 1e50)
      continue;
    const double ulp = std::nextafter(std::abs(q), inf_d) - std::abs(q);
    EXPECT_LE(std::abs(std::fma(-q, b, a)), 0.5 * ulp * std::abs(b)) << x << ", " << y;
  }
}

TEST(SoftFloat, InfinitiesReplaceNaNs) {  // 2.8.3.2.1
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(single(Function::add, nan, 1), inf_f);
  EXPECT_EQ(single(Function::add, -nan, 1), -inf_f);
  EXPECT_TRUE(std::isinf(single(Function::subtract, inf_f, inf_f)));
  EXPECT_TRUE(std::isinf(single(Function::multiply, inf_f, 0)));
  EXPECT_TRUE(std::isinf(single(Function::divide, inf_f, inf_f)));
  EXPECT_TRUE(std::isinf(single(Function::divide, 0, 0)));
  EXPECT_EQ(single(Function::divide, -1, 0), -inf_f);
  EXPECT_EQ(single(Function::square_root, -1), -inf_f);
  EXPECT_EQ(single(Function::logarithm, -1), -inf_f);
  EXPECT_EQ(single(Function::logarithm, 0), -inf_f);
  EXPECT_TRUE(std::isinf(twice(Function::subtract, inf_d, inf_d)));
  EXPECT_EQ(twice(Function::logarithm, -2), -inf_d);
  const float denormal = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(single(Function::add, denormal, 0), 0.0f);
  EXPECT_EQ(single(Function::multiply, std::numeric_limits<float>::min(), 0.5f), 0.0f);
  EXPECT_EQ(single(Function::divide, 1, denormal), inf_f);
}

TYPED_TEST(SoftFloatOf, Compares) {
  using Real = TypeParam;
  const auto compared = [](Real a, Real b) {
    return static_cast<std::int32_t>(call_of<Real>(Function::compare, registers(a, b))[0]);
  };
  using Limits = std::numeric_limits<Real>;
  EXPECT_EQ(compared(Limits::quiet_NaN(), Limits::infinity()), 0);
  Operands<Real> operands;
  for (int i = 0; i < test::scaled(50'000); ++i) {
    const Real x = operands.one(), y = i % 10 == 0 ? x : operands.one();
    const Real a = clean(x), b = clean(y);
    EXPECT_EQ(compared(x, y), (a > b) - (a < b)) << x << ", " << y;
  }
}

/// The real number value x 2^places, rounded down and clamped. 64 bits of mantissa are exact.
template <class Integer, class Real>
Integer rounded_down(Real value, int places) {
  using Limits = std::numeric_limits<Integer>;
  const long double scaled = std::floor(std::ldexp(static_cast<long double>(clean(value)), places));
  if (scaled <= static_cast<long double>(Limits::min())) return Limits::min();
  if (scaled >= static_cast<long double>(Limits::max())) return Limits::max();
  return static_cast<Integer>(scaled);
}

TYPED_TEST(SoftFloatOf, ConvertsToIntegersTowardsMinusInfinity) {  // 2.8.3.2.2
  using Real = TypeParam;
  Operands<Real> operands;
  for (int i = 0; i < test::scaled(200'000); ++i) {
    const Real x = operands.one();
    const int n = static_cast<int>(operands.random()() % 100) - 30;
    const auto of = [&](Function function) {
      Registers r = registers(x);
      r[is_single<Real> ? 1 : 2] = static_cast<std::uint32_t>(n);
      return call_of<Real>(function, r);
    };
    const auto signed_word = [](const Registers& r) { return static_cast<std::int32_t>(r[0]); };
    const auto signed_pair = [](const Registers& r) {
      return static_cast<std::int64_t>(joined(r));
    };
    ASSERT_EQ(signed_word(of(Function::to_int)), (rounded_down<std::int32_t>(x, 0))) << x;
    ASSERT_EQ(signed_word(of(Function::to_fix)), (rounded_down<std::int32_t>(x, n))) << x << n;
    ASSERT_EQ(of(Function::to_uint)[0], (rounded_down<std::uint32_t>(x, 0))) << x;
    ASSERT_EQ(of(Function::to_ufix)[0], (rounded_down<std::uint32_t>(x, n))) << x << n;
    ASSERT_EQ(signed_pair(of(Function::to_int64)), (rounded_down<std::int64_t>(x, 0))) << x;
    ASSERT_EQ(signed_pair(of(Function::to_fix64)), (rounded_down<std::int64_t>(x, n))) << x << n;
    ASSERT_EQ(joined(of(Function::to_uint64)), (rounded_down<std::uint64_t>(x, 0))) << x;
    ASSERT_EQ(joined(of(Function::to_ufix64)), (rounded_down<std::uint64_t>(x, n))) << x << n;
  }
}

TEST(SoftFloat, ConvertsExamplesToIntegers) {
  EXPECT_EQ(call(Function::to_ufix, Precision::float32, {bits(0.5f), 16, 0, 0})[0], 0x8000u);
  EXPECT_EQ(call(Function::to_int, Precision::float32, {bits(-0.25f), 0, 0, 0})[0], ~0u);
  EXPECT_EQ(call(Function::to_int, Precision::float32, {bits(-0.0f), 0, 0, 0})[0], 0u);
  EXPECT_EQ(call(Function::to_int, Precision::float32, {bits(-0.0f), 0, 0, 0}, 1)[0], ~0u);
}

TEST(SoftFloat, ConvertsFromIntegersToTheNearest) {
  std::mt19937_64 random(18);
  for (int i = 0; i < test::scaled(100'000); ++i) {
    const std::uint64_t u = random() >> random() % 64;
    const auto s = static_cast<std::int64_t>(random() % 2 == 0 ? u : 0 - u);
    const int n = static_cast<int>(random() % 60);
    const auto low = static_cast<std::uint32_t>(u), places = static_cast<std::uint32_t>(n);
    const auto high = static_cast<std::uint32_t>(u >> 32);
    const auto signed_low = static_cast<std::uint32_t>(s);
    const auto signed_high = static_cast<std::uint32_t>(static_cast<std::uint64_t>(s) >> 32);
    const auto as_float = [](const Registers& r) { return std::bit_cast<float>(r[0]); };
    const auto as_double = [](const Registers& r) { return std::bit_cast<double>(joined(r)); };
    const auto f = Precision::float32, d = Precision::float64;
    EXPECT_EQ(as_float(call(Function::from_uint, f, {low, 0, 0, 0})), static_cast<float>(low));
    EXPECT_EQ(as_float(call(Function::from_int, f, {signed_low, 0, 0, 0})),
              static_cast<float>(static_cast<std::int32_t>(signed_low)));
    EXPECT_EQ(as_float(call(Function::from_fix64, f, {signed_low, signed_high, places, 0})),
              std::ldexp(static_cast<float>(s), -n));
    EXPECT_EQ(as_float(call(Function::from_ufix, f, {low, places, 0, 0})),
              std::ldexp(static_cast<float>(low), -n));
    EXPECT_EQ(as_double(call(Function::from_uint64, d, {low, high, 0, 0})), static_cast<double>(u));
    EXPECT_EQ(as_double(call(Function::from_int64, d, {signed_low, signed_high, 0, 0})),
              static_cast<double>(s));
    EXPECT_EQ(as_double(call(Function::from_fix, d, {signed_low, places, 0, 0})),
              std::ldexp(static_cast<double>(static_cast<std::int32_t>(signed_low)), -n));
  }
  EXPECT_EQ(twice(Function::convert, 0), 0);
  EXPECT_EQ(
      std::bit_cast<double>(joined(call(Function::convert, Precision::float32, {bits(0.1f)}))),
      static_cast<double>(0.1f));
  EXPECT_EQ(std::bit_cast<float>(call(Function::convert, Precision::float64, registers(0.1))[0]),
            0.1f);
  EXPECT_EQ(std::bit_cast<float>(call(Function::convert, Precision::float64, registers(1e300))[0]),
            inf_f);
}

TEST(SoftFloat, ScientificFunctionsAreWithinOneUnit) {  // 2.8.3.2.1
  std::mt19937_64 random(19);
  const auto near = [](auto value, long double exact) {
    using Real = decltype(value);
    const auto rounded = static_cast<Real>(exact);
    const Real ulp =
        std::abs(std::nextafter(rounded, std::numeric_limits<Real>::infinity()) - rounded);
    EXPECT_LE(std::abs(static_cast<long double>(value) - exact), static_cast<long double>(ulp));
  };
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) / 9007199254740992.0;
  };
  for (int i = 0; i < test::scaled(20'000); ++i) {
    const auto angle = static_cast<float>(uniform(-127.9, 127.9));
    near(single(Function::sine, angle), std::sin(static_cast<long double>(angle)));
    near(single(Function::cosine, angle), std::cos(static_cast<long double>(angle)));
    near(single(Function::tangent, angle), std::tan(static_cast<long double>(angle)));
    const double wide = uniform(-1023.9, 1023.9);
    near(twice(Function::sine, wide), std::sin(static_cast<long double>(wide)));
    near(twice(Function::cosine, wide), std::cos(static_cast<long double>(wide)));
    near(twice(Function::tangent, wide), std::tan(static_cast<long double>(wide)));
    const double power = uniform(-80, 80);
    near(single(Function::exponential, static_cast<float>(power)),
         std::exp(static_cast<long double>(static_cast<float>(power))));
    near(twice(Function::exponential, power), std::exp(static_cast<long double>(power)));
    const double positive = std::exp(uniform(-80, 80));
    near(single(Function::logarithm, static_cast<float>(positive)),
         std::log(static_cast<long double>(static_cast<float>(positive))));
    near(twice(Function::logarithm, positive), std::log(static_cast<long double>(positive)));
    const auto y = uniform(-10, 10), x = uniform(-10, 10);
    near(twice(Function::arc_tangent2, y, x),
         std::atan2(static_cast<long double>(y), static_cast<long double>(x)));
    near(single(Function::arc_tangent2, static_cast<float>(y), static_cast<float>(x)),
         std::atan2(static_cast<long double>(static_cast<float>(y)),
                    static_cast<long double>(static_cast<float>(x))));
  }
  EXPECT_EQ(single(Function::exponential, 1000), inf_f);
  EXPECT_EQ(single(Function::exponential, -1000), 0);
}

// --- on a core ---

/// A chip whose core 0 the test controls.
class RomFloat : public testing::Test {
 protected:
  static constexpr std::uint32_t code = 0x2000'0000;

  explicit RomFloat(unsigned version = 3) : chip_(options(version)) { chip_.core(0).reset(0); }
  static ChipOptions options(unsigned version) {
    ChipOptions made;
    made.rom_version = version;
    return made;
  }
  void put(std::uint32_t address, const std::vector<std::uint16_t>& halfwords) {
    std::memcpy(chip_.bus().memory_at(address).data(), halfwords.data(), halfwords.size() * 2);
  }
  void run_to(std::uint32_t stop) {
    for (int i = 0; i < 100'000 && chip_.core(0).reg(15) != stop; ++i) chip_.core(0).step();
    ASSERT_EQ(chip_.core(0).reg(15), stop);
  }
  /// As pico-sdk's rom_data_lookup(), with the half-words at 0x16 and 0x18.
  std::uint32_t data_lookup(std::string_view letters) {
    // MOVS r3, #0x14; LDRH r0, [r3, #2]; LDRH r3, [r3, #4]; BLX r3; B .
    put(code, {0x2314, 0x8858, 0x889b, 0x4798, 0xe7fe});
    chip_.core(0).set_reg(1, static_cast<std::uint32_t>(letters[0] | letters[1] << 8));
    chip_.core(0).set_reg(15, code);
    run_to(code + 8);
    return chip_.core(0).reg(0);
  }
  std::uint32_t word(std::uint32_t address) {
    return chip_.bus().read(address, Width::word, Master::core0, chip_.core(0).cycle()).value;
  }
  Registers run(std::uint32_t function, const Registers& arguments) {
    put(code, {0x47b8, 0xe7fe});  // BLX r7; B .
    for (unsigned i = 0; i < 4; ++i) chip_.core(0).set_reg(i, arguments[i]);
    chip_.core(0).set_reg(7, function);
    chip_.core(0).set_reg(15, code);
    const Cycle begin = chip_.core(0).cycle();
    run_to(code + 2);
    cycles_ = chip_.core(0).cycle() - begin - 2;
    return {chip_.core(0).reg(0), chip_.core(0).reg(1), chip_.core(0).reg(2), chip_.core(0).reg(3)};
  }

  Chip chip_;
  Cycle cycles_ = 0;
};

TEST_F(RomFloat, FunctionsAreFoundThroughTheDataTable) {
  const std::uint32_t table_f = data_lookup("SF"), table_d = data_lookup("SD");
  ASSERT_NE(table_f, 0u);
  ASSERT_NE(table_d, 0u);
  EXPECT_EQ(table_f % 4, 0u);
  // pico-sdk compares the byte two before the table, times four, with the 0x80 of version 2.
  EXPECT_EQ(chip_.bus().rom()[table_f - 2] * 4, 0x80);
  EXPECT_TRUE(chip_.not_modelled().empty());

  const Registers operands_f = {bits(1.5f), bits(-0.75f), 3, 0};
  const Registers operands_d = registers(1.5, -0.75);
  const RomTiming timing;
  for (unsigned i = 0; i < soft_float::functions; ++i) {
    const auto function = static_cast<Function>(i);
    EXPECT_EQ(run(word(table_f + 4 * i), operands_f),
              call(function, Precision::float32, operands_f))
        << i;
    const Cycle flags = function == Function::compare_fast_flags ? 1 : 0;
    EXPECT_EQ(cycles_, timing.float_cycles[i] + flags) << i;
    EXPECT_EQ(run(word(table_d + 4 * i), operands_d),
              call(function, Precision::float64, operands_d))
        << i;
    EXPECT_EQ(cycles_, timing.double_cycles[i] + flags) << i;
  }
  // Offsets of the table (2.8.3.2.2): 0x08 multiplies, 0x1c makes an integer, 0x7c a double.
  EXPECT_EQ(run(word(table_f + 0x08), {bits(3.0f), bits(4.0f)})[0], bits(12.0f));
  EXPECT_EQ(run(word(table_f + 0x1c), {bits(-2.5f)})[0], static_cast<std::uint32_t>(-3));
  EXPECT_EQ(joined(run(word(table_f + 0x7c), {bits(0.5f)})), bits(0.5));
  EXPECT_EQ(joined(run(word(table_d + 0x0c), registers(1.0, 3.0))), bits(1.0 / 3));
  // pico-sdk's sincosf and sincos rely on this.
  const Registers both = run(word(table_f + 0x40), {bits(1.0f)});
  EXPECT_EQ(both[1], run(word(table_f + 0x3c), {bits(1.0f)})[0]);
  const Registers pair = run(word(table_d + 0x48), registers(1.0));
  const Registers cosine = run(word(table_d + 0x3c), registers(1.0));
  EXPECT_EQ(pair[2], cosine[0]);
  EXPECT_EQ(pair[3], cosine[1]);
}

TEST_F(RomFloat, DivisionLeavesTracesInTheDividerAsTheSdkExpects) {
  constexpr std::uint32_t dividend = 0xd000'0060;
  Core& core = chip_.core(0);
  chip_.bus().write(dividend, 1234, Width::word, Master::core0, core.cycle());
  const std::uint32_t table = data_lookup("SF");
  run(word(table + 0x00), {bits(1.0f), bits(3.0f)});
  EXPECT_EQ(word(dividend), 1234u) << "addition must not use the divider";
  run(word(table + 0x0c), {bits(1.0f), bits(3.0f)});
  EXPECT_NE(word(dividend), 1234u) << "pico-sdk saves it around __aeabi_fdiv for this";
}

TEST_F(RomFloat, AngleBeyondTheRangeIsReported) {
  const std::uint32_t table = data_lookup("SF");
  run(word(table + 0x40), {bits(127.0f)});
  EXPECT_TRUE(chip_.not_modelled().empty());
  run(word(table + 0x40), {bits(128.0f)});
  ASSERT_EQ(chip_.not_modelled().size(), 1u);
  EXPECT_NE(chip_.not_modelled()[0].find("float function of an angle"), std::string::npos);
}

TEST_F(RomFloat, AnInterruptDuringAFunctionHasLowLatencyAndNoEffect) {
  Core& core = chip_.core(0);
  const std::uint32_t table = data_lookup("SD");
  const std::uint32_t tangent = word(table + 0x44);
  const Registers wanted = run(tangent, registers(0.7));
  const std::uint32_t handler = 0x2000'0201;
  std::memcpy(chip_.bus().memory_at(0x2000'0140).data(), &handler, 4);
  // The handler overwrites the permitted registers: MOVS r0..r3, #0; BX LR.
  put(0x2000'0200, {0x2000, 0x2100, 0x2200, 0x2300, 0x4770});
  core.set_vtor(0x2000'0100);
  put(0x2000'0300, {0x6001, 0xe7fe});  // STR r1, [r0]: NVIC_ISER
  core.set_reg(0, 0xe000'e100);
  core.set_reg(1, 1);
  core.set_reg(15, 0x2000'0300);
  core.step();
  constexpr std::uint32_t force = 0x4005'403c, enable = 0x4005'4038, resets_clear = 0x4000'f000;
  chip_.bus().write(resets_clear, 1u << 21, Width::word, Master::core0, core.cycle());
  chip_.bus().write(enable, 0, Width::word, Master::core0, core.cycle());
  put(code, {0x47b8, 0xe7fe});
  for (unsigned i = 0; i < 4; ++i) core.set_reg(i, registers(0.7)[i]);
  core.set_reg(7, tangent);
  core.set_reg(15, code);
  std::mt19937_64 random(20);
  Cycle next = core.cycle() + 100, raised = 0, longest = 0;
  int taken = 0;
  while (core.reg(15) != code + 2) {
    core.step();
    if (raised == 0 && core.cycle() >= next) {
      chip_.bus().write(force, 1, Width::word, Master::core0, core.cycle());
      raised = core.cycle();
    }
    if (raised != 0 && core.exception() == 16) {
      longest = std::max(longest, core.cycle() - raised);
      chip_.bus().write(force, 0, Width::word, Master::core0, core.cycle());
      raised = 0;
      next = core.cycle() + 60 + random() % 60;
      ++taken;
    }
    ASSERT_LT(core.cycle(), 1'000'000u);
  }
  EXPECT_GT(taken, 5);
  EXPECT_LE(longest, 15u + RomTiming{}.float_step + 2);
  for (unsigned i = 0; i < 2; ++i) EXPECT_EQ(core.reg(i), wanted[i]);
}

template <unsigned version>
struct RomFloatOf : RomFloat {
  RomFloatOf() : RomFloat(version) {}
};
using RomVersion1 = RomFloatOf<1>;
using RomVersion2 = RomFloatOf<2>;
TEST_F(RomVersion1, HasTheShortFloatTableOnly) {
  EXPECT_EQ(chip_.bus().rom()[0x13], 1);
  EXPECT_EQ(data_lookup("SD"), 0u);
  const std::uint32_t table = data_lookup("SF");
  EXPECT_EQ(chip_.bus().rom()[table - 2] * 4, 0x54);
  EXPECT_EQ(run(word(table + 0x50), {bits(1.0f)})[0], bits(0.0f)) << "the last one: logarithm";
}

TEST_F(RomVersion2, HasBothTablesWithoutSineAndCosineTogether) {
  EXPECT_EQ(chip_.bus().rom()[0x13], 2);
  const std::uint32_t table = data_lookup("SD");
  EXPECT_EQ(run(word(table + 0x54), registers(1.0, 2.0))[0], ~0u);
  EXPECT_EQ(word(table + 0x48), BootRom::fault_address | 1u);
}

TEST(RomVersions, OthersAreRefused) {
  ChipOptions options;
  options.rom_version = 4;
  EXPECT_THROW(Chip chip(options), std::invalid_argument);
}

TEST_F(RomFloat, DebugTrampolineEndsAtItsBreakpoint) {  // 2.8.3.1.4
  const std::uint32_t trampoline = chip_.rom().function('D', 'T');
  const std::uint32_t end = chip_.rom().function('D', 'E');
  ASSERT_NE(trampoline, 0u);
  chip_.core(0).set_reg(7, chip_.rom().function('P', '3'));
  chip_.core(0).set_reg(0, 0xf0f0);
  chip_.core(0).set_reg(15, trampoline & ~1u);
  run_to(end & ~1u);
  EXPECT_EQ(chip_.core(0).reg(0), 8u);
  EXPECT_EQ(word(end & ~3u) >> (end & 2u) * 8 & 0xffffu, 0xbe00u) << "BKPT #0";
}

}  // namespace
}  // namespace lamplock::sim::chip::rom_float_test
