// The interpreter compared with another one in exact rational numbers: random programs end every
// line at the same place.
#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/program/exact_interpreter.hpp"
#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::interpreter_exact_test {
namespace {

using lamplock::test::scaled;
using test::ExactInterpreter;
using test::Rig;

/// Generates a sequence of valid lines.
class Programs {
 public:
  explicit Programs(unsigned seed) : random_(seed) {}

  std::string line() {
    switch (random_() % 16) {
      case 0:
        return units();
      case 1:
        return one_of({"G90", "G91"});
      case 2:
        return one_of({"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"});
      case 3:
        return fmt::format("G10 L2 P{}{}", random_() % 10, axes());
      case 4:
        return fmt::format("G10 L20 P{}{}", random_() % 10, axes());
      case 5:
        return fmt::format("G92{}", axes());
      case 6:
        return one_of({"G92.1", "G92.2", "G92.3", "G28.1", "G30.1", "G49"});
      case 7:
        return one_of({"G28", "G30"}) + (random_() % 2 == 0 ? "" : axes());
      case 8:
        return fmt::format("G43.1 Z{}", number());
      case 9:
        return one_of({"G53 G0", "G53 G1 F100"}) + axes();
      case 10:
        return one_of({"G17", "G18", "G19", "G98", "G99"});
      case 11:
        return cycle();
      case 12:
        return half_circle();
      case 13:
        return one_of({"G0 G90 ", "G1 F5 G91 "}) + units_and_axes();
      default:
        return one_of({"G0", "G1 F100"}) + axes();
    }
  }

 private:
  std::string one_of(std::initializer_list<const char*> texts) {
    return texts.begin()[random_() % texts.size()];
  }
  std::string units() {
    inches_ = random_() % 2 == 0;
    return inches_ ? "G20" : "G21";
  }
  /// Six decimals, which are exact in both units.
  std::string number() {
    const std::int64_t most = inches_ ? 2'000'000 : 50'000'000;
    const std::int64_t n = static_cast<std::int64_t>(random_()) % most;
    const std::int64_t magnitude = (n < 0 ? -n : n) >> random_() % 24;
    std::string digits = std::to_string(magnitude);
    while (digits.size() < 7) digits.insert(0, "0");
    digits.insert(digits.size() - 6, ".");
    return fmt::format("{}{}", n < 0 ? "-" : "", digits);
  }
  std::string axes() {
    std::string text;
    while (text.empty())
      for (const char letter : {'Z', 'A', 'X', 'Y'})
        if (random_() % 2 == 0) text += fmt::format(" {}{}", letter, number());
    return text;
  }
  std::string units_and_axes() {
    const std::string code = units();
    return code + axes();
  }

  /// A cycle on its own line with all its words; R is above Z.
  std::string cycle() {
    const std::string plane = one_of({"G17", "G18", "G19"});
    const char normal = plane == "G17" ? 'Z' : plane == "G18" ? 'Y' : 'X';
    std::string text = one_of({"G73 Q0.1", "G81", "G82 P0.5", "G83 Q0.5"}) + plane + " F100 R1." +
                       std::to_string(random_() % 1000);
    text += (random_() % 2 == 0 ? " G91 " : " G90 ") + std::string(1, normal) + "-" +
            std::to_string(random_() % 2) + ".25";
    for (const char letter : {'X', 'Y', 'Z', 'A'})
      if (letter != normal && random_() % 2 == 0) text += fmt::format("{}{}", letter, number());
    if (random_() % 2 == 0) text += fmt::format(" L{}", 1 + random_() % 5);
    return text;
  }
  std::string half_circle() {
    const std::int64_t i = 1 + static_cast<std::int64_t>(random_() % 1'000'000);
    const std::string digits = std::to_string(1'000'000 + i).substr(1);
    const std::string twice = std::to_string(10'000'000 + 2 * i).substr(1);
    std::string text = one_of({"G2", "G3"}) + " G17 G91 F100 X" + twice.substr(0, 1) + "." +
                       twice.substr(1) + " I0." + digits;
    if (i == 1'000'000) text = "G91";
    if (random_() % 2 == 0) text += fmt::format(" Z{}", number());
    return text;
  }

  std::mt19937_64 random_;
  bool inches_ = false;
};

/// Compares the position with that of the exact interpreter.
::testing::AssertionResult same(const Place& place, const ExactInterpreter& exact) {
  for (std::size_t i = 0; i < place.size(); ++i)
    if (exact.position()[i] * one_e7 != place[i])
      return ::testing::AssertionFailure() << "axis " << i << ": " << test::decimal(place[i])
                                           << ", exactly " << exact.position()[i];
  return ::testing::AssertionSuccess();
}

TEST(ExactInterpreter, EndsEveryLineAtTheSamePlace) {
  int lines = 0;
  for (int run = 0; run < scaled(100); ++run) {
    Rig rig;
    ExactInterpreter exact;
    Programs programs(static_cast<unsigned>(run));
    std::string program;
    for (int i = 0; i < 60; ++i) {
      const std::string line = programs.line();
      program += line + "\n";
      const Fault fault = rig.interpreter.run(line);
      // Lines are valid except for targets and offsets that have drifted out of range.
      if (fault) {
        ASSERT_TRUE(fault.error == GcodeError::bad_target ||
                    fault.error == GcodeError::out_of_range)
            << test::text_of(fault) << "\n"
            << program;
        break;
      }
      ++lines;
      exact.run(line);
      ASSERT_TRUE(same(rig.machine(), exact)) << program;
      Place last = rig.machine();
      Action action;
      while (rig.interpreter.next(action))
        if (action.kind == ActionKind::move) last = action.target_e7;
      ASSERT_EQ(last, rig.machine()) << program;
    }
  }
  EXPECT_GT(lines, scaled(100) * 40);
}

}  // namespace
}  // namespace lamplock::program::interpreter_exact_test
