// Programs, rows and jobs on the chip and on the virtual board: the same steps at the same ticks,
// the same light and the same shots, on machines of all kinds.
//
// Both boards plan a line with the later lines that are known at that time. A planner that is not
// starved knows more lines than it needs, so its plans do not depend on their arrival. At the begin
// of a program only the first line is known, so each program here begins with a long move, as
// programs do.
//
// To compare a file with programs:
//   LAMPLOCK_PROGRAM=part.ngc LAMPLOCK_PROGRAM_SECONDS=20
//   test_chip_board --gtest_filter='*ProgramTicks*Cartesian' in its environment,
// which takes several times as long as the program on the chip.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <variant>

#include "host/file.hpp"
#include "tests/board/pixel_rows.hpp"
#include "tests/chip_board/beam_job.hpp"
#include "tests/chip_board/cut_part.hpp"
#include "tests/chip_board/program_trace.hpp"
#include "tests/chip_board/pulse_kinds.hpp"

namespace lamplock::test::ticks_test {
namespace {

/// What both boards do, on which machine.
struct Work {
  job::Profile machine;
  std::variant<std::string, Raster, job::Job> what;  ///< a program; rows; a job of points
  std::optional<sim::WorldConfig> world{};           ///< by default that of the machine
  double seconds = 100;                              ///< of a program to compare
  std::size_t rests = 0;                             ///< in the program
  std::size_t min_reversals = 0;                     ///< of X
  /// Shots between which the beats must be the same; by default the first and the last.
  std::vector<std::pair<std::size_t, std::size_t>> same_beats{};
  std::function<void(ChipRig&)> also{};
};

struct BoardRun {
  ProgramTrace trace;
  std::vector<std::string> said;  ///< without status reports
  bool ended = false;
};

/// Runs a program to its end, or for the given time from the first step and a little longer.
BoardRun run_program(sim::Board& board, const StepLog& log, const std::string& text,
                     double seconds) {
  constexpr Picoseconds start = 10 * ps_per_s, more = ps_per_s / 2;
  ProgramSender sender(board);
  sender.listen();  // drops the banner
  const std::size_t banner = sender.said().size();
  sender.give(text);
  const Picoseconds begin = board.now();
  while (log.total() == 0 && !sender.answered() && board.now() < begin + start) sender.step();
  const Picoseconds end = board.now() + static_cast<Picoseconds>(seconds * 1e12) + more;
  BoardRun run;
  run.ended = sender.run_until_answered(end) && sender.run_until_idle(end);
  for (const std::string& line : sender.said_from(banner))
    if (!line.starts_with("<")) run.said.push_back(line);
  return run;
}

BoardRun run(sim::Board& board, const StepLog& log, const Work& work) {
  BoardRun run;
  link::SimulatedTransport transport(board);
  if (const auto* text = std::get_if<std::string>(&work.what)) {
    run = run_program(board, log, *text, work.seconds);
  } else if (const auto* raster = std::get_if<Raster>(&work.what)) {
    RowHost host(transport, PixelLines(*raster).lines(), {});
    run.ended = host.run(10 + static_cast<int>(raster->rows()));
    EXPECT_EQ(host.status().starvations, 0u);
    EXPECT_EQ(host.status().first_unfired, host.status().received);
  } else {
    const auto& job = std::get<job::Job>(work.what);
    const link::JobResult result = link::JobSender(transport, job, RunningJob::options(1, 0)).run();
    run.ended = result.end == JobEnd::done;
    EXPECT_EQ(result.status.repeats, board.world().laser().shots().size() - job.targets.size());
  }
  board.run_until(board.now() + 5 * ps_per_ms);  // until the ticks handed out are over
  run.trace = {log.steps(), board.world().beam().changes(), board.now()};
  return run;
}

/// Compares the answers and messages that both have given.
void expect_same_text(const BoardRun& ours, const BoardRun& theirs) {
  for (std::size_t i = 0; i < std::min(ours.said.size(), theirs.said.size()); ++i)
    ASSERT_EQ(ours.said[i], theirs.said[i]) << "line " << i + 1;
  if (std::getenv("LAMPLOCK_PROGRAM") != nullptr) return;
  EXPECT_THAT(ours.said, Each(AnyOf("ok", StartsWith("[MSG:"))));
  EXPECT_EQ(ours.said.size(), theirs.said.size());
}

void print(const TraceComparison& steps, const LightComparison& light) {
  std::cout << fmt::format("{} steps: at most {:.3f} ns apart; {} edges of the gate: {:.3f} ns\n",
                           steps.steps(), static_cast<double>(steps.max_step_error()) / 1e3,
                           steps.gate_edges(), static_cast<double>(steps.max_gate_error()) / 1e3);
  for (const Stretch& stretch : steps.stretches())
    std::cout << fmt::format(
        "from {:.6f} to {:.6f} s: the chip {:.3f} us later\n",
        sim::seconds(stretch.first - steps.stretches().front().first),
        sim::seconds(stretch.last - steps.stretches().front().first),
        static_cast<double>(stretch.offset - steps.stretches().front().offset) / 1e6);
  std::cout << fmt::format("power at {} times: off by {} of 65535; energy {:.6f} and {:.6f} s\n",
                           light.samples(), light.max_error(), light.energy(),
                           light.other_energy());
}

/// The plan is not tied to a lamp: both boards begin when they are ready.
void expect_same_trace(const Work& work, BoardRun& ours, const BoardRun& theirs) {
  ASSERT_EQ(ours.ended, theirs.ended);
  ASSERT_GT(ours.trace.total(), 100u);
  if (!ours.ended)
    ours.trace.cut(ours.trace.first_step() + static_cast<Picoseconds>(work.seconds * 1e12));
  const TraceComparison steps(ours.trace, theirs.trace, ours.ended);
  // A cell of LASER PWM has the power of its middle; a duty has 2000 counts.
  const LightComparison light(ours.trace, theirs.trace, steps, 9 * ps_per_us);
  print(steps, light);
  EXPECT_EQ(steps.difference(), "");
  EXPECT_EQ(steps.steps(), ours.trace.total());
  EXPECT_EQ(steps.max_step_error(), 0);
  EXPECT_EQ(steps.max_gate_error(), 0);
  EXPECT_LE(steps.stretches().size() - 1, work.rests);
  EXPECT_LE(light.max_error(), 66);
  EXPECT_NEAR(light.energy(), light.other_energy(), 0.005 * light.energy());
}

/// Every shot: its place, its channel, its energy, its beat.
void expect_same_shots(const Work& work, const sim::Shots& ours, const sim::Shots& chips) {
  /// LASER PWM has 2000 counts per period; rounding to the nearest, in units of 1/65535 for
  /// settings in units of 1/65536.
  constexpr double energy_rounding = 65536.0 / 2000 / 2 + 1 + 1;
  ASSERT_EQ(chips.size(), ours.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_NEAR(chips[i].steps[axis], ours[i].steps[axis], 1) << "shot " << i << " axis " << axis;
    EXPECT_EQ(chips[i].channel, ours[i].channel) << "shot " << i;
    EXPECT_NEAR(chips[i].energy, ours[i].energy, energy_rounding) << "shot " << i;
  }
  for (const auto& [from, to] : work.same_beats) {
    ASSERT_LT(to, ours.size());
    for (std::size_t i = from; i <= to; ++i)
      ASSERT_EQ(chips[i].beat - chips[from].beat, ours[i].beat - ours[from].beat) << "shot " << i;
  }
}

/// One work for each name.
struct Case {
  const char* name;
  std::function<Work()> work;
  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};
class Ticks : public testing::TestWithParam<Case> {
 protected:
  void run_on_both() {
    work_ = GetParam().work();
    const sim::WorldConfig world = work_.world.value_or(world_for(work_.machine));
    board_.emplace(work_.machine.settings, world);
    const PinMonitor monitor(board_->bus(), board_->world().lamp());
    const StepLog our_log(work_.machine.settings, board_->bus());
    board_->run_until(ps_per_ms);
    ours_ = run(*board_, our_log, work_);
    chip_.emplace(work_.machine.settings, world, ChipRig::Power::off);
    const StepLog log(work_.machine.settings, chip_->board.bus());
    chip_->boot();
    EXPECT_EQ(log.total(), 0u) << "the start must not make a step";
    theirs_ = run(chip_->board, log, work_);
    if (!monitor.fires().empty()) {
      our_steps_ = steps_of(monitor, 0);
      chips_steps_ = steps_of(chip_->monitor, step_latency);
    }
    EXPECT_GE(our_log.reversals(0).size(), work_.min_reversals);
    EXPECT_EQ(chip_->board.world().drives().position(), board_->world().drives().position());
    EXPECT_EQ(board_->world().drives().total_faults(), 0u);
    expect_same_text(ours_, theirs_);
    if (work_.also) work_.also(*chip_);
  }
  const sim::Shots& shots() const { return board_->world().laser().shots(); }

  Work work_;
  std::optional<sim::VirtualBoard> board_;
  std::optional<ChipRig> chip_;
  BoardRun ours_, theirs_;
  std::vector<Step> our_steps_, chips_steps_;  ///< of a plan that is tied to a lamp
};

std::string name_of(const testing::TestParamInfo<Case>& info) { return info.param.name; }

// --- programs and rows, without a lamp ---------------------------------------------------------

/// A common laser cutter with a large work space.
job::Profile laser_cutter(Id motors, int value) {
  job::Profile profile = chip_profile();
  job::set_acceleration(profile, 2);
  job::set_speed(profile, 0.2);
  const auto set = [&profile](Id id, double number) {
    job::state_setting(profile, id, number, "test");
  };
  set(Id::lamp_mode, 0);
  set(Id::laser_mode, 1);
  for (int axis = 0; axis < 3; ++axis) {
    set(settings::for_axis(Id::steps_per_mm_x, axis), axis == 2 ? 400 : 80);
    set(settings::for_axis(Id::travel_x, axis), 1000);
    set(settings::for_axis(Id::min_corner_x, axis), -500);
  }
  set(Id::pin_map, 1);  // A's motor is the second motor of an axis
  set(motors, value);
  return profile;
}

/// Short lines on a wave, each with a power of its own.
std::string wave(int lines, double x, double y) {
  std::string text;
  for (int i = 1; i <= lines; ++i)
    text += fmt::format("X{:.3f}Y{:.3f}S{}\n", x + 0.15 * i, y + 2 * std::sin(0.15 * i),
                        200 + 731 * i % 800);
  return text;
}

/// Pixels with individual powers, in one line.
std::string row(int pixels, double x, double pixel_mm) {
  std::string text = fmt::format("G1 X{:.3f} S", x + pixels * pixel_mm);
  for (int i = 0; i < pixels; ++i)
    text += fmt::format("{}{}", i == 0 ? "" : ":", i % 5 == 0 ? 0 : 100 + 377 * i % 900);
  return text + "\n";
}

/// Some seconds with all kinds of motion and light.
std::string mixed_program() {
  const int pixels = std::min(scaled(60), 60);  // more do not fit into a line
  return "G21 G90 G17 G94\nM127 P3.3\nM128 P71\nG0 X30 Y10\n"
         "M3 S400\nG1 X38 F9000\nG2 X46 Y18 I0 J8\nG3 X38 Y26 R8\nG1 X34 S900\n"
         "G0 X20 Y26\nM4 S1000\nG1 X20 Y20 F6000\nG5 I0 J-4 P0 Q4 X26 Y12\n"
         "G2 X26 Y12 I2 J0 Z-1\nG1 F5000\n" +
         wave(scaled(80), 26, 12) +
         "G4 P0.02\nG91 G1 X-3 Y1 Z1 F4000\nG18 G3 X-8 Z0 R6\nM5\nG90 G17 G0 X0 Y0\n"
         "M3 S700\nG1 X2 F8000\n" +
         row(pixels, 2, 0.13) + "M4\n" + row(pixels, 2 + pixels * 0.13, -0.1) +
         "M126 P1\nG1 X20 S350\nG2 X28 Y8 I0 J8\nG1 X15 Y3 F12000\nM126 P0\nX0\nM2\n";
}

/// The program that the environment names, or the built-in one.
Work mixed(Id motors, int value) {
  Work work{laser_cutter(motors, value), mixed_program()};
  work.rests = 1;  // a dwell
  if (const char* file = std::getenv("LAMPLOCK_PROGRAM")) {
    work.what = read_file(file) + "\n";
    work.rests = std::string::npos;
  }
  if (const char* seconds = std::getenv("LAMPLOCK_PROGRAM_SECONDS"))
    work.seconds = std::atof(seconds);
  work.also = [ganged = motors == Id::ganged_axis](ChipRig& rig) {
    EXPECT_EQ(rig.monitor.steps(3).size(), ganged ? rig.monitor.steps(1).size() : 0);
  };
  return work;
}

/// Moves back and forth, with drives of some kind.
Work zigzag(const Pulses& pulses) {
  Work work{pulse_machine(pulses), {}};
  work.machine.settings.set_milli(Id::lamp_mode, 0);
  std::mt19937_64 random(1);
  const Pick<double> pick(random);
  std::string text = "G21 G91 G1 F6000\nX6 Y-4 Z1\n";
  for (int i = 0, way = -1; i < scaled(60); ++i, way = -way)
    text += fmt::format("X{:.3f} Y{:.3f} Z{:.3f}\n", way * pick(0, 0.3), -way * pick(-0.05, 0.3),
                        pick(-0.05, 0.05));
  work.what = text;
  work.min_reversals = 11;
  return work;
}

/// 0.1 mm pixels in both directions at 300 mm/s; light changes at their edges too.
Work engraving(const Raster& raster, double lead_us, bool lists) {
  Work work{raster_machine(lead_us), raster.program(lists)};
  work.also = [raster, lead_us](ChipRig& rig) {
    expect_engraved(raster, rig.monitor, rig.board, lead_us);
  };
  return work;
}

class ProgramTicks : public Ticks {};
TEST_P(ProgramTicks, AndLightAreThoseOfTheVirtualBoard) {
  ASSERT_NO_FATAL_FAILURE(run_on_both());
  expect_same_trace(work_, ours_, theirs_);
  EXPECT_TRUE(shots().empty());
  EXPECT_TRUE(chip_->shots().empty());
}

INSTANTIATE_TEST_SUITE_P(Motors, ProgramTicks,
                         testing::Values(Case{"Cartesian", [] { return mixed(Id::kinematics, 0); }},
                                         Case{"CoreXy", [] { return mixed(Id::kinematics, 1); }},
                                         Case{"Ganged", [] { return mixed(Id::ganged_axis, 2); }}),
                         name_of);

INSTANTIATE_TEST_SUITE_P(
    Cuts, ProgramTicks, testing::ValuesIn([] {
      std::vector<Case> cases;
      for (const bool by_controller : {false, true})
        cases.push_back(
            {by_controller ? "PartByController" : "Part", [by_controller] {
               return Work{laser_cutter(Id::kinematics, 0), cut_part_program(by_controller)};
             }});
      return cases;
    }()),
    name_of);

INSTANTIATE_TEST_SUITE_P(Drives, ProgramTicks, testing::ValuesIn([] {
                           std::vector<Case> cases;
                           for (const Pulses& pulses : pulse_kinds)
                             cases.push_back({pulses.name, [pulses] { return zigzag(pulses); }});
                           return cases;
                         }()),
                         name_of);

INSTANTIATE_TEST_SUITE_P(
    Rasters, ProgramTicks,
    testing::Values(Case{"Lines", [] { return engraving(sized_raster(1, 200, 4), 0, false); }},
                    Case{"ListsWithALead",
                         [] { return engraving(sized_raster(2, 200, 4), 180, true); }},
                    Case{"GreyPixels", [] { return engraving(sized_raster(3, 400, 1), 0, true); }},
                    Case{"Rows",
                         [] {
                           const Raster raster = sized_raster(11, 300, 1);
                           Work work{raster_machine(), raster};
                           work.also = [raster](ChipRig& rig) {
                             expect_engraved(raster, rig.monitor, rig.board, 0, flicker);
                           };
                           return work;
                         }}),
    name_of);

// --- jobs and programs with points on the beat -------------------------------------------------

/// A job of points that fires each once.
Work points(job::Profile machine, geometry::PointCloud cloud, JoinMode mode) {
  Work work{std::move(machine), {}};
  const job::Job job = job_for(cloud, work.machine, mode);
  work.what = job;
  work.same_beats = {{0, job.targets.size() - 1}};
  work.also = [job](ChipRig& rig) { expect_fired(rig, job); };
  return work;
}

Work walk(JoinMode mode, bool lags, double jerk_m_s3) {
  job::Profile machine = chip_profile(250);
  if (lags) set_lag(machine, {150, 5000});
  for (int axis = 0; axis < 3; ++axis)
    job::state_setting(machine, settings::for_axis(Id::jerk_x, axis), jerk_m_s3, "test");
  return points(machine, histogram_walk(static_cast<std::size_t>(scaled(40)), 9), mode);
}

/// Motors may turn at any of their ticks.
Work core_xy(std::int32_t guard_ns) {
  job::Profile machine = chip_profile();
  machine.settings.set_milli(Id::kinematics, 1000);
  machine.settings.set_milli(Id::direction_setup, guard_ns);
  machine.settings.set_milli(Id::direction_hold, guard_ns);
  return points(machine, chip_points(60, 3), JoinMode::free);
}

/// Points in path mode and free, with lines before, between and after them.
Work locked_program() {
  std::string text = "G21 G90\nG0 X1\nM130 P0\nF6000\n";
  for (int i = 1; i <= 60; ++i)
    text += fmt::format("G1 X{:.2f} Y{:.2f}\n", 1 + i * 0.1, i % 7 * 0.05);
  text += "M131\nG1 X5\nM130 P1\n";
  for (int i = 1; i <= 40; ++i)
    text += fmt::format("G{} X{:.2f} Z{:.2f}\n", i % 10 == 0 ? 0 : 1, 5 - i * 0.08, i % 5 * 0.03);
  Work work{chip_profile(), text + "M2\n"};
  work.same_beats = {{0, 59}, {60, 95}};
  work.also = [](ChipRig& rig) { EXPECT_EQ(rig.shots().size(), 96u); };
  return work;
}

Work beams() {
  const BeamJob beam;
  Work work{beam.profile, beam.job, beam.world};
  work.also = [count = beam.job.targets.size()](ChipRig& rig) {
    EXPECT_GT(rig.shots().size(), count) << "no shot was repeated";
    EXPECT_EQ(rig.board.world().laser().stray_pulses(), 0u);
    rig.run(20 * ps_per_ms);
    for (int c = 0; c < sim::beam_channels; ++c)
      EXPECT_FALSE(rig.board.bus().level(sim::shutter_pin(c)));
    EXPECT_FALSE(rig.energy.high_within(EnergyPads::pwm, rig.now() - 5 * ps_per_ms, rig.now()));
  };
  return work;
}

class JobTicks : public Ticks {};
TEST_P(JobTicks, AndShotsAreThoseOfTheVirtualBoard) {
  ASSERT_NO_FATAL_FAILURE(run_on_both());
  ASSERT_TRUE(ours_.ended && theirs_.ended);
  expect_same_shots(work_, shots(), chip_->shots());
  const auto* job = std::get_if<job::Job>(&work_.what);
  if (job == nullptr || work_.same_beats.empty()) return;
  for (std::size_t i = 0; i < shots().size(); ++i)
    ASSERT_EQ(shots()[i].steps, job->targets[i].steps) << "shot " << i;
  ASSERT_GT(our_steps_.size(), 100u);
  ASSERT_EQ(chips_steps_.size(), our_steps_.size());
  for (std::size_t i = 0; i < our_steps_.size(); ++i)
    ASSERT_EQ(chips_steps_[i], our_steps_[i]) << "step " << i;
}

INSTANTIATE_TEST_SUITE_P(
    Jobs, JobTicks,
    testing::Values(Case{"Free", [] { return walk(JoinMode::free, false, 0); }},
                    Case{"StartStop", [] { return walk(JoinMode::start_stop, false, 0); }},
                    Case{"Lags", [] { return walk(JoinMode::free, true, 0); }},
                    Case{"Jerk", [] { return walk(JoinMode::free, false, 500); }},
                    Case{"LagsAndJerk", [] { return walk(JoinMode::free, true, 500); }},
                    Case{"Path", [] { return walk(JoinMode::path, false, 0); }},
                    Case{"PathWithJerk", [] { return walk(JoinMode::path, false, 500); }},
                    Case{"CoreXy", [] { return core_xy(500); }},
                    Case{"CoreXyThatTurnsSlowly", [] { return core_xy(9000); }},
                    Case{"Beams", beams}, Case{"Program", locked_program}),
    name_of);

}  // namespace
}  // namespace lamplock::test::ticks_test
