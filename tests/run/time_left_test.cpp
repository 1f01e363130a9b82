// The time left that a job or a program shows, two seconds after changes of its speed and after a
// hold, against the run of the virtual board.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <functional>
#include <random>
#include <thread>

#include "host/job/job.hpp"
#include "host/job/profile.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/program_lines.hpp"
#include "host/link/sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/program/program_run.hpp"
#include "host/raster/row_motion.hpp"
#include "host/raster/rows.hpp"
#include "host/run/program_time.hpp"
#include "host/run/remaining_time.hpp"
#include "host/units.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/lamp_settings.hpp"
#include "tests/scale.hpp"

namespace lamplock::run::time_left {
namespace {

using namespace std::chrono_literals;
using settings::Id;

constexpr double max_part = 0.03;
/// The board reports its progress every 100 ms: that is less than the part.
constexpr double min_left_s = 7;

double seconds(std::chrono::microseconds time) {
  return std::chrono::duration<double>(time).count();
}

/// Asks until the plan of the present speed is made: on a real board it is made meanwhile.
template <class Time, class Ask>
double planned(Time& time, Ask ask) {
  std::optional<double> left = ask();
  while (time.is_planning()) {
    std::this_thread::sleep_for(1ms);
    left = ask();
  }
  return left.value_or(-1);
}

/// A job on the virtual board, and the time that is shown for it.
class RunningJob {
 public:
  RunningJob(const job::Job& job, const settings::Values& machine)
      : job_(job), board_(machine, world_of(machine)), left_(job, 0, 100) {}

  void run_for(std::chrono::microseconds time) {
    const auto until = transport_.now() + time;
    while (transport_.now() < until && sender_.step()) continue;
  }
  void run_to(std::size_t done) {
    while (sender_.points_fired() < done && sender_.step()) continue;
  }
  void set_speed(std::uint32_t percent) { sender_.set_job_speed(percent); }
  void hold_for(std::chrono::microseconds time) {
    sender_.pause();
    run_for(time);
    sender_.resume();
  }
  /// Compares what is shown now with the rest of the run.
  void expect_left() {
    const double left = planned(
        left_, [this] { return left_.left_s(sender_.points_fired(), sender_.job_speed()); });
    const auto now = transport_.now();
    run_to(job_.size());
    const double true_s = seconds(transport_.now() - now);
    EXPECT_GT(true_s, min_left_s) << "the job is too short for this test";
    EXPECT_NEAR(left, true_s, max_part * true_s);
    while (sender_.step()) continue;
  }

 private:
  static sim::WorldConfig world_of(const settings::Values& values) {
    sim::WorldConfig world;
    world.lamp = sim::lamp_of(values);
    return world;
  }
  static link::SenderOptions sending() {
    link::SenderOptions options;
    options.session = link::simulated_session;
    return options;
  }

  const job::Job& job_;
  sim::VirtualBoard board_;
  link::SimulatedTransport transport_{board_};
  link::JobSender sender_{transport_, job_, sending()};
  RemainingTime left_;
};

/// Changes of the speed and a hold, one of them the last, and a look two seconds after it.
void change_and_look(RunningJob& run, std::mt19937_64& random, std::size_t items, bool hold_last) {
  run.run_to(items / 10);
  for (const std::uint32_t base : {60u, 120u}) {
    run.set_speed(base + static_cast<std::uint32_t>(random() % 20));
    run.run_for(1s);
  }
  run.hold_for(3s);
  if (!hold_last) run.set_speed(random() % 2 == 0 ? 70 : 140);
  run.run_for(2s);
  run.expect_left();
}

TEST(TimeLeft, of_points) {
  std::mt19937_64 random(7);
  const auto between = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  // At 20 Hz the board has points for several seconds that are planned at the old speed.
  for (int i = 0; i < test::scaled(9, 3); ++i) {
    job::Profile profile = job::default_profile();
    const double hz = std::array{50, 200, 20}[static_cast<std::size_t>(i % 3)];
    job::set_lamp_hz(profile, hz);
    job::set_acceleration(profile, between(0.5, 3));
    geometry::PointCloud cloud;
    geometry::Point at;
    const double stride = between(0.05, 0.4);
    for (int point = 0; point < static_cast<int>(25 * hz); ++point) {
      at.x += between(-stride, stride);
      at.y += between(-stride, stride);
      if (random() % 100 == 0) at = {between(-10, 10), between(-10, 10), 0};
      cloud.push_back(at);
    }
    const job::Job job = job::make_job(cloud, profile, {});
    RunningJob run(job, job.settings);
    change_and_look(run, random, job.size(), i % 4 == 0);
  }
}

TEST(TimeLeft, of_rows) {
  std::mt19937_64 random(8);
  for (int i = 0; i < test::scaled(4, 2); ++i) {
    job::Profile profile = job::default_profile();
    job::state_setting(profile, Id::laser_mode, settings::row(Id::laser_mode).max_milli / 1000.0,
                       "test");
    raster::Pixels pixels{60 + random() % 60, 120, {}};
    for (std::size_t p = 0; p < pixels.columns * pixels.rows; ++p)
      pixels.power.push_back(raster::power_of_run(static_cast<double>(1 + random() % 4) / 4));
    raster::RowOptions options;
    options.pitch_mm = 0.1;
    options.feed_mm_min = 2000;
    options.one_way = i % 2 == 0;
    options.overscan_mm = raster::run_up_mm(profile.settings, options.feed_mm_min);
    const job::Job job = raster::make_rows(pixels, options, profile);
    RunningJob run(job, profile.settings);
    change_and_look(run, random, job.size(), i % 3 == 0);
  }
}

std::string random_program(std::mt19937_64& random) {
  std::string text = "G21 G90 G94\n";
  for (int i = 0; i < 600; ++i)
    text += fmt::format("{} X{:.2f} Y{:.2f}{}\n", random() % 6 == 0 ? "G0" : "G1",
                        static_cast<double>(random() % 400) / 100,
                        static_cast<double>(random() % 400) / 100,
                        i % 50 == 0 ? fmt::format(" F{}", 1000 + random() % 2000) : "");
  return "G1 F1500\n" + text + "G4 P0.5\nM30\n";
}

TEST(TimeLeft, of_programs) {
  std::mt19937_64 random(9);
  for (int i = 0; i < test::scaled(4, 2); ++i) {
    const settings::Values values = job::default_profile().settings;
    const std::string text = random_program(random);
    sim::VirtualBoard board(values, {});
    link::SimulatedTransport transport(board);
    link::LinePort port(transport);
    link::LineSender sender(port, link::program_lines(text, "test"), {});
    const auto plan = [&](const ProgramTime::Changes& changes) -> std::optional<double> {
      program_run::OnBoard on_board;
      on_board.changes = changes;
      return program_run::run_on_board(text, values, on_board).seconds();
    };
    ProgramTime time(plan({}), plan);
    int feed = 100;
    const auto look = [&] { return time.left_s(seconds(sender.elapsed()), feed, 100); };
    const auto run_for = [&](std::chrono::microseconds span) {
      const auto until = transport.now() + span;
      while (transport.now() < until && sender.step()) look();
    };
    run_for(1s);
    for (const int change : {+20, -60, i % 2 == 0 ? +80 : -30}) {
      for (int step = 0; step < std::abs(change) / 10; ++step)
        sender.realtime(change > 0 ? link::realtime::feed_plus_10 : link::realtime::feed_minus_10);
      feed += change;
      run_for(2s);
    }
    const double left = planned(time, look);
    const auto now = transport.now();
    while (sender.step()) continue;
    const double true_s = seconds(transport.now() - now);
    EXPECT_EQ(sender.result().end, link::LineEnd::done);
    EXPECT_GT(true_s, min_left_s);
    EXPECT_NEAR(left, true_s, max_part * true_s);
  }
}

}  // namespace
}  // namespace lamplock::run::time_left
