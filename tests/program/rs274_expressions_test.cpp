// Random expressions, parameters and assignments by the board's interpreter and by LinuxCNC's
// rs274: the same places, and the same lines refused.
//
// The generator knows the value of what it writes and leaves out what depends on the last bit of a
// binary fraction: remainders and whole numbers of values close to a step, comparisons of almost
// equal ones, quotients of tiny ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "tests/program/rig.hpp"
#include "tests/program/rs274.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::rs274_expressions_test {
namespace {

using lamplock::test::scaled;
using test::CanonicalLine;
using test::CanonicalMove;
using test::Rig;
using test::Rs274;

/// rs274 prints four decimals.
constexpr double tolerance_mm = 1e-4;

/// A value as text, and what it is; not a number if it must not be used.
struct Term {
  std::string text;
  double value = std::nan("");
};

class Expressions {
 public:
  explicit Expressions(unsigned seed) : random_(seed) {}

  Rs274::Program program(int lines) {
    values_ = {};
    // Another program in the same process may have set them.
    Rs274::Program program{"#1=0 #2=0 #3=0 #4=0 #5=0", "#<local>=0 #<_global>=0", "G0 X0 Y0"};
    for (int i = 0; i < lines; ++i) program.push_back(line());
    return program;
  }

 private:
  static constexpr std::array<const char*, 7> parameters{"#1", "#2",       "#3",        "#4",
                                                         "#5", "#<local>", "#<_Global>"};

  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

  /// A line that both read: rs274 (LINELEN of LinuxCNC) takes 254 characters, the board 256.
  std::string line() {
    constexpr std::size_t max_length = 254;
    const auto old = values_;
    for (;;) {
      values_ = old;
      std::string text = below(12) == 0 ? bad_line() : good_line();
      if (text.size() <= max_length) return text;
    }
  }

  std::string good_line() {
    const auto old = values_;
    std::string text;
    if (below(3) == 0) {
      const Term x = value_within(900), y = value_within(900);
      text = fmt::format("G{} X{} Y{}", below(2), x.text, y.text);
    }
    if (text.empty() || below(2) == 0)
      for (int i = below(3) + 1; i > 0; --i) {
        const std::size_t to = static_cast<std::size_t>(below(static_cast<int>(parameters.size())));
        auto after = values_;
        values_ = old;  // assignments act after the line
        const Term term = value_within(3000);
        values_ = after;
        text += fmt::format(" {}={}", parameters[to], term.text);
        values_[to] = term.value;
      }
    return text;
  }

  /// Nothing of it may act.
  std::string bad_line() {
    static constexpr std::array faults{
        "[1/0]",      "[5 mod 0]", "sqrt[-1]", "ln[0]",     "acos[1.5]", "asin[-2]",
        "#<missing>", "[1+2",      "[1+]",     "[]",        "#6000",     "#0",
        "#1.5",       "[0**-1]",   "foo[1]",   "[1 foo 2]", "atan[1]",   "[[-8]**.5]"};
    return fmt::format("#1=17 G1 X{} #2=18",
                       faults[static_cast<std::size_t>(below(static_cast<int>(faults.size())))]);
  }

  Term value_within(double limit) {
    for (;;) {
      Term term = value(below(4));
      if (std::isfinite(term.value) && std::abs(term.value) < limit) return term;
    }
  }

  Term number() {
    const int n = below(20001) - 10000;
    const int decimals = below(4);
    const double value = n / std::pow(10, decimals);
    return {fmt::format("{:.{}f}", value, decimals), value};
  }

  /// A number, a parameter, a function, an expression, or one of them with a sign.
  Term value(int depth) {
    switch (depth == 0 ? below(3) : 2 + below(4)) {
      case 0:
        return number();
      case 1:
      case 2: {
        const std::size_t i = static_cast<std::size_t>(below(static_cast<int>(parameters.size())));
        if (i < 5 && below(4) == 0) return {fmt::format("#[{}+{}]", i, 1), values_[i]};
        return {parameters[i], values_[i]};
      }
      case 3: {
        const Term term = value(depth - 1);
        return {"-" + term.text, -term.value};
      }
      case 4:
        return function(depth - 1);
      default: {
        const Term term = sum(depth - 1);
        return {"[" + term.text + "]", term.value};
      }
    }
  }

  static double degrees(double radians) { return radians * 180 / std::numbers::pi; }
  static double radians(double degrees) { return degrees * std::numbers::pi / 180; }
  /// Not a number unless it holds.
  static double if_safe(bool is_safe, double value) { return is_safe ? value : std::nan(""); }
  /// How far a value is from the next multiple of a step.
  static double from_step(double value, double step) {
    return std::abs(std::remainder(value, step));
  }

  Term function(int depth) {
    const Term a = sum(depth), b = sum(depth);
    const double x = a.value;
    const bool has_fraction = from_step(x, 1) > 1e-5;
    const bool has_half = from_step(x - 0.5, 1) > 1e-5;
    const auto named = [&](const char* name, double value) {
      return Term{fmt::format("{}[{}]", name, a.text), value};
    };
    switch (below(14)) {
      case 0:
        return named("abs", std::abs(x));
      case 1:
        return named("acos", degrees(std::acos(if_safe(std::abs(x) < 0.999, x))));
      case 2:
        return named("ASIN", degrees(std::asin(if_safe(std::abs(x) < 0.999, x))));
      case 3:
      case 4:
        return {fmt::format("atan[{}]/[{}]", a.text, b.text),
                if_safe(std::hypot(x, b.value) > 0.1 && (std::abs(x) > 1e-3 || b.value > 0),
                        degrees(std::atan2(x, b.value)))};
      case 5:
        return named("Cos", std::cos(radians(x)));
      case 6:
        return named("exp", std::exp(if_safe(x < 9, x)));
      case 7:
        return named("fix", if_safe(has_fraction, std::floor(x)));
      case 8:
        return named("fup", if_safe(has_fraction, std::ceil(x)));
      case 9:
        return named("ln", std::log(if_safe(x > 0.01, x)));
      case 10:
        return named("round", if_safe(has_half, std::round(x)));
      case 11:
        return named("sin", std::sin(radians(x)));
      case 12:
        return named("sqrt", std::sqrt(if_safe(x > 1e-3, x)));
      default:
        return named("tan", std::tan(radians(if_safe(from_step(x - 90, 180) > 1, x))));
    }
  }

  /// Operators of several precedences in turn, without brackets; the value by a tree of its own.
  Term sum(int depth) {
    Term term = product(depth);
    for (int i = below(3); i > 0; --i) {
      const Term next = product(depth);
      const bool plus = below(2) == 0;
      term = {term.text + (plus ? " + " : " - ") + next.text,
              plus ? term.value + next.value : term.value - next.value};
    }
    if (below(8) != 0) return term;
    return comparison(term, product(depth));
  }

  Term comparison(const Term& a, const Term& b) {
    static constexpr std::array names{" eq ", " NE ",  " gt ", " ge ", " lt ",
                                      " le ", " and ", " or ", " xor "};
    const double x = a.value, y = b.value;
    const bool is_safe = std::abs(x - y) > 1e-3 && std::abs(x) > 1e-6 && std::abs(y) > 1e-6;
    const std::array<bool, 9> results{x == y, x != y, x > y, x >= y, x < y,
                                      x <= y, true,   true,  false};
    const std::size_t i = static_cast<std::size_t>(below(9));
    return {a.text + names[i] + b.text, if_safe(is_safe, results[i] ? 1 : 0)};
  }

  Term product(int depth) {
    Term term = power(depth);
    for (int i = below(3); i > 0; --i) {
      const Term next = power(depth);
      const double x = term.value, y = next.value;
      switch (below(3)) {
        case 0:
          term = {term.text + "*" + next.text, if_safe(std::abs(x * y) < 1e6, x * y)};
          break;
        case 1:
          term = {term.text + " / " + next.text, if_safe(std::abs(y) > 0.05, x / y)};
          break;
        default: {
          const double rest = std::fmod(x, y);
          term = {term.text + " mod " + next.text,
                  if_safe(std::abs(y) > 0.05 && from_step(x, y) > 1e-5 * std::max(1.0, std::abs(x)),
                          rest < 0 ? rest + std::abs(y) : rest)};
        }
      }
    }
    return term;
  }

  /// A sign belongs to its number: -2**2 is 4.
  Term power(int depth) {
    Term term = value(depth);
    if (below(6) != 0) return term;
    if (below(2) == 0) {
      const int n = below(6) - 2;
      return {fmt::format("{}**{}", term.text, n),
              if_safe(std::abs(term.value) > 0.1 && std::abs(term.value) < 30,
                      std::pow(term.value, n))};
    }
    const Term exponent = number();
    return {
        fmt::format("{}**[{} / 2000]", term.text, exponent.text),
        if_safe(term.value > 0.1 && term.value < 100, std::pow(term.value, exponent.value / 2000))};
  }

  std::mt19937 random_;
  std::array<double, parameters.size()> values_{};
};

void expect_same(const Rs274::Program& program, const std::vector<CanonicalLine>& lines) {
  Rig rig;
  rig.run("G21 G90 G54 F100");
  std::string text;
  for (std::size_t i = 0; i < program.size(); ++i) {
    text += program[i] + "\n";
    const Fault fault = rig.interpreter.run(program[i]);
    ASSERT_EQ(static_cast<bool>(fault), !lines[i].refusal.empty())
        << text << test::text_of(fault) << " / " << lines[i].refusal;
    rig.take();
    if (lines[i].moves.empty()) continue;
    const std::array<double, 4>& there = lines[i].moves.back().to_mm;
    for (std::size_t axis = 0; axis < 2; ++axis)
      ASSERT_NEAR(static_cast<double>(rig.machine()[axis]) / one_e7, there[axis], tolerance_mm)
          << text;
  }
}

TEST(Rs274Expressions, RandomProgramsComputeAlike) {
  if (!Rs274::available()) GTEST_SKIP() << "toolchain/setup could not unpack rs274";
  constexpr int programs_a_process = 50, lines_a_program = 20;
  Rs274 rs274;
  const int count = scaled(1000, 100);
  for (int done = 0; done < count; done += programs_a_process) {
    Expressions random(1 + static_cast<unsigned>(done));
    std::vector<Rs274::Program> programs;
    programs.reserve(programs_a_process);
    for (int i = 0; i < programs_a_process; ++i)
      programs.push_back(random.program(lines_a_program));
    const auto results = rs274.run(programs, "G21 G17 G90 G94 G54 G61 G80 G92.1 F100");
    for (std::size_t i = 0; i < programs.size(); ++i) {
      expect_same(programs[i], results[i]);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

}  // namespace
}  // namespace lamplock::program::rs274_expressions_test
