// Lines of pixels: a G1 whose S word is a list of powers.
#include "firmware/program/power_list.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/program/refusals.hpp"
#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::test::power_list_test {
namespace {

Options laser_options() {
  Options options;
  options.laser = true;
  return options;
}

/// An interpreter of a laser, with the power on.
struct Laser {
  Parameters parameters;
  Options options = laser_options();
  Interpreter interpreter{parameters, options};

  Laser() { EXPECT_FALSE(run("G21 G90 G94 M3 S0 F6000")); }
  Fault run(std::string_view line) {
    const Fault fault = interpreter.run(line);
    actions.clear();
    for (Action action; interpreter.next(action);) actions.push_back(action);
    return fault;
  }
  std::vector<Action> actions;
};

std::vector<std::string> texts(const std::vector<Action>& actions) {
  std::vector<std::string> all;
  all.reserve(actions.size());
  for (const Action& action : actions) all.push_back(text_of(action));
  return all;
}

TEST(PowerList, DividesALineIntoPieces) {
  Laser laser;
  ASSERT_FALSE(laser.run("G1 X8 Y4 S10:20*5:0:400 N7"));
  EXPECT_EQ(
      texts(laser.actions),
      (std::vector<std::string>{
          "feed 6000 to 1 0.5 0 M3 S10 on the way N7", "feed 6000 to 6 3 0 M3 S20 on the way N7",
          "feed 6000 to 7 3.5 0 M3 S0 on the way N7", "feed 6000 to 8 4 0 M3 S400 N7"}));
  // The last power stays active, like a single S word.
  ASSERT_FALSE(laser.run("X9"));
  EXPECT_EQ(texts(laser.actions), (std::vector<std::string>{"feed 6000 to 9 4 0 M3 S400"}));
  // Equal powers are one piece; blanks and comments are dropped, the order of words is free.
  ASSERT_FALSE(laser.run("s1.5 : 1.5 (a) * 2:1.50x5 g61.1"));
  EXPECT_EQ(texts(laser.actions), (std::vector<std::string>{"feed 6000 to 5 4 0 M3 S1.5 stop"}));
  ASSERT_FALSE(laser.run("G91 X-2 S3:4"));
  EXPECT_EQ(texts(laser.actions), (std::vector<std::string>{"feed 6000 to 4 4 0 M3 S3 on the way",
                                                            "feed 6000 to 3 4 0 M3 S4 stop"}));
}

TEST(PowerList, ErrorsChangeNothing) {
  const Refusal refusals[] = {
      {"G1 X1 S1:", GcodeError::bad_number, 7},
      {"G1 X1 S1::2", GcodeError::bad_number, 7},
      {"G1 X1 S1:-2", GcodeError::negative_value, 7},
      {"G1 X1 S1*", GcodeError::bad_number, 7},
      {"G1 X1 S1*0:2", GcodeError::not_positive, 7},
      {"G1 X1 S1*1.5:2", GcodeError::not_integer, 7},
      {"G1 X1 S1*-1", GcodeError::negative_value, 7},
      {"G1 X1 S1*65536", GcodeError::out_of_range, 7},
      {"G1 X1 S1*65535:2", GcodeError::out_of_range, 7},
      {"G1 X1 S1:2*3*4", GcodeError::letter_expected, 13},
      {"G1 X1 S1:5000000", GcodeError::speed_out_of_range, 7},
      {"G1 X1:2", GcodeError::letter_expected, 6},
      {"G0 X1 S1:2", GcodeError::words_unused, 7},
      {"G2 X2 I1 S1:2", GcodeError::words_unused, 10},
      {"S1:2", GcodeError::words_unused, 1},
      {"G93 F10 G1 X1 S1:2", GcodeError::words_unused, 15},
      {"G1 X1 S1:2 M130 P0", GcodeError::words_unused, 7},
  };
  expect_refused<Laser>(refusals);
  Laser laser;
  const Fault fault = laser.run("G1 X1 S" + std::string(PowerList::max_characters, '0') + ":1");
  EXPECT_EQ(fault.error, GcodeError::line_too_long);
  EXPECT_EQ(fault.column, 7);
  // A spindle has one speed.
  Laser spindle;
  spindle.options.laser = false;
  EXPECT_EQ(spindle.run("G1 X1 S1:2").error, GcodeError::words_unused);
}

/// For any list, powers and ends are those of separate lines for each piece.
TEST(PowerList, GivesTheWrittenPieces) {
  std::mt19937_64 random(3);
  const auto below = [&random](std::uint32_t n) {
    return static_cast<std::uint32_t>(random() % n);
  };
  Laser laser;
  for (int i = 0; i < lamplock::test::scaled(300); ++i) {
    std::vector<std::uint32_t> powers;
    std::string text;
    for (std::uint32_t entries = 2 + below(22); entries != 0; --entries) {
      const std::uint32_t milli = below(3) == 0 ? 0 : below(1'000'000);
      const std::uint32_t count = below(3) != 0 ? 1 : 1 + below(below(4) == 0 ? 900 : 5);
      text += fmt::format("{}{}{}", text.empty() ? "S" : ":", milli / 1000.0,
                          count == 1 && below(9) != 0 ? "" : fmt::format("*{}", count));
      powers.insert(powers.end(), count, milli);
    }
    const Place from = laser.interpreter.machine_e7();
    const Place to{static_cast<std::int64_t>(below(2'000'000'000)) - 1'000'000'000,
                   static_cast<std::int64_t>(below(2'000'000'000)) - 1'000'000'000, from[2], 0};
    ASSERT_FALSE(laser.run(fmt::format("G1 X{} {} Y{}", decimal(to[0]), text, decimal(to[1]))))
        << text;
    std::size_t piece = 0;
    for (std::size_t n = 0; n < laser.actions.size(); ++n) {
      const Action& action = laser.actions[n];
      ASSERT_EQ(action.speed_milli, powers[piece]) << text;
      if (n != 0) {
        ASSERT_NE(action.speed_milli, laser.actions[n - 1].speed_milli) << text;
      }
      while (piece < powers.size() && powers[piece] == action.speed_milli) ++piece;
      for (std::size_t a = 0; a < to.size(); ++a) {
        const double part = static_cast<double>(piece) / static_cast<double>(powers.size());
        ASSERT_NEAR(static_cast<double>(action.target_e7[a]),
                    static_cast<double>(from[a]) + static_cast<double>(to[a] - from[a]) * part,
                    1.01)
            << text;
      }
      ASSERT_EQ(action.programmed_end, piece == powers.size()) << text;
    }
    ASSERT_EQ(piece, powers.size()) << text;
    ASSERT_EQ(laser.interpreter.machine_e7(), to);
    ASSERT_EQ(laser.actions.back().target_e7, to);
  }
}

}  // namespace
}  // namespace lamplock::program::test::power_list_test
