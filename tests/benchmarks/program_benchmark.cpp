// Lines of G-code per second of the simulated chip, compared with other firmware: parsed, planned
// and run, streamed over USB by a sender that always has another line. The rate is in the chip's
// own time, so it is the same on every machine.
//
// Lines are 20 um long, on a spiral of some 20 mm, so a feed of 100 mm/s needs 5000 lines per
// second; rounding to steps lengthens the lines by 1 % at 200 steps/mm, 3.5 % at 80. Counters:
//   lines_per_s      that the machine runs, from its position: the board may take lines faster as
//                    long as its queues, two thousand lines, are not full
//   taken_per_s      that the board answers meanwhile
//   of_feed          fraction of the feed's rate, by lengths in steps: 1 = the board keeps up
//   core0, core1     fraction of the time that the core is awake
//   x_...            multiples of other firmware's rate
// An overloaded board stops repeatedly and may be slower than it can be: the highest rate of these
// rows is its capacity.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "host/job/job.hpp"
#include "sim/chip_board/chip_board.hpp"
#include "tests/chip_board/sleep_watch.hpp"
#include "tests/flash_image_path.hpp"
#include "tests/program_sender.hpp"

namespace lamplock {
namespace {

/// Text lines per second of other firmware.
constexpr double grbl_avr = 500;      // according to its author
constexpr double baud_115200 = 1047;  // calculated capacity of a link of that speed

constexpr double line_mm = 0.02, radius_mm = 20;
/// Lines until the machine has its speed.
constexpr std::size_t warm_up_lines = 3000;
constexpr std::size_t measured_lines = 2000;

/// 10 m/s2, 1 m/s, no lamp.
settings::Values machine(double steps_per_mm) {
  using settings::Id;
  job::Profile profile = job::default_profile();
  job::set_acceleration(profile, 10);
  job::set_speed(profile, 1);
  profile.settings.set_milli(Id::lamp_mode, 0);
  for (int axis = 0; axis < 3; ++axis)
    job::state_setting(profile, settings::for_axis(Id::steps_per_mm_x, axis), steps_per_mm,
                       "benchmark");
  return profile.settings;
}

double angle_of(std::size_t line) { return static_cast<double>(line) * line_mm / radius_mm; }

std::string short_lines(std::size_t count, double feed_mm_s) {
  std::string text = fmt::format("G0 X{}\nF{}\n", radius_mm, feed_mm_s * 60);
  for (std::size_t i = 1; i <= count; ++i)
    text += fmt::format("G1X{:.3f}Y{:.3f}\n", radius_mm * std::cos(angle_of(i)),
                        radius_mm * std::sin(angle_of(i)));
  return text;
}

/// The same lines, computed by the board: three products, two functions and a sum each.
std::string expression_lines(std::size_t count, double feed_mm_s) {
  constexpr double degrees = 180 / std::numbers::pi, um = 1000;
  std::string text = fmt::format("G0 X{}\nF{}\n#1={:.9f} #2={}\n", radius_mm, feed_mm_s * 60,
                                 angle_of(1) * degrees, radius_mm * um);
  for (std::size_t i = 1; i <= count; ++i)
    text += fmt::format("#1=[#1+{:.9f}]G1X[ROUND[#2*COS[#1]]/{}]Y[ROUND[#2*SIN[#1]]/{}]\n",
                        angle_of(1) * degrees, um, um);
  return text;
}

/// Results of a stream.
struct Rate {
  double lines_per_s = 0, taken_per_s = 0;
  double core0 = 0, core1 = 0;  ///< share of time awake
  bool complete = false;        ///< every line was accepted and run
};

double share(const test::SleepWatch& core) {
  const auto awake = static_cast<double>(core.awake());
  return awake / (awake + static_cast<double>(core.asleep()));
}

/// End of a line as programmed.
std::array<std::int32_t, 2> end_of(std::size_t line, double steps_per_mm) {
  const auto steps = [steps_per_mm](double mm) {
    return static_cast<std::int32_t>(std::lround(std::round(mm * 1000) / 1000 * steps_per_mm));
  };
  return {steps(radius_mm * std::cos(angle_of(line))), steps(radius_mm * std::sin(angle_of(line)))};
}

/// The mean length of the lines, in whole steps.
double mean_length_mm(std::size_t lines, double steps_per_mm) {
  double steps = 0;
  for (std::size_t i = 0; i < lines; ++i) {
    const auto from = end_of(i, steps_per_mm), to = end_of(i + 1, steps_per_mm);
    steps += std::hypot(to[0] - from[0], to[1] - from[1]);
  }
  return steps / static_cast<double>(lines) / steps_per_mm;
}

bool at_end_of(std::size_t lines, const sim::ChipBoard& board, double steps_per_mm) {
  const StepPosition place = board.world().drives().position();
  const auto end = end_of(lines, steps_per_mm);
  return place[0] == end[0] && place[1] == end[1];
}

/// The line that the machine is in, as a fraction, from one before it less than a turn ago.
double line_of(const sim::ChipBoard& board, double after) {
  const StepPosition place = board.world().drives().position();
  const double turn = 2 * std::numbers::pi;
  const double angle = std::atan2(place[1], place[0]) - angle_of(1) * after;
  return after + (angle - turn * std::floor(angle / turn)) / angle_of(1);
}

using MakeLines = std::string (*)(std::size_t count, double feed_mm_s);

Rate measure(sim::ChipBoard& board, MakeLines make_lines, double feed_mm_s, double steps_per_mm) {
  constexpr std::size_t lines = warm_up_lines + measured_lines;
  const sim::Picoseconds end =
      board.now() + 60 * sim::ps_per_s;  // about fifty times the needed time
  Rate rate;
  test::ProgramSender sender(board);
  sender.give(make_lines(lines, feed_mm_s));
  while (sender.answers().size() < warm_up_lines)
    if (sender.step(); board.now() >= end) return rate;
  const std::size_t from = sender.answers().size() - 1;
  // The machine runs a line later than the board answers it.
  const sim::Picoseconds begin = board.now();
  const double first = line_of(board, 0);
  {
    const test::SleepWatch core0(board.chip().core(0)), core1(board.chip().core(1));
    while (!sender.all_sent() && board.now() < end) sender.step();
    rate.core0 = share(core0);
    rate.core1 = share(core1);
  }
  const std::size_t to = sender.answers().size() - 1;
  const auto& times = sender.answer_times();
  rate.taken_per_s = static_cast<double>(to - from) / sim::seconds(times[to] - times[from]);
  rate.lines_per_s = (line_of(board, first) - first) / sim::seconds(board.now() - begin);
  rate.complete = sender.run_until_answered(end) && sender.errors() == 0 &&
                  sender.run_until_idle(end) && at_end_of(lines, board, steps_per_mm);
  return rate;
}

void run_lines(benchmark::State& state, MakeLines make_lines) {
  const auto steps_per_mm = static_cast<double>(state.range(0));
  const auto feed_mm_s = static_cast<double>(state.range(1));
  const sim::chip::Image image = sim::chip::load_image(test::flash_image_path());
  Rate rate;
  for (auto _ : state) {
    sim::ChipBoard board(image, machine(steps_per_mm), {});
    if (!board.run_until_found(sim::ps_per_s)) {
      state.SkipWithError("the host has not found the board");
      break;
    }
    rate = measure(board, make_lines, feed_mm_s, steps_per_mm);
    if (!rate.complete) state.SkipWithError("lines were not run to their end");
  }
  state.counters["lines_per_s"] = rate.lines_per_s;
  state.counters["taken_per_s"] = rate.taken_per_s;
  state.counters["of_feed"] =
      rate.lines_per_s * mean_length_mm(warm_up_lines + measured_lines, steps_per_mm) / feed_mm_s;
  state.counters["x_grbl_AVR"] = rate.lines_per_s / grbl_avr;
  state.counters["x_115200_Bd"] = rate.lines_per_s / baud_115200;
  state.counters["core0"] = rate.core0;
  state.counters["core1"] = rate.core1;
}

void chip_lines(benchmark::State& state) { run_lines(state, short_lines); }
BENCHMARK(chip_lines)
    ->ArgNames({"steps_per_mm", "feed_mm_s"})
    ->Args({80, 100})
    ->Args({80, 150})
    ->Args({200, 100})
    ->Args({200, 150})
    ->Args({200, 200})
    ->Args({200, 300})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

/// Lines per second with expressions.
void chip_expression_lines(benchmark::State& state) { run_lines(state, expression_lines); }
BENCHMARK(chip_expression_lines)
    ->ArgNames({"steps_per_mm", "feed_mm_s"})
    ->Args({200, 150})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
