// E-stop, door and lost lines in the middle of jobs and programs on the virtual board: the laser is
// off in time, the interlock is off first, and light resumes only when the user resumes the job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <csignal>

#include <random>

#include "host/raster/rows.hpp"
#include "tests/gpio/guarded_machine.hpp"

namespace lamplock {
namespace {

using test::GuardedMachine;
using test::ps_per_ms;
using test::Rig;
using testing::HasSubstr;

/// A round of a job takes 10 ms at most (host/link/sender.cpp), of a program 20 ms
/// (host/link/line_sender.cpp); a byte takes one or two USB frames, and a lamp edge that was armed
/// when it arrived still fires.
constexpr sim::Picoseconds job_deadline = 15 * ps_per_ms;
constexpr sim::Picoseconds program_deadline = 25 * ps_per_ms;

job::Profile fast_lamp() { return test::lamp_profile(500); }

/// Rows of points close together: a shot on almost every beat.
job::Job dense_job(std::size_t points) {
  geometry::PointCloud cloud;
  cloud.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t column = i % 100, row = i / 100;
    cloud.push_back({static_cast<double>(column) * 0.1, static_cast<double>(row) * 0.1, 0});
  }
  return test::job_for(cloud, fast_lamp(), test::JoinMode::free);
}

sim::Picoseconds last_shot(const Rig& rig) {
  return rig.shots().empty() ? 0 : rig.shots().back().at;
}

/// Presses, bounces, disconnections: every event that must end a job.
enum class Stop : std::uint8_t { press, pulse, unplug_estop, unplug_door, unplug_interlock };

void happen(Stop what, test::ModelPins& pins) {
  switch (what) {
    case Stop::press:
      return pins.set("E", true);
    case Stop::pulse:
      pins.set("E", true);
      return pins.set("E", false);
    case Stop::unplug_estop:
      return pins.unplug("E");
    case Stop::unplug_door:
      return pins.unplug("D");
    case Stop::unplug_interlock:
      return pins.unplug("I");
  }
}

TEST(GuardedJob, RunsToItsEndWithTheInterlockOn) {
  GuardedMachine machine(fast_lamp());
  const job::Job job = dense_job(500);
  bool always_on = true;
  const auto result =
      machine.run(job, [&](link::JobSender&) { always_on &= machine.pins->level("I"); });
  EXPECT_EQ(result.end, link::JobEnd::done);
  EXPECT_TRUE(always_on);
  EXPECT_FALSE(machine.pins->level("I"));
  EXPECT_EQ(machine.supervisor.ended_by(), "");
  test::expect_each_once(machine.rig, job, false);
}

/// At a random time, for every event: no shot after the deadline, the interlock off before the
/// board is stopped, and the number of shots equals the reported first unfired point.
TEST(GuardedJob, EstopAndLostLinesAtRandomMomentsEndIt) {
  for (int seed = 0; seed < test::scaled(60); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    GuardedMachine machine(fast_lamp());
    const job::Job job = dense_job(400);
    const auto at = std::uniform_int_distribution<std::int64_t>(50, 900)(random) * ps_per_ms;
    const Stop what = static_cast<Stop>(seed % 5);
    sim::Picoseconds pressed = 0;
    const auto result = machine.run(job, [&](link::JobSender&) {
      if (pressed != 0 || machine.rig.board.now() < at) return;
      pressed = machine.rig.board.now();
      happen(what, *machine.pins);
    });
    ASSERT_NE(pressed, 0) << seed;
    ASSERT_EQ(result.end, link::JobEnd::stopped) << seed;
    EXPECT_LE(last_shot(machine.rig), pressed + job_deadline) << seed;
    EXPECT_NE(machine.supervisor.ended_by(), "") << seed;
    if (what != Stop::unplug_interlock) {
      EXPECT_LE(machine.interlock_fell, pressed + job_deadline) << seed;
      EXPECT_GE(machine.interlock_fell, pressed) << seed;
      EXPECT_FALSE(machine.pins->level("I")) << seed;
    }
    const auto shots = machine.rig.shots().size();
    ASSERT_EQ(shots, result.status.first_unfired) << seed;
    machine.rig.run(test::ps_per_s);
    EXPECT_EQ(machine.rig.shots().size(), shots) << seed;
  }
}

TEST(GuardedJob, ADoorHoldsItUntilItIsClosedAndTheUserResumes) {
  GuardedMachine machine(fast_lamp());
  const job::Job job = dense_job(600);
  enum class Scene { runs, open, tried, closed, resumed } scene = Scene::runs;
  sim::Picoseconds since = 0;
  std::size_t shots = 0;
  const auto enter = [&](Scene next) {
    scene = next;
    since = machine.rig.board.now();
    shots = machine.rig.shots().size();
  };
  const auto for_ms = [&](int ms) { return machine.rig.board.now() - since >= ms * ps_per_ms; };
  const auto result = machine.run(job, [&](link::JobSender&) {
    if (scene == Scene::runs && machine.rig.shots().size() > 100) {
      machine.pins->set("D", true);
      enter(Scene::open);
    } else if (scene == Scene::open && for_ms(500)) {
      EXPECT_LE(last_shot(machine.rig), since + job_deadline);
      machine.keyboard.type("\n");
      enter(Scene::tried);
    } else if (scene == Scene::tried && !machine.keyboard.taken()) {
      since = machine.rig.board.now();
    } else if (scene == Scene::tried && for_ms(500)) {
      EXPECT_EQ(machine.rig.shots().size(), shots)
          << "Enter must not resume the job while the door is open";
      machine.pins->set("D", false);
      enter(Scene::closed);
    } else if (scene == Scene::closed && for_ms(500)) {
      EXPECT_EQ(machine.rig.shots().size(), shots) << "closing the door must not resume the job";
      EXPECT_FALSE(machine.pins->level("I"));
      machine.keyboard.type("\n");
      enter(Scene::resumed);
    } else if (scene == Scene::resumed && machine.rig.shots().size() > shots) {
      EXPECT_TRUE(machine.pins->level("I"));
    }
  });
  EXPECT_EQ(scene, Scene::resumed);
  EXPECT_EQ(result.end, link::JobEnd::done);
  test::expect_each_once(machine.rig, job, false);
}

TEST(GuardedJob, DoesNotBeginAtAnOpenDoorOrAPressedEstop) {
  for (const char* place : {"E", "D"}) {
    GuardedMachine machine(fast_lamp());
    machine.pins->set(place, true);
    try {
      machine.run(dense_job(10), [](link::JobSender&) {});
      FAIL() << place;
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), Exit::job_failed);
      EXPECT_THAT(error.what(), HasSubstr(*place == 'E' ? "e-stop pressed (E)" : "door open (D)"));
    }
    EXPECT_TRUE(machine.rig.shots().empty());
    EXPECT_FALSE(machine.pins->level("I"));
  }
}

/// A cutting laser: continuous light.
job::Profile cutter() {
  job::Profile profile = test::lamp_profile(100, settings::LampMode::free_beat);
  job::state_setting(profile, settings::Id::laser_mode, 1, "test");
  return profile;
}

/// Black rows, 80 mm long at 100 mm/s.
job::Job black_rows() {
  raster::Pixels black{800, 20, {}};
  black.power.assign(black.columns * black.rows, raster::power_of_run(1));
  raster::RowOptions options;
  options.corner = {-40, -40, 0};
  options.feed_mm_min = 6000;
  options.overscan_mm = 5;
  return raster::make_rows(black, options, cutter());
}

/// During a hold the light stays on while the machine brakes, so a door ends a job of rows like an
/// e-stop.
TEST(GuardedJob, RowsAreDarkInTimeForDoorAndEstop) {
  const job::Job rows = black_rows();
  for (const char* place : {"E", "D"})
    for (int seed = 0; seed < test::scaled(5); ++seed) {
      std::mt19937_64 random(static_cast<std::uint64_t>(seed));
      GuardedMachine machine(cutter());
      const auto at = std::uniform_int_distribution<std::int64_t>(1000, 8000)(random) * ps_per_ms;
      const sim::Beam& beam = machine.rig.board.world().beam();
      sim::Picoseconds opened = 0;
      const auto result = machine.run(rows, [&](link::JobSender& sender) {
        const sim::Picoseconds now = machine.rig.board.now();
        if (opened != 0 && now > opened + test::ps_per_s) {
          ADD_FAILURE() << place << seed << ": the job continues";
          sender.stop();
        }
        if (opened != 0 || now < at || !beam.shone(now - ps_per_ms, now)) return;
        opened = now;
        machine.pins->set(place, true);
      });
      ASSERT_NE(opened, 0) << place << seed;
      EXPECT_EQ(result.end, link::JobEnd::stopped) << place << seed;
      EXPECT_FALSE(beam.shone(opened + job_deadline, machine.rig.board.now())) << place << seed;
      EXPECT_FALSE(machine.pins->level("I")) << place << seed;
    }
}

/// Long cuts at some speed.
const char* const cutting = R"(G21 G90
G0 X-40 Y-40
M4 S1000
G1 X40 F6000
Y40
X-40
Y-40
X40
Y40
M5
)";

TEST(GuardedProgram, EstopAtARandomMomentIsDarkAndAnAlarm) {
  for (int seed = 0; seed < test::scaled(20); ++seed) {
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    GuardedMachine machine(cutter());
    const auto at = std::uniform_int_distribution<std::int64_t>(1500, 4000)(random) * ps_per_ms;
    sim::Picoseconds pressed = 0;
    // A preceding stop by the user, which keeps the light on until rest, must not delay the e-stop.
    bool user_stops = seed % 2 != 0;
    const auto result = machine.run(cutting, [&](link::LineSender&) {
      if (user_stops && machine.rig.board.now() >= at - 20 * ps_per_ms) {
        user_stops = false;
        std::raise(SIGINT);
      }
      if (pressed != 0 || machine.rig.board.now() < at) return;
      pressed = machine.rig.board.now();
      machine.pins->set("E", true);
    });
    ASSERT_NE(pressed, 0) << seed;
    EXPECT_EQ(result.end, link::LineEnd::alarm) << seed;
    EXPECT_EQ(result.alarm, 3) << seed;
    const sim::Beam& beam = machine.rig.board.world().beam();
    EXPECT_TRUE(beam.shone(pressed - 10 * ps_per_ms, pressed)) << seed;
    EXPECT_FALSE(beam.shone(pressed + program_deadline, machine.rig.board.now())) << seed;
    EXPECT_LE(machine.interlock_fell, pressed + program_deadline) << seed;
  }
}

TEST(GuardedProgram, ADoorIsDarkAndTheProgramResumesAfterIt) {
  GuardedMachine machine(cutter());
  enum class Scene { runs, open, tried, closed, resumed } scene = Scene::runs;
  sim::Picoseconds since = 0, opened = 0, resumed = 0;
  const auto enter = [&](Scene next) {
    scene = next;
    since = machine.rig.board.now();
  };
  const auto for_ms = [&](int ms) { return machine.rig.board.now() - since >= ms * ps_per_ms; };
  const auto result = machine.run(cutting, [&](link::LineSender& sender) {
    if (scene == Scene::runs && for_ms(2000)) {
      machine.pins->set("D", true);
      enter(Scene::open);
      opened = since;
    } else if (scene == Scene::open && sender.waits() && for_ms(500)) {
      EXPECT_FALSE(machine.pins->level("I"));
      machine.keyboard.type("\n");
      enter(Scene::tried);
    } else if (scene == Scene::tried && !machine.keyboard.taken()) {
      since = machine.rig.board.now();
    } else if (scene == Scene::tried && for_ms(500)) {
      machine.pins->set("D", false);
      enter(Scene::closed);
    } else if (scene == Scene::closed && for_ms(500)) {
      EXPECT_FALSE(machine.pins->level("I"));
      machine.keyboard.type("\n");
      enter(Scene::resumed);
      resumed = since;
    }
  });
  ASSERT_EQ(scene, Scene::resumed);
  EXPECT_EQ(result.end, link::LineEnd::done);
  const sim::Beam& beam = machine.rig.board.world().beam();
  EXPECT_TRUE(beam.shone(opened - 10 * ps_per_ms, opened));
  EXPECT_FALSE(beam.shone(opened + program_deadline, resumed));
  EXPECT_TRUE(beam.shone(resumed, machine.rig.board.now()));
}

}  // namespace
}  // namespace lamplock
