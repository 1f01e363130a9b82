// Random programs for the virtual board, and their ends in exact rational numbers.
//
// In:  a seed.
// Out: lines that are valid in sequence and stay near the middle of a work space of 2 m, and the
//      result of the exact interpreter (tests/program/exact_interpreter.hpp).
// Used by program_exact_test.cpp.
//
// The exact interpreter has no rotation. A rotated stretch of a program is turned by whole right
// angles, which is exact: during it the interpreter is at the program's unrotated place. Moves in
// machine coordinates take the interpreter there and back.
#pragma once

#include <fmt/format.h>

#include <random>
#include <string>

#include "tests/program/exact_interpreter.hpp"

namespace lamplock::test {

class ExactProgram {
 public:
  using Exact = program::test::ExactInterpreter;
  using Rational = Exact::Rational;

  explicit ExactProgram(unsigned seed) : random_(seed) {}

  /// The next lines, each with its end.
  std::string lines() {
    std::string text;
    switch (random_() % 12) {
      case 0:
        return run(one_of({"G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"}));
      case 1:
        return run(fmt::format("G10 L{} P{}{}", one_of({"2", "20"}), pick(10), axes()));
      case 2:
        return run("G92" + axes());
      case 3:
        return run(one_of({"G92.1", "G92.2", "G92.3", "G28.1", "G30.1", "G49"}) +
                   one_of({"", " G98", " G99"}));
      case 4:
        return run(one_of({"G28", "G30"}) + (pick(2) == 0 ? "" : axes()));
      case 5:
        return run("G43.1 Z" + number());
      case 6:
        return run(one_of({"G53 G0", "G53 G1 F20000"}) + axes());
      case 7:
        return run(cycle());
      case 8:
        return run(half_circle(pick(3)));
      case 9:
        return rotated();
      default:
        return move();
    }
  }

  /// Position of the machine, mm.
  const Exact::Point& position() const { return exact_.position(); }

 private:
  unsigned pick(unsigned count) { return static_cast<unsigned>(random_() % count); }
  std::string one_of(std::initializer_list<const char*> texts) {
    return texts.begin()[random_() % texts.size()];
  }
  std::string run(const std::string& line) {
    exact_.run(line);
    return line + "\n";
  }

  /// A number with six decimals, exact in both units; at most 8 mm or a third of an inch.
  std::string number() {
    const std::int64_t most = inches_ ? 333'333 : 8'000'000;
    const std::int64_t n = static_cast<std::int64_t>(random_() % static_cast<unsigned>(2 * most));
    const std::int64_t signed_n = n - most;
    return decimal(signed_n);
  }
  static std::string decimal(std::int64_t millionths) {
    const std::int64_t magnitude = millionths < 0 ? -millionths : millionths;
    return fmt::format("{}{}.{:06}", millionths < 0 ? "-" : "", magnitude / 1'000'000,
                       magnitude % 1'000'000);
  }
  std::string axes() {
    std::string text;
    while (text.empty())
      for (const char letter : {'Z', 'X', 'Y'})
        if (pick(2) == 0) text += fmt::format(" {}{}", letter, number());
    return text;
  }
  std::string units() {
    inches_ = pick(2) == 0;
    return inches_ ? "G20" : "G21";
  }

  std::string move() {
    const std::string modes = units() + one_of({"", " G90", " G91"});
    return run(modes + one_of({" G0", " G1"}) + " F9000" + axes());
  }

  /// A cycle with R above the bottom and holes close together.
  std::string cycle() {
    const std::string plane = one_of({"G17", "G18", "G19"});
    const char normal = plane == "G17" ? 'Z' : plane == "G18" ? 'Y' : 'X';
    std::string text = units() + " " + one_of({"G73 Q0.1", "G81", "G82 P0.001", "G83 Q0.2"}) + " " +
                       plane + " F9000 R0." + std::to_string(pick(1000));
    text += one_of({" G91 ", " G90 "}) + std::string(1, normal) + "-0." + std::to_string(pick(10));
    for (const char letter : {'X', 'Y', 'Z'})
      if (letter != normal && pick(2) == 0) text += fmt::format(" {}{}", letter, number());
    if (pick(2) == 0) text += fmt::format(" L{}", 1 + pick(3));
    return text;
  }

  /// A half circle, now and then a whole one. Plane: XY, ZX, YZ.
  std::string half_circle(unsigned plane) {
    const char* first = plane == 0 ? "XI" : plane == 1 ? "ZK" : "YJ";
    const char normal = plane == 0 ? 'Z' : plane == 1 ? 'Y' : 'X';
    const std::int64_t offset = 1 + static_cast<std::int64_t>(random_() % 3'000'000);
    const std::int64_t way = pick(4) == 0 ? 0 : 2 * offset;
    inches_ = false;
    std::string text = fmt::format("G21 G{} G{} G91 F9000 {}{} {}{}", 2 + pick(2), 17 + plane,
                                   first[0], decimal(way), first[1], decimal(offset));
    if (pick(2) == 0) text += fmt::format(" {}{}", normal, number());
    if (pick(3) == 0) text += " P2";
    return text;
  }

  /// Decimal text of a coordinate; all are whole multiples of 10^-7 mm.
  static std::string text_of(const Rational& mm) {
    const Rational scaled_mm = mm * 10'000'000;
    const auto e7 = boost::multiprecision::numerator(scaled_mm).convert_to<std::int64_t>();
    const std::int64_t magnitude = e7 < 0 ? -e7 : e7;
    return fmt::format("{}{}.{:07}", e7 < 0 ? "-" : "", magnitude / 10'000'000,
                       magnitude % 10'000'000);
  }
  /// Moves the exact interpreter to its place after a turn by this number of right angles.
  void turn(const std::array<Rational, 2>& centre, unsigned right_angles) {
    Rational x = exact_.position()[0] - centre[0], y = exact_.position()[1] - centre[1];
    for (unsigned i = 0; i < right_angles; ++i) {
      const Rational was = x;
      x = -y;
      y = was;
    }
    exact_.run("G21 G53 G0 X" + text_of(centre[0] + x) + " Y" + text_of(centre[1] + y));
  }

  /// A stretch that is rotated about the machine's place at its begin.
  std::string rotated() {
    const unsigned quarters = 1 + pick(3);
    const std::array<Rational, 2> centre{exact_.position()[0], exact_.position()[1]};
    std::string text = fmt::format("G17 G21\nG68 R{}\n", 90 * quarters);
    exact_.run("G17 G21");
    for (unsigned i = 1 + pick(4); i > 0; --i) text += pick(4) == 0 ? run(half_circle(0)) : move();
    text += "G21 G0\nG69\n";
    inches_ = false;
    turn(centre, quarters);
    return text;
  }

  std::mt19937_64 random_;
  Exact exact_;
  bool inches_ = false;
};

}  // namespace lamplock::test
