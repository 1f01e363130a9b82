// Rows from picture to light: made, sent and burnt on the virtual board, and checked at its pins.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/raster/row_motion.hpp"
#include "host/raster/rows.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/lamp_settings.hpp"
#include "tests/job/random_pixels.hpp"
#include "tests/judges/pin_monitor.hpp"
#include "tests/scale.hpp"

namespace lamplock::raster {
namespace {

using settings::Id;

constexpr int steps_per_mm = 200;

/// A laser machine with 200 mm of X travel, 2 m/s2, 400 mm/s.
job::Profile laser(double jerk_m_s3) {
  job::Profile profile;
  const auto set = [&profile](Id id, double value) {
    job::state_setting(profile, id, value, "test");
  };
  job::set_acceleration(profile, 2);
  job::set_speed(profile, 0.4);
  set(Id::jerk_x, jerk_m_s3);
  set(Id::travel_x, 200);
  set(Id::min_corner_x, -100);
  set(Id::laser_mode, 1);
  return profile;
}

/// Light of a pixel, without two steps at each end, where light may belong to its neighbour.
struct Got {
  double light_s = 0;  ///< in seconds at full power
  double time_s = 0;   ///< with light
};

/// A machine and the recorded output of its pins.
class Machine {
 public:
  explicit Machine(const settings::Values& values)
      : board_(values, world_of(values)), monitor_(board_.bus(), board_.world().lamp()) {}

  link::JobResult burn(const job::Job& job, std::size_t first = 0, std::size_t stop_at = ~0u) {
    link::SimulatedTransport transport(board_);
    link::SenderOptions options;
    options.first_index = first;
    link::JobSender sender(transport, job, options);
    while (sender.step())
      if (sender.points_fired() >= stop_at) sender.stop();
    return sender.result();
  }

  static constexpr int margin = 2;
  /// By column and row.
  std::map<std::pair<int, int>, Got> pixels(const RowOptions& options) const {
    const int pixel = static_cast<int>(std::lround(options.pitch_mm * steps_per_mm));
    const auto left = std::lround(options.corner.x * steps_per_mm);
    const double low = options.corner.y * steps_per_mm;
    const std::vector<sim::BeamChange> light = board_.world().beam().changes();
    const auto &x = monitor_.steps(0), &y = monitor_.steps(1);
    std::map<std::pair<int, int>, Got> result;
    std::size_t next_y = 0, change = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      while (next_y < y.size() && y[next_y].at <= x[i].at) ++next_y;
      const int at_y = next_y == 0 ? 0 : y[next_y - 1].position;
      const int row = static_cast<int>(std::floor((at_y - low) / pixel));
      if (at_y != std::lround(low + (row + 0.5) * pixel))
        continue;  // during the move to the next row
      const auto at_x = x[i].position - left;
      const int column = static_cast<int>(std::floor(static_cast<double>(at_x) / pixel));
      const auto inside = at_x - std::int64_t{column} * pixel;
      if (inside < margin || inside >= pixel - margin) continue;
      while (change + 1 < light.size() && light[change + 1].at <= x[i].at) ++change;
      const double lit_s = light_between(light, change, x[i].at, x[i + 1].at);
      // A slanted move to the next row crosses some of its pixels before they are burnt.
      if (lit_s == 0) continue;
      Got& got = result[{column, row}];
      got.time_s += static_cast<double>(x[i + 1].at - x[i].at) * 1e-12;
      got.light_s += lit_s;
    }
    return result;
  }
  double all_light_s() const { return board_.world().beam().energy(0, board_.now()); }

 private:
  static sim::WorldConfig world_of(const settings::Values& values) {
    sim::WorldConfig world;
    world.lamp = sim::lamp_of(values);
    return world;
  }
  /// `change`: the last one not later than `from`.
  static double light_between(const std::vector<sim::BeamChange>& light, std::size_t change,
                              sim::Picoseconds from, sim::Picoseconds to) {
    double sum = 0;
    for (; change < light.size() && light[change].at < to; ++change) {
      const auto begin = std::max(from, light[change].at);
      const auto end = change + 1 < light.size() ? std::min(to, light[change + 1].at) : to;
      if (end > begin)
        sum += static_cast<double>(end - begin) * 1e-12 * light[change].light() / 65'535.0;
    }
    return sum;
  }

  sim::VirtualBoard board_;
  test::PinMonitor monitor_;
};

struct Picture {
  Pixels pixels;
  RowOptions options;

  double feed_mm_s() const { return options.feed_mm_min / 60; }
  /// Light that a pixel requires, margins included.
  double light_s(std::uint16_t power) const {
    return power / 65'535.0 * options.pitch_mm / feed_mm_s();
  }
  double whole_s() const {
    double sum = 0;
    for (const std::uint16_t power : pixels.power) sum += light_s(power);
    return sum;
  }
};

Picture random_picture(std::mt19937_64& random, const job::Profile& profile, double feed_mm_min) {
  Picture picture;
  picture.pixels = test::random_pixels(40 + random() % 400, 1 + random() % 5, random,
                                       random() % 2 == 0 ? 1 : 20);
  picture.options.feed_mm_min = feed_mm_min;
  picture.options.overscan_mm = run_up_mm(profile.settings, feed_mm_min);
  picture.options.corner = {-20, -5, 0};
  picture.options.one_way = random() % 3 == 0;
  return picture;
}

/// Every pixel receives its light once and is crossed at the feed rate.
TEST(Burn, EveryPixelOfARandomPictureAtTheFeed) {
  std::mt19937_64 random(1);
  const double jerks[] = {0, 1000, 600};
  for (int i = 0; i < test::scaled(6); ++i) {
    SCOPED_TRACE(testing::Message() << "picture " << i);
    const job::Profile profile = laser(jerks[i % 3]);
    const Picture picture = random_picture(random, profile, 60 * (50 + 50.0 * (i % 6)));
    const job::Job job = make_rows(picture.pixels, picture.options, profile);
    Machine machine(profile.settings);
    const link::JobResult result = machine.burn(job);
    ASSERT_EQ(result.end, link::JobEnd::done);
    EXPECT_EQ(result.status.starvations, 0u);
    const auto got = machine.pixels(picture.options);
    const double pixel_steps = picture.options.pitch_mm * steps_per_mm;
    const double inner = (pixel_steps - 2 * Machine::margin) / pixel_steps;
    const double step_s = 1 / (steps_per_mm * picture.feed_mm_s());
    for (std::size_t row = 0; row < picture.pixels.rows; ++row)
      for (std::size_t column = 0; column < picture.pixels.columns; ++column) {
        const std::uint16_t power = picture.pixels.at(column, row);
        const auto found = got.find({static_cast<int>(column), static_cast<int>(row)});
        const Got pixel = found == got.end() ? Got{} : found->second;
        const double wanted = picture.light_s(power) * inner;
        ASSERT_NEAR(pixel.light_s, wanted, 0.01 * wanted + step_s / 4) << column << ", " << row;
        const double time_s = picture.options.pitch_mm * inner / picture.feed_mm_s();
        if (power != 0) {
          ASSERT_NEAR(pixel.time_s, time_s, 0.01 * time_s + step_s / 2) << column << ", " << row;
        }
      }
    EXPECT_NEAR(machine.all_light_s(), picture.whole_s(), 0.005 * picture.whole_s());
    const double seconds = std::chrono::duration<double>(result.elapsed).count();
    EXPECT_NEAR(seconds_of(job), seconds, 0.01 * seconds + 0.1);
  }
}

/// Stopped and resumed: the line in which the job stopped is burnt again from its beginning, all
/// other lines once.
TEST(Burn, AStoppedJobCanBeResumed) {
  std::mt19937_64 random(2);
  for (int i = 0; i < test::scaled(4); ++i) {
    SCOPED_TRACE(testing::Message() << "picture " << i);
    const job::Profile profile = laser(0);
    Picture picture = random_picture(random, profile, 12'000);
    picture.pixels = test::random_pixels(700, 3, random, 1);
    const job::Job job = make_rows(picture.pixels, picture.options, profile);
    Machine machine(profile.settings);
    // Never in the last of several lines, which may be short.
    const std::size_t stop_at = 1 + random() % std::max<std::size_t>(1, job.size() - 2);
    const link::JobResult stopped = machine.burn(job, 0, stop_at);
    ASSERT_EQ(stopped.end, link::JobEnd::stopped);
    const std::size_t from = stopped.status.first_unfired;
    job::Job rest = job;
    const std::size_t first = job::continue_at(rest.rows, from);
    ASSERT_EQ(machine.burn(rest, first).end, link::JobEnd::done);
    double again_s = 0;
    for (const std::uint16_t run : job.rows.runs_of(job.rows.lines[from]))
      again_s += picture.light_s(wire::run_power(run)) * wire::run_cells(run);
    const double all = machine.all_light_s(), whole = picture.whole_s();
    EXPECT_GT(all, 0.995 * whole);
    EXPECT_LT(all, 1.005 * whole + again_s);
    const auto got = machine.pixels(picture.options);
    int missed = 0;
    for (std::size_t row = 0; row < picture.pixels.rows; ++row)
      for (std::size_t column = 0; column < picture.pixels.columns; ++column) {
        const auto found = got.find({static_cast<int>(column), static_cast<int>(row)});
        const double light = found == got.end() ? 0 : found->second.light_s;
        if (light < 0.7 * picture.light_s(picture.pixels.at(column, row))) ++missed;
      }
    EXPECT_EQ(missed, 0);
  }
}

}  // namespace
}  // namespace lamplock::raster
