// Pixels per second of the simulated chip, compared with other firmware: a row of grey pixels, each
// with another power than its neighbours, or in equal runs of one to four as in line art, streamed
// over USB by a sender that always has another line.
// The rate is in the chip's own time at 125 MHz, so it is the same on every machine.
//
// A run is a line of its own, as senders for grbl write them, one value in a list of powers
// (docs/gcode.md), or two bytes in a row job (docs/wire-format.md). Counters:
//   pixels_per_s     over the middle of the row
//   of_feed          fraction of the feed's rate: 1 = the board keeps up
//   core0, core1     fraction of the time that the core is awake
//   x_...            multiples of other firmware's rate, 0.1 mm per pixel
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "host/job/job.hpp"
#include "host/link/simulated_transport.hpp"
#include "sim/chip_board/chip_board.hpp"
#include "tests/board/row_host.hpp"
#include "tests/chip_board/sleep_watch.hpp"
#include "tests/flash_image_path.hpp"
#include "tests/program_sender.hpp"

namespace lamplock {
namespace {

/// Pixels per second of other firmware, its own images in emulation, a line per pixel.
constexpr double grbl_avr = 343, grblhal_rp2040 = 2339;

constexpr double accel_mm_s2 = 10'000;
/// Part of the row in which the rate is measured: after acceleration, before braking.
constexpr double measured_from = 0.3, measured_to = 0.8;
/// Pixels of a row, long enough for that.
int row_pixels(double pixel_mm, double feed_mm_s) {
  constexpr int min_pixels = 2000;
  const double ramp_mm = feed_mm_s * feed_mm_s / (2 * accel_mm_s2);
  return std::max(min_pixels, static_cast<int>(ramp_mm / (1 - measured_to) / pixel_mm));
}
constexpr std::size_t max_list_size = 240;  // of 256 characters
/// For a row job: the planner needs whole lines, and the table has 2048 places.
constexpr std::size_t runs_a_line = 48;

/// 10 m/s2, 1 m/s, no lamp, 200 steps/mm.
settings::Values machine() {
  using settings::Id;
  job::Profile profile = job::default_profile();
  job::set_acceleration(profile, accel_mm_s2 / 1000);
  job::set_speed(profile, 1);
  job::state_setting(profile, Id::lamp_mode, 0, "benchmark");
  job::state_setting(profile, Id::laser_mode, 1, "benchmark");
  job::state_setting(profile, Id::travel_x, 400, "benchmark");
  return profile.settings;
}

/// How a row is sent.
enum class Form { lines, lists, frames };

/// A number of equal pixels, and their power in thousandths.
struct Run {
  int pixels = 0;
  unsigned power = 0;
};

std::vector<Run> random_runs(int row_pixels, unsigned max_run) {
  std::mt19937 random(1);
  std::vector<Run> runs;
  unsigned odd = 0;
  for (int left = row_pixels; left != 0; left -= runs.back().pixels) {
    const int pixels = std::min(left, static_cast<int>(1 + random() % max_run));
    runs.push_back({pixels, static_cast<unsigned>(2 * (random() % 500) + (odd ^= 1))});
  }
  return runs;
}

std::string row(double pixel_mm, double feed_mm_s, bool lists, unsigned max_run) {
  std::string text = fmt::format("M3 S0\nF{}\n", feed_mm_s * 60), list;
  const int pixels = row_pixels(pixel_mm, feed_mm_s);
  int i = 0;
  for (const Run& run : random_runs(pixels, max_run)) {
    list += fmt::format("{}{}", list.empty() ? "S" : ":", run.power);
    if (lists && run.pixels > 1) list += fmt::format("*{}", run.pixels);
    i += run.pixels;
    if (lists && list.size() < max_list_size && i != pixels) continue;
    text += fmt::format("G1X{:.3f}{}\n", pixel_mm * i, list);
    list.clear();
  }
  return text;
}

/// The row as lines of a row job.
std::vector<test::PixelLine> row_lines(double pixel_mm, double feed_mm_s, unsigned max_run) {
  std::vector<test::PixelLine> lines;
  test::PixelLine line;
  const int pixels = row_pixels(pixel_mm, feed_mm_s);
  int i = 0;
  for (const Run& run : random_runs(pixels, max_run)) {
    const auto power = static_cast<std::uint16_t>(run.power * 65'535 / 1000);
    line.runs.push_back(wire::max_run(power, static_cast<std::uint32_t>(run.pixels)));
    i += run.pixels;
    if (line.runs.size() != runs_a_line && i != pixels) continue;
    line.line.steps[0] = static_cast<std::int32_t>(std::lround(pixel_mm * 200 * i));
    line.line.light = true;
    line.line.feed_milli = static_cast<std::uint32_t>(std::lround(feed_mm_s * 60'000));
    lines.push_back(std::exchange(line, {}));
  }
  return lines;
}

/// A sender of text or of frames.
class RowSender {
 public:
  RowSender(sim::ChipBoard& board, double pixel_mm, double feed_mm_s, Form form, unsigned max_run)
      : form_(form),
        text_(board),
        transport_(board),
        frames_(transport_, row_lines(pixel_mm, feed_mm_s, max_run), {}) {
    if (form != Form::frames) text_.give(row(pixel_mm, feed_mm_s, form == Form::lists, max_run));
  }
  void step() {
    if (form_ == Form::frames) return frames_.step(std::chrono::microseconds(100));
    text_.step();
  }
  /// True if everything was accepted and run.
  bool run_until_idle(sim::Board& board, sim::Picoseconds end) {
    if (form_ != Form::frames)
      return text_.run_until_answered(end) && text_.errors() == 0 && text_.run_until_idle(end);
    while (!frames_.done() && board.now() < end) step();
    return frames_.done();
  }

 private:
  Form form_;
  test::ProgramSender text_;
  link::SimulatedTransport transport_;
  test::RowHost frames_;
};

struct Rate {
  double pixels_per_s = 0, core0 = 0, core1 = 0;
  bool complete = false;
};

double share(const test::SleepWatch& core) {
  const auto awake = static_cast<double>(core.awake());
  return awake / (awake + static_cast<double>(core.asleep()));
}

Rate measure(sim::ChipBoard& board, double pixel_mm, double feed_mm_s, Form form,
             unsigned max_run) {
  const sim::Picoseconds end = board.now() + 20 * sim::ps_per_s;
  RowSender sender(board, pixel_mm, feed_mm_s, form, max_run);
  const double row_steps = row_pixels(pixel_mm, feed_mm_s) * pixel_mm * 200;
  const auto x = [&board] { return board.world().drives().position()[0]; };
  const auto run_to = [&](double part) {
    while (x() < part * row_steps && board.now() < end) sender.step();
  };
  Rate rate;
  run_to(measured_from);
  const auto from = x();
  const sim::Picoseconds begin = board.now();
  {
    const test::SleepWatch core0(board.chip().core(0)), core1(board.chip().core(1));
    run_to(measured_to);
    rate.core0 = share(core0);
    rate.core1 = share(core1);
  }
  rate.pixels_per_s = (x() - from) / (200 * pixel_mm) / sim::seconds(board.now() - begin);
  rate.complete = sender.run_until_idle(board, end) && x() == static_cast<std::int32_t>(row_steps);
  return rate;
}

void chip_pixels(benchmark::State& state) {
  const double pixel_mm = static_cast<double>(state.range(0)) / 1000;
  const auto feed_mm_s = static_cast<double>(state.range(1));
  const auto form = static_cast<Form>(state.range(2));
  const auto max_run = static_cast<unsigned>(state.range(3));
  const sim::chip::Image image = sim::chip::load_image(test::flash_image_path());
  Rate rate;
  for (auto _ : state) {
    sim::ChipBoard board(image, machine(), {});
    if (!board.run_until_found(sim::ps_per_s)) {
      state.SkipWithError("the host has not found the board");
      break;
    }
    rate = measure(board, pixel_mm, feed_mm_s, form, max_run);
    if (!rate.complete) state.SkipWithError("the row was not run to its end");
  }
  state.counters["pixels_per_s"] = rate.pixels_per_s;
  state.counters["of_feed"] = rate.pixels_per_s * pixel_mm / feed_mm_s;
  state.counters["x_grbl_AVR"] = rate.pixels_per_s / grbl_avr;
  state.counters["x_grblHAL_RP2040"] = rate.pixels_per_s / grblhal_rp2040;
  state.counters["core0"] = rate.core0;
  state.counters["core1"] = rate.core1;
}
BENCHMARK(chip_pixels)
    ->ArgNames({"pixel_um", "feed_mm_s", "form", "max_run"})
    ->ArgsProduct({{100}, {300, 500}, {0, 1, 2}, {1}})
    ->ArgsProduct({{50}, {200, 300}, {0, 1, 2}, {1}})
    ->ArgsProduct({{100}, {800}, {1, 2}, {1}})
    ->ArgsProduct({{50}, {500, 800}, {1, 2}, {1}})
    ->ArgsProduct({{25}, {300, 500, 750, 760}, {1, 2}, {1}})
    ->ArgsProduct({{100}, {800}, {0, 1, 2}, {4}})
    ->ArgsProduct({{50}, {400, 500}, {0, 1, 2}, {4}})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamplock
