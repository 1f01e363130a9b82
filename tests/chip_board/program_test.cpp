// Programs of G-code on the chip: lines per second, and that they end where and when they do on the
// virtual board.
#include <fmt/format.h>

#include <cmath>
#include <deque>

#include "host/program/program_run.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr std::size_t window = 1024;

/// A machine with 5 um steps, 10 m/s2, 1 m/s, and no lamp.
job::Profile program_profile() {
  job::Profile profile = chip_profile(500);
  job::set_acceleration(profile, 10);
  job::set_speed(profile, 1);
  profile.settings.set_milli(Id::lamp_mode, 0);
  return profile;
}

/// Lines of `mm` on a spiral of some 20 mm.
std::string spiral(std::size_t lines, double mm, double feed_mm_min) {
  std::string text = fmt::format("G0 X20\nF{}\n", feed_mm_min);
  double angle = 0, radius = 20;
  for (std::size_t i = 0; i < lines; ++i) {
    angle += mm / radius;
    radius -= 1e-4;
    text += fmt::format("G1X{:.3f}Y{:.3f}\n", radius * std::cos(angle), radius * std::sin(angle));
  }
  return text;
}

/// What a sender sees of a stream.
struct Streamed {
  std::size_t answers = 0, errors = 0;
  Picoseconds first = 0, last = 0;  ///< answers
  Picoseconds rest = 0;             ///< the board says Idle
};

/// Counts characters, as senders do.
Streamed stream(ChipRig& rig, std::string_view text, Picoseconds limit) {
  Streamed result;
  std::deque<std::size_t> under_way;
  std::size_t bytes = 0, read = rig.heard.size();
  const Picoseconds end = rig.now() + limit;
  while (rig.now() < end && (!text.empty() || !under_way.empty())) {
    while (!text.empty()) {
      const std::size_t size = text.find('\n') + 1;
      if (bytes + size > window) break;
      rig.type(text.substr(0, size));
      text.remove_prefix(size);
      bytes += size;
      under_way.push_back(size);
    }
    rig.run(100 * ps_per_us);
    rig.listen();
    for (std::size_t at = rig.heard.find("\r\n", read); at != std::string::npos;
         at = rig.heard.find("\r\n", read)) {
      const std::string line = rig.heard.substr(read, at - read);
      read = at + 2;
      if (line != "ok" && !line.starts_with("error:")) continue;
      if (result.answers++ == 0) result.first = rig.now();
      if (line != "ok") ++result.errors;
      result.last = rig.now();
      bytes -= under_way.front();
      under_way.pop_front();
    }
  }
  while (rig.now() < end && !rig.status().starts_with("<Idle")) rig.run(ps_per_ms);
  result.rest = rig.now();
  return result;
}

/// 50 um at 100 mm/s are 2000 lines a second: the machine is as fast as that only if the lines are
/// parsed and planned so fast.
TEST(ChipProgram, RunsTwoThousandLinesASecond) {
  const job::Profile profile = program_profile();
  const auto lines = static_cast<std::size_t>(scaled(1000));
  const std::string text = spiral(lines, 0.05, 6000);
  const auto plan = program_run::run_program(text, profile.settings, 1);
  ASSERT_TRUE(plan.problems.empty());
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  const Picoseconds begin = rig.now();
  const Streamed streamed = stream(rig, text, 60 * ps_per_s);
  EXPECT_EQ(streamed.answers, lines + 2);
  EXPECT_EQ(streamed.errors, 0u);
  const double seconds = static_cast<double>(streamed.rest - begin) / 1e12;
  const double answered = static_cast<double>(streamed.last - streamed.first) / 1e12;
  std::cout << fmt::format(
      "{} lines of 50 um in {:.3f} s, planned {:.3f} s; answered {:.0f} lines/s\n", lines, seconds,
      plan.seconds(), static_cast<double>(lines) / answered);
  EXPECT_LE(seconds, 1.05 * plan.seconds() + 0.02);
}

/// Ends where the virtual board ends, as soon.
TEST(ChipProgram, EndsWhereAndWhenTheVirtualBoardDoes) {
  const job::Profile profile = program_profile();
  const std::string text =
      "G21 G90 G17\nG0 X3 Y1\nG1 X5 F3000\nG2 X7 Y3 I0 J2\nG3 X5 Y5 R2\nG91 G1 Z-0.5 F600\n"
      "G90 G5 I0 J1 P0 Q-1 X8 Y5\nG0 X1.005 Y2.0\nM2\n";
  const auto plan = program_run::run_program(text, profile.settings, 1);
  ASSERT_TRUE(plan.problems.empty());
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  const Picoseconds begin = rig.now();
  const Streamed streamed = stream(rig, text, 20 * ps_per_s);
  EXPECT_EQ(streamed.errors, 0u);
  EXPECT_NEAR(static_cast<double>(streamed.rest - begin) / 1e12, plan.seconds(), 0.03);
  EXPECT_EQ(rig.reported_position(profile.settings), (StepPosition{201, 400, -100, 0}));
  EXPECT_THAT(rig.heard, HasSubstr("[MSG:Pgm End]"));
}

TEST(ChipProgram, HoldsAndResets) {
  const job::Profile profile = program_profile();
  ChipRig rig(profile);
  ASSERT_NO_FATAL_FAILURE(rig.boot());
  rig.type("G1 X20 F3000\nG1 Y10\n");
  rig.run(100 * ps_per_ms);
  rig.type("!");
  rig.run(150 * ps_per_ms);
  EXPECT_THAT(rig.status(), StartsWith("<Hold:0|"));
  rig.type("~");
  rig.run(100 * ps_per_ms);
  EXPECT_THAT(rig.status(), StartsWith("<Run|"));
  rig.type("\x18");
  rig.run(150 * ps_per_ms);
  EXPECT_THAT(rig.status(), StartsWith("<Alarm|"));
  EXPECT_THAT(rig.heard, HasSubstr("ALARM:3"));
}

}  // namespace
}  // namespace lamplock::test
