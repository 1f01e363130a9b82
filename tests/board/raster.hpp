// Raster engraving: pictures of pixels, programs that engrave them, and checks of their light.
//
// In:  a seed; after the run the light and the steps of a board.
// Out: G-code in rows of both directions with a run-up on both sides; the number of pixels lit as
//      wanted, and the distance of light changes from their place.
// Used by tests of both boards. Depends on pins and settings only.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "host/job/job.hpp"
#include "sim/board.hpp"
#include "sim/world/world.hpp"
#include "tests/judges/pin_monitor.hpp"
#include "tests/scale.hpp"

namespace lamplock::test {

/// 300 mm/s at 2 m/s2, 200 steps/mm: a step is 5 um and takes 16.7 us. No lamp.
inline job::Profile raster_machine(double laser_lead_us = 0) {
  using settings::Id;
  job::Profile profile = job::default_profile();
  job::set_lamp_hz(profile, 100);
  job::set_acceleration(profile, 2);
  job::set_speed(profile, 0.4);
  const auto set = [&profile](Id id, double value) {
    job::state_setting(profile, id, value, "test");
  };
  set(Id::lamp_mode, 0);
  set(Id::laser_mode, 1);
  set(Id::laser_lead, laser_lead_us);
  set(Id::travel_x, 200);
  set(Id::min_corner_x, -100);
  return profile;
}

class Raster {
 public:
  static constexpr int steps_per_pixel = 20;  ///< 0.1 mm
  static constexpr int speed_mm_s = 300;
  /// At least 22.5 mm.
  static constexpr int run_up_pixels = 250;

  /// Runs of one to `max_run` equal pixels, dark ones and lit ones.
  Raster(std::uint64_t seed, int rows, int columns, int max_run) : columns_(columns) {
    std::mt19937_64 random(seed);
    for (int row = 0; row < rows; ++row) {
      std::vector<int> pixels;
      while (static_cast<int>(pixels.size()) < columns) {
        const auto run = 1 + random() % static_cast<std::uint64_t>(max_run);
        const int power = random() % 3 == 0 ? 0 : static_cast<int>(1 + random() % 1000);
        pixels.insert(pixels.end(), run, power);
      }
      pixels.resize(static_cast<std::size_t>(columns));
      rows_.push_back(pixels);
    }
  }

  int pixels() const { return columns_ * static_cast<int>(rows_.size()); }
  int columns() const { return columns_; }
  std::size_t rows() const { return rows_.size(); }
  bool backwards(std::size_t row) const { return row % 2 != 0; }
  /// Powers in thousandths of full power, in the order in which the row is passed.
  std::vector<int> passed(std::size_t row) const {
    std::vector<int> pixels = rows_[row];
    if (backwards(row)) std::reverse(pixels.begin(), pixels.end());
    return pixels;
  }
  /// Begin of the i-th passed pixel, in pixels.
  int edge(std::size_t row, int i) const { return backwards(row) ? columns_ - i : i; }
  static std::uint16_t light_of(int power) {
    return static_cast<std::uint16_t>((power * 65'535 + 500) / 1000);
  }
  /// One line per run, or lists of powers; every other row backwards.
  std::string program(bool lists = false) const {
    std::string text =
        fmt::format("G21 G90 G0 X{} Y0\nM3 S0 F{}\n", mm(-run_up_pixels), 60 * speed_mm_s);
    for (std::size_t row = 0; row < rows_.size(); ++row) text += row_text(row, lists);
    return text + "M5\nM2\n";
  }

  /// Result of a board.
  struct Judgement {
    int lit_as_wanted = 0;      ///< pixels, including dark ones
    double max_shift = 0;       ///< from a pixel's edge to its light change, steps
    double slowest_mm_s = 1e9;  ///< mean of the slowest row
    int changes = 0;
  };
  /// Judges X and Y of the bus monitor. The laser answers `lead` after its command; changes by at
  /// most `rounding` are ignored.
  Judgement judge(const PinMonitor& monitor, const sim::Beam& beam, sim::Picoseconds lead = 0,
                  int rounding = 0) const {
    Judgement result;
    const auto& x = monitor.steps(0);
    const std::vector<sim::BeamChange> light = beam.changes();
    std::size_t from = 0;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      const Way way = way_of(row, x, from);
      if (way.times.size() != static_cast<std::size_t>(columns_) * steps_per_pixel + 1) {
        ADD_FAILURE() << "row " << row << " was not passed";
        return result;
      }
      const double seconds = static_cast<double>(way.times.back() - way.times.front()) * 1e-12;
      result.slowest_mm_s = std::min(result.slowest_mm_s, columns_ * 0.1 / seconds);
      judge_row(row, way, light, lead, rounding, result);
    }
    return result;
  }

 private:
  /// The time of each step of a row, beginning with the first edge of its first pixel.
  struct Way {
    std::vector<sim::Picoseconds> times;
    bool backwards = false;
  };

  static std::string mm(int pixels) { return fmt::format("{:.1f}", 0.1 * pixels); }
  std::string row_text(std::size_t row, bool lists) const {
    return fmt::format("G1 X{} S0\n{}X{} S0\nG0 Y{:.1f}\n", mm(edge(row, 0)),
                       lists ? list_text(row) : run_text(row),
                       mm(edge(row, columns_ + run_up_pixels)), 0.1 * static_cast<double>(row + 1));
  }
  std::string run_text(std::size_t row) const {
    const std::vector<int> pixels = passed(row);
    std::string text;
    for (int i = 0; i < columns_;) {
      const int power = pixels[static_cast<std::size_t>(i)];
      i = end_of_run(pixels, i);
      text += fmt::format("X{} S{}\n", mm(edge(row, i)), power);
    }
    return text;
  }
  std::string list_text(std::size_t row) const {
    constexpr std::size_t most = 240;  // of 256 characters
    const std::vector<int> pixels = passed(row);
    std::string text, list;
    for (int i = 0; i < columns_;) {
      const int begin = i;
      i = end_of_run(pixels, i);
      list +=
          fmt::format("{}{}", list.empty() ? "S" : ":", pixels[static_cast<std::size_t>(begin)]);
      if (i - begin > 1) list += fmt::format("*{}", i - begin);
      if (list.size() < most && i != columns_) continue;
      text += fmt::format("X{} {}\n", mm(edge(row, i)), list);
      list.clear();
    }
    return text;
  }
  int end_of_run(const std::vector<int>& pixels, int i) const {
    const int power = pixels[static_cast<std::size_t>(i)];
    while (i < columns_ && pixels[static_cast<std::size_t>(i)] == power) ++i;
    return i;
  }

  Way way_of(std::size_t row, const std::vector<PinMonitor::Step>& x, std::size_t& from) const {
    Way way;
    way.backwards = backwards(row);
    const int sign = way.backwards ? -1 : 1, first = edge(row, 0) * steps_per_pixel;
    const int steps = columns_ * steps_per_pixel;
    // The row before may have passed here; only steps in this row's direction count.
    for (; from < x.size() && static_cast<int>(way.times.size()) <= steps; ++from) {
      const int here = x[from].position;
      const bool forwards = from == 0 || x[from - 1].position < here;
      if (forwards == way.backwards) {
        way.times.clear();
        continue;
      }
      if (here == first + sign * static_cast<int>(way.times.size()))
        way.times.push_back(x[from].at);
    }
    return way;
  }

  void judge_row(std::size_t row, const Way& way, const std::vector<sim::BeamChange>& light,
                 sim::Picoseconds lead, int min_change, Judgement& result) const {
    const std::vector<int> pixels = passed(row);
    const auto commanded = [lead](sim::Picoseconds at) { return at - lead; };
    const auto after = [&light](sim::Picoseconds at) {
      return std::partition_point(light.begin(), light.end(),
                                  [at](const sim::BeamChange& c) { return c.at <= at; });
    };
    const auto light_at = [&](sim::Picoseconds at) {
      const auto next = after(at);
      return next == light.begin() ? 0 : int{(next - 1)->light()};
    };
    // Compares each change of light with the nearest edge between pixels that differ.
    int before = light_at(commanded(way.times.front()));
    for (auto c = after(commanded(way.times[1]));
         c != light.end() && c->at < commanded(way.times.back()); ++c) {
      const int now = c->light();
      if (std::abs(now - before) <= min_change) continue;
      before = now;
      ++result.changes;
      result.max_shift = std::max(result.max_shift, shift_of(way, pixels, c->at + lead));
    }
    // A duty has 2000 counts, each 33 of 65535; in M4 it follows the speed within 0.04 %.
    constexpr int rounding = 60;
    for (int i = 0; i < columns_; ++i) {
      const int wanted = light_of(pixels[static_cast<std::size_t>(i)]);
      bool good = true;
      for (int s = 2; s + 1 < steps_per_pixel; ++s) {
        const std::size_t step =
            static_cast<std::size_t>(i) * steps_per_pixel + static_cast<std::size_t>(s);
        good = good && (near_stop(way, step) ||
                        std::abs(light_at(commanded(way.times[step])) - wanted) <= rounding);
      }
      if (good) ++result.lit_as_wanted;
    }
  }

  /// The machine is held within one step of this step, slower than 2.5 mm/s and dark.
  static bool near_stop(const Way& way, std::size_t step) {
    for (std::size_t i = std::max<std::size_t>(step, 2) - 1; i <= step + 2; ++i)
      if (i < way.times.size() && way.times[i] - way.times[i - 1] > 2 * sim::ps_per_ms) return true;
    return false;
  }

  /// Shift in steps. A pixel's edge is half a step after its step, in the middle between two steps.
  double shift_of(const Way& way, const std::vector<int>& pixels, sim::Picoseconds at) const {
    const auto next = std::upper_bound(way.times.begin(), way.times.end(), at);
    if (next == way.times.begin() || next == way.times.end()) return 0;
    if (near_stop(way, static_cast<std::size_t>(next - way.times.begin()))) return 0;
    const auto done = static_cast<double>(next - way.times.begin() - 1);
    const double part =
        static_cast<double>(at - *(next - 1)) / static_cast<double>(*next - *(next - 1));
    const double place = done + part - 0.5;
    double least = 1e9;
    for (int i = 0; i <= columns_; ++i) {
      const bool inside = i != 0 && i != columns_;
      if (inside && pixels[static_cast<std::size_t>(i)] == pixels[static_cast<std::size_t>(i) - 1])
        continue;
      least = std::min(least, std::abs(place - i * steps_per_pixel));
    }
    return least;
  }

  int columns_;
  std::vector<std::vector<int>> rows_;
};

/// A larger test scale adds rows, not columns: rows must fit the work space.
inline Raster sized_raster(std::uint64_t seed, int columns, int max_run) {
  return {seed, std::max(2, scaled(2)), std::min(columns, scaled(columns)), max_run};
}

/// Every pixel has its light, which changes at the edges of pixels, at full speed. The laser
/// answers `lead_us` after its command; changes by at most `rounding` are ignored.
inline void expect_engraved(const Raster& raster, const PinMonitor& monitor, sim::Board& board,
                            double lead_us = 0, int rounding = 0) {
  const Raster::Judgement judgement =
      raster.judge(monitor, board.world().beam(),
                   static_cast<sim::Picoseconds>(lead_us * sim::ps_per_us), rounding);
  std::cout << fmt::format(
      "{} changes of light, at most {:.2f} steps from their places; {:.1f} mm/s\n",
      judgement.changes, judgement.max_shift, judgement.slowest_mm_s);
  EXPECT_EQ(judgement.lit_as_wanted, raster.pixels());
  EXPECT_LE(judgement.max_shift, 1);
  EXPECT_GT(judgement.changes, raster.pixels() / 10);
  EXPECT_GT(judgement.slowest_mm_s, 0.98 * Raster::speed_mm_s);
  EXPECT_FALSE(board.bus().level(sim::Pin::laser_gate));
}

}  // namespace lamplock::test
