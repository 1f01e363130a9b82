// Row jobs on the virtual board: each cell gets its light once despite cable faults and commands of
// the user; the laser is dark at once where it must be.
#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/board/board_cable.hpp"
#include "tests/board/pixel_rows.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

wire::JobHeader row_header(const job::Profile& machine) {
  wire::JobHeader header;
  header.axes = static_cast<std::uint8_t>(machine.settings.whole(Id::axes));
  return header;
}

/// How a raster is sent.
struct Sending {
  Faults faults = {};
  std::uint64_t seed = 1;
  std::size_t max_runs = wire::max_runs_a_line;
  std::size_t max_bytes = wire::max_payload;
};

/// A machine, a cable and a sender of a raster.
struct RowRig {
  explicit RowRig(const Raster& picture, const Sending& sending = {})
      : raster(picture),
        lines(PixelLines(picture, sending.max_runs).lines()),
        rig(machine),
        cable(rig, sending.faults, sending.seed),
        host(cable, lines, row_header(machine), 77, sending.max_bytes) {}

  /// Every cell got its light, nothing else did, and no shot was fired.
  void expect_burnt() {
    rig.run(5 * ps_per_ms);
    const CellLight light = cell_light(raster, rig.monitor, rig.board.world().beam());
    EXPECT_EQ(light.dark, 0);
    EXPECT_EQ(light.twice, 0);
    EXPECT_EQ(light.right, raster.pixels());
    EXPECT_LT(std::abs(light.elsewhere), 1e-3);
    EXPECT_TRUE(rig.monitor.fires().empty());
    EXPECT_FALSE(rig.board.bus().level(sim::Pin::laser_gate));
  }

  /// The machine has been at the end of this line.
  bool has_reached(std::uint32_t line) const {
    const StepPosition& end = lines[line].line.steps;
    const auto &x = rig.monitor.steps(0), &y = rig.monitor.steps(1);
    for (const PinMonitor::Step& step : x)
      if (step.position == end[0] && rig.monitor.position_at(1, step.at) == end[1]) return true;
    // Lines along Y alone.
    return std::any_of(y.begin(), y.end(),
                       [&end](const PinMonitor::Step& step) { return step.position == end[1]; }) &&
           line != 0 && lines[line].line.steps[0] == lines[line - 1].line.steps[0];
  }

  job::Profile machine = raster_machine();
  Raster raster;
  std::vector<PixelLine> lines;
  Rig rig;
  BoardCable cable;
  RowHost host;
};

/// The laser's power after each change.
std::vector<std::uint16_t> powers_of(const sim::Beam& beam) {
  std::vector<std::uint16_t> powers;
  for (const sim::BeamChange& change : beam.changes())
    if (powers.empty() || std::abs(powers.back() - change.light()) > flicker)
      powers.push_back(change.light());
  return powers;
}

/// The same picture as lists of powers in G-code.
TEST(Rows, ShineAsListsOfPowersDo) {
  for (int i = 0; i < scaled(4); ++i) {
    const Raster raster(static_cast<std::uint64_t>(i + 1), 3, 150 + 50 * (i % 8),
                        i % 2 == 0 ? 1 : 6);
    std::string text = raster.program(true);
    text.replace(text.find("M3"), 2, "M4");
    Rig by_text(raster_machine());
    ProgramHost host(by_text);
    ASSERT_TRUE(host.stream(text));
    RowRig rows(raster);
    ASSERT_TRUE(rows.host.run(30));
    rows.expect_burnt();
    const sim::Beam& beam = rows.rig.board.world().beam();
    expect_engraved(raster, rows.rig.monitor, rows.rig.board, 0, flicker);
    const auto text_powers = powers_of(by_text.board.world().beam()), powers = powers_of(beam);
    ASSERT_EQ(powers.size(), text_powers.size());
    constexpr int tolerance = 200;  // the speed of a line is right to 0.3 %
    for (std::size_t k = 0; k < powers.size(); ++k)
      ASSERT_NEAR(powers[k], text_powers[k], tolerance) << "change " << k;
  }
}

/// 3000 runs per second, in lines of any length that the board accepts.
TEST(Rows, OfGreyPixelsKeepTheirSpeed) {
  for (int i = 0; i < scaled(3); ++i) {
    const std::size_t max_runs[] = {wire::max_runs_a_line, 300, 100};
    RowRig rows(Raster(static_cast<std::uint64_t>(i + 10), 3, 700, 1),
                {.max_runs = max_runs[i % 3]});
    ASSERT_TRUE(rows.host.run(30));
    rows.expect_burnt();
    expect_engraved(rows.raster, rows.rig.monitor, rows.rig.board, 0, flicker);
    EXPECT_EQ(rows.host.status().starvations, 0u);
  }
}

/// Where the table of powers is the bottleneck, lines arrive one at a time, as fast as they are
/// burnt. A machine that planned each line on arrival would rest after each.
TEST(Rows, InShortLinesDoNotRestBetweenThem) {
  job::Profile machine = raster_machine();
  job::set_acceleration(machine, 10);
  constexpr int lines_in_all = 40, cells = 48, steps_per_cell = 5;  // 1.2 mm
  std::vector<PixelLine> lines;
  for (int i = 1; i <= lines_in_all; ++i) {
    PixelLine line{{{i * cells * steps_per_cell, 0, 0, 0}, true, raster_feed_milli}, {}};
    for (int k = 0; k < cells; ++k) line.runs.push_back(wire::max_run(20'000, 1));
    lines.push_back(line);
  }
  for (const std::size_t max_bytes : {120u, 200u, 499u}) {
    Rig rig(machine);
    BoardCable cable(rig);
    RowHost host(cable, lines, row_header(machine), 77, max_bytes);
    ASSERT_TRUE(host.run(5));
    const auto& x = rig.monitor.steps(0);
    ASSERT_EQ(x.size(), static_cast<std::size_t>(lines_in_all * cells * steps_per_cell));
    // Without the first four and the last four lines.
    const std::size_t from = 4 * cells * steps_per_cell, to = x.size() - from;
    const double mm = 0.005 * static_cast<double>(to - from);
    EXPECT_GT(mm / sim::seconds(x[to].at - x[from].at), 0.9 * Raster::speed_mm_s) << max_bytes;
  }
}

/// Short runs in succession slow their lines to the rate of the processor, and the light with them;
/// longer ones do not.
TEST(Rows, OfDenseRunsAreSlowedToTheRateOfTheBoard) {
  job::Profile machine = raster_machine();
  job::set_acceleration(machine, 10);
  constexpr int lines_a_part = 30, runs_a_line = 60, cell_steps = 2;  // 10 um
  constexpr std::uint16_t power = 20'000;
  std::vector<PixelLine> lines;
  std::int32_t x_steps = 0;
  for (const int cells_a_run : {1, 4}) {
    for (int i = 0; i < lines_a_part; ++i) {
      x_steps += runs_a_line * cells_a_run * cell_steps;
      PixelLine line{{{x_steps, 0, 0, 0}, true, raster_feed_milli}, {}};
      line.runs.assign(runs_a_line, wire::max_run(power, static_cast<std::uint32_t>(cells_a_run)));
      lines.push_back(line);
    }
  }
  Rig rig(machine);
  BoardCable cable(rig);
  RowHost host(cable, lines, row_header(machine));
  ASSERT_TRUE(host.run(5));
  const auto& x = rig.monitor.steps(0);
  ASSERT_EQ(x.size(), static_cast<std::size_t>(x_steps));
  const auto expect_speed = [&](std::size_t from, std::size_t to, double mm_s) {
    const double mm = 0.005 * static_cast<double>(to - from);
    EXPECT_NEAR(mm / sim::seconds(x[to].at - x[from].at), mm_s, 0.01 * mm_s);
    const double light = rig.board.world().beam().at((x[from].at + x[to].at) / 2).light();
    EXPECT_NEAR(light, power * mm_s / Raster::speed_mm_s, 0.01 * power);
  };
  constexpr std::size_t dense_steps = lines_a_part * runs_a_line * cell_steps;
  const double dense_mm_s = 0.01 / (wire::min_run_us * 1e-6);
  ASSERT_LT(dense_mm_s, 0.8 * Raster::speed_mm_s);
  expect_speed(dense_steps / 3, 2 * dense_steps / 3, dense_mm_s);
  expect_speed(2 * dense_steps, x.size() - 2 * dense_steps, Raster::speed_mm_s);
}

/// Lost, flipped and doubled bytes, invented holds and resets, cut cables.
TEST(Rows, AreBurntOnceWhateverTheCableDoes) {
  const Faults all{.drop = 5e-4,
                   .flip = 5e-4,
                   .duplicate = 5e-4,
                   .replay = 0.05,
                   .stray_realtime = 1e-3,
                   .resets = false,  // which end the job
                   .cuts = 8,
                   .cut_span = std::chrono::milliseconds(2000)};
  const Faults kinds[] = {all, {.drop = 2e-3}, {.cuts = 10, .cut_span = all.cut_span}};
  for (int i = 0; i < scaled(6); ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    RowRig rows(Raster(seed + 30, 5, 300, i % 2 == 0 ? 1 : 5),
                {.faults = kinds[i % 3],
                 .seed = seed,
                 .max_runs = i % 2 == 0 ? wire::max_runs_a_line : 60,
                 .max_bytes = i % 4 < 2 ? wire::max_payload : 60});
    SCOPED_TRACE(testing::Message() << "seed " << i);
    ASSERT_TRUE(rows.host.run(100));
    rows.expect_burnt();
    EXPECT_GT(rows.cable.faults_made(), 5);
  }
}

/// Held at random moments by the host or by a real-time byte, and resumed at another speed.
TEST(Rows, ResumeInTheCellWhereTheyWereHeld) {
  for (int i = 0; i < scaled(6); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    RowRig rows(Raster(static_cast<std::uint64_t>(i + 50), 4, 300, i % 2 == 0 ? 1 : 5));
    int holds = 0;
    const auto wait = [&](std::uint64_t max_ms) {
      for (auto ms = 2 * (random() % max_ms); ms != 0 && !rows.host.done(); --ms) rows.host.step();
    };
    while (!rows.host.done() && rows.rig.now() < 60 * ps_per_s) {
      wait(100);
      if (random() % 2 == 0) {
        rows.host.command(wire::Command::hold);
        wait(200);
        if (rows.host.status().state == MachineState::hold) ++holds;
        rows.host.command(wire::Command::resume);
        while (!rows.host.command_taken()) rows.host.step();
      } else {
        rows.cable.type(random() % 2 == 0 ? "!" : "\x84");
      }
      // A faster job would need more than full power.
      const auto percent = static_cast<std::uint32_t>(20 + random() % 81);
      rows.host.command(wire::Command::job_speed, percent);
    }
    ASSERT_TRUE(rows.host.done()) << i;
    ASSERT_FALSE(rows.host.refused());
    rows.expect_burnt();
    EXPECT_GT(holds, 2);
  }
}

/// The job speed acts as a feed override, after the ticks that are already handed out.
TEST(Rows, RunAtTheSpeedOfTheirJob) {
  RowRig rows(Raster(20, 3, 200, 3));
  rows.host.command(wire::Command::job_speed, 50);
  ASSERT_TRUE(rows.host.run(30));
  rows.expect_burnt();
  const Raster::Judgement judgement =
      rows.raster.judge(rows.rig.monitor, rows.rig.board.world().beam(), 0, flicker);
  EXPECT_NEAR(judgement.slowest_mm_s, Raster::speed_mm_s / 2.0, 1);
  // The override ends with the job.
  ProgramHost by_hand(rows.rig);
  std::string status;
  for (int i = 0; i < 30 && status.find("|Ov:") == std::string::npos; ++i)
    status = by_hand.status();
  EXPECT_NE(status.find("|Ov:100,100,100"), std::string::npos) << status;
}

/// While the host is slow or silent, the machine waits in the dark; then it continues.
TEST(Rows, WaitForLateLines) {
  for (int i = 0; i < scaled(4); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    RowRig rows(Raster(static_cast<std::uint64_t>(i + 60), 12, 300, 1),
                {.max_runs = 20, .max_bytes = 60});
    int rests = 0;
    for (int k = 0; !rows.host.done() && k < 100; ++k) {
      const bool starve = k % 2 != 0;
      rows.host.starve(starve);
      // The lines on the board last four seconds.
      for (auto n = (starve ? 7000 : 200) + random() % 2000; n != 0; --n) rows.host.step();
      const bool starved = rows.rig.board.controller().program().idle();
      if (!starved || rows.rig.status().received == rows.lines.size()) continue;
      ++rests;
      EXPECT_FALSE(rows.rig.board.bus().level(sim::Pin::laser_gate));
      EXPECT_EQ(rows.rig.state(), MachineState::run);
    }
    ASSERT_TRUE(rows.host.done());
    rows.expect_burnt();
    EXPECT_GT(rests, 0);
  }
}

/// When the host falls silent, the dead man's timeout holds the machine: at rest and dark.
TEST(Rows, AreHeldByTheDeadManTimeout) {
  RowRig rows(Raster(3, 40, 300, 5));
  job::state_setting(rows.machine, Id::dead_man, 300, "test");
  Rig rig(rows.machine);
  BoardCable cable(rig);
  RowHost host(cable, rows.lines, row_header(rows.machine));
  for (int k = 0; k < 2000; ++k) host.step();
  ASSERT_EQ(rig.state(), MachineState::run);
  rig.run(700 * ps_per_ms);
  EXPECT_EQ(rig.status().state, MachineState::hold);
  EXPECT_EQ(rig.status().hold_reason, HoldReason::dead_man);
  const Picoseconds dark = rig.now();
  rig.run(ps_per_s);
  EXPECT_FALSE(rig.board.world().beam().shone(dark, rig.now()));
  EXPECT_FALSE(rig.monitor.stepped(dark, rig.now()));
}

struct Ending {
  const char* name;
  std::function<void(RowRig&)> act;
  Picoseconds dark_after;
  MachineState state;
};

/// After a stop at a random moment the laser stays dark, and lines reported as run have been run.
TEST(Rows, AreDarkAtOnceWhenTheyAreEnded) {
  const Ending endings[] = {
      {"stop", [](RowRig& rows) { rows.host.command(wire::Command::stop); }, 3 * ps_per_ms,
       MachineState::idle},
      {"e-stop",
       [](RowRig& rows) {
         rows.rig.board.world().schedule(sim::Pin::estop, true, rows.rig.now() + ps_per_us);
       },
       20 * ps_per_us, MachineState::estop},
      {"door",
       [](RowRig& rows) {
         rows.rig.board.world().schedule(sim::Pin::door, true, rows.rig.now() + ps_per_us);
       },
       3 * ps_per_ms, MachineState::door}};
  for (int i = 0; i < scaled(18); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const Ending& ending = endings[i % 3];
    SCOPED_TRACE(testing::Message() << ending.name << ' ' << i);
    RowRig rows(Raster(static_cast<std::uint64_t>(i + 80), 12, 200, 5), {.max_runs = 30});
    rows.host.do_not_resume();
    for (auto k = 400 + random() % 2400; k != 0; --k) rows.host.step();
    ASSERT_EQ(rows.rig.state(), MachineState::run);
    // The first line not run has just been reported; the report must not be too early.
    const std::uint32_t line = rows.rig.status().first_unfired;
    if (i % 2 == 0) {
      while (rows.rig.status().first_unfired == line)
        rows.host.step(std::chrono::microseconds(250));
    }
    ending.act(rows);
    const Picoseconds at = rows.rig.now();
    for (int k = 0; k < 600; ++k) rows.host.step();
    EXPECT_FALSE(rows.rig.board.world().beam().shone(at + ending.dark_after, rows.rig.now()));
    EXPECT_FALSE(rows.rig.board.bus().level(sim::Pin::laser_gate));
    EXPECT_EQ(rows.rig.state(), ending.state);
    EXPECT_EQ(rows.host.status().state, ending.state);
    EXPECT_FALSE(rows.host.refused());
    const std::uint32_t first = rows.host.status().first_unfired;
    EXPECT_EQ(first, rows.rig.status().first_unfired);
    if (first > 0) {
      EXPECT_TRUE(rows.has_reached(first - 1)) << first;
    }
  }
}

/// A second stop while the machine still brakes for the first one does not affect the next job.
TEST(Rows, AreStoppedTwiceAndTheNextJobShines) {
  const auto light = [](RowRig& rows) {
    return rows.rig.board.world().beam().energy(0, rows.rig.now());
  };
  const Raster raster(70, 4, 200, 5);
  RowRig whole(raster);
  ASSERT_TRUE(whole.host.run(30));
  RowRig rows(raster);
  rows.host.do_not_resume();
  while (rows.rig.status().first_unfired < 2) rows.host.step();
  for (int stops = 0; stops < 2; ++stops) {
    rows.host.command(wire::Command::stop);
    while (!rows.host.command_taken()) rows.host.step(std::chrono::microseconds(250));
  }
  for (int k = 0; k < 1000; ++k) rows.host.step();
  ASSERT_EQ(rows.rig.state(), MachineState::idle);
  const double before = light(rows);
  RowHost again(rows.cable, rows.lines, row_header(rows.machine), 78);
  ASSERT_TRUE(again.run(30));
  EXPECT_NEAR(light(rows) - before, light(whole), 0.01 * light(whole));
}

/// Another job continues at the reported line; the lines before it were burnt once.
TEST(Rows, ContinueAtTheFirstLineNotRun) {
  for (int i = 0; i < scaled(12); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    SCOPED_TRACE(i);
    // A row is one line or two.
    RowRig rows(Raster(static_cast<std::uint64_t>(i + 90), 10, 200, 3),
                {.max_runs = i % 2 == 0 ? wire::max_runs_a_line : 70});
    rows.host.do_not_resume();
    for (auto k = 2000 + random() % 3000; k != 0; --k) rows.host.step();
    if (i % 3 != 0) rows.host.command(wire::Command::hold);
    for (int k = 0; k < 800; ++k) rows.host.step();
    if (i % 3 != 0) {
      ASSERT_EQ(rows.host.status().state, MachineState::hold);
      ASSERT_FALSE(rows.has_reached(rows.host.status().first_unfired))
          << "the line was reported as not run";
    }
    rows.host.command(wire::Command::stop);
    for (int k = 0; k < 800; ++k) rows.host.step();
    const wire::Status reported = rows.host.status();
    ASSERT_EQ(reported.state, MachineState::idle);
    ASSERT_GT(reported.first_unfired, 2u);
    ASSERT_LT(reported.first_unfired, rows.lines.size());
    // A line that was burnt in part is burnt again from its beginning; no other line is.
    wire::JobHeader header = row_header(rows.machine);
    header.first_index = reported.first_unfired;
    header.origin_steps = rows.lines[reported.first_unfired - 1].line.steps;
    RowHost next(rows.cable, rows.lines, header, 78);
    ASSERT_TRUE(next.run(60));
    EXPECT_EQ(next.status().first_unfired, rows.lines.size());
    rows.rig.run(5 * ps_per_ms);
    const CellLight light =
        cell_light(rows.raster, rows.rig.monitor, rows.rig.board.world().beam());
    EXPECT_EQ(light.dark, 0);
    EXPECT_LE(light.twice, rows.raster.columns());
    EXPECT_LT(std::abs(light.elsewhere), 1e-3);
    const std::int32_t row = header.origin_steps[1] / Raster::steps_per_pixel;
    const CellLight rows_after =
        cell_light(rows.raster, rows.rig.monitor, rows.rig.board.world().beam(),
                   static_cast<std::size_t>(row) + 1);
    EXPECT_EQ(rows_after.twice, 0);
  }
}

/// A line is reported as run never before it is, and soon after.
TEST(Rows, ReportTheirProgress) {
  RowRig rows(Raster(7, 6, 200, 3), {.max_runs = 40});
  std::uint32_t reported = 0;
  while (!rows.host.done() && rows.rig.now() < 60 * ps_per_s) {
    rows.host.step();
    const std::uint32_t first = rows.rig.status().first_unfired;
    ASSERT_GE(first, reported);
    ASSERT_LE(first, rows.lines.size());
    if (first > reported && first < rows.lines.size()) {
      // The machine is on this line or has just left the line before.
      const StepPosition& from = rows.lines[first - 1].line.steps;
      const StepPosition& to = rows.lines[first].line.steps;
      const auto at = [&](int axis) {
        const auto& steps = rows.rig.monitor.steps(axis);
        return steps.empty() ? 0 : steps.back().position;
      };
      constexpr int slack = 3 * 60 + 20;  // 3 ms at the highest speed
      for (int axis = 0; axis < 2; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        EXPECT_GE(at(axis), std::min(from[a], to[a]) - slack);
        EXPECT_LE(at(axis), std::max(from[a], to[a]) + slack);
      }
    }
    reported = first;
  }
  EXPECT_EQ(reported, rows.lines.size());
}

/// If the machine is not at the origin of a first line with light, it moves there in the dark.
TEST(Rows, BeginAtTheOriginOfTheirFirstLine) {
  RowRig rows(Raster(8, 2, 100, 3));
  ProgramHost by_hand(rows.rig);
  by_hand.ask("G21 G90 G0 X-30 Y20\n");
  ASSERT_TRUE(by_hand.wait_for_rest());
  wire::JobHeader header = row_header(rows.machine);
  header.origin_steps = rows.lines[0].line.steps;
  header.first_index = 1;
  RowHost host(rows.cable, rows.lines, header);
  ASSERT_TRUE(host.run(30));
  rows.expect_burnt();
  // A program then starts from the machine's position.
  by_hand.ask("G0 X0\n");
  ASSERT_TRUE(by_hand.wait_for_rest());
  EXPECT_EQ(by_hand.position()[0], 0);
  EXPECT_EQ(by_hand.position()[1], rows.lines.back().line.steps[1]);
}

TEST(Rows, OfADryJobMakeTheSameStepsInTheDark) {
  const Raster raster(9, 3, 200, 3);
  RowRig lit(raster), dark(raster);
  ASSERT_TRUE(lit.host.run(30));
  wire::JobHeader header = row_header(dark.machine);
  header.dry = true;
  RowHost host(dark.cable, dark.lines, header);
  ASSERT_TRUE(host.run(30));
  EXPECT_EQ(dark.rig.board.world().beam().openings(), 0u);
  const auto &x = lit.rig.monitor.steps(0), &y = dark.rig.monitor.steps(0);
  ASSERT_EQ(x.size(), y.size());
  for (std::size_t i = 0; i < x.size(); ++i) ASSERT_EQ(x[i].position, y[i].position);
}

/// Sends BEGIN and the first frame; returns the result that refuses one of them, or ok.
Result refusal(const job::Profile& machine, const std::vector<std::uint8_t>& records,
               std::uint32_t* value = nullptr, std::uint32_t total = 100) {
  Rig rig(machine);
  rig.run(ps_per_ms);
  machine::Controller& core = rig.board.controller();
  wire::JobHeader header = row_header(machine);
  header.mode = wire::mode_rows;
  header.points_total = total;
  Result result = core.on_begin(header);
  if (result == Result::ok) result = core.on_data(records);
  if (value != nullptr) *value = core.refused_value();
  if (result != Result::ok) {
    rig.run(100 * ps_per_ms);
    EXPECT_TRUE(rig.monitor.nothing_happened());
    EXPECT_EQ(rig.status().received, 0u);
  }
  return result;
}

TEST(Rows, ThatAreInvalidAreRefusedWhole) {
  job::Profile machine = raster_machine();
  const std::vector<std::uint8_t> good{0xC3, 0, 0, 0, 1, 0xC4, 1, 0xE0, 0xFF, 0x01, 100};
  const auto and_then = [&good](std::vector<std::uint8_t> bytes) {
    bytes.insert(bytes.begin(), good.begin(), good.end());
    return bytes;
  };
  EXPECT_EQ(refusal(machine, good), Result::ok);
  std::uint32_t value = 0;
  EXPECT_EQ(refusal(machine, and_then({0xC0, 0, 1, 0, 0})), Result::bad_frame);
  EXPECT_EQ(refusal(machine, and_then({0x01})), Result::bad_frame);
  EXPECT_EQ(refusal(machine, and_then({0x01, 1})), Result::bad_value);
  EXPECT_EQ(refusal(machine, and_then({0x43, 0, 0, 1, 0}), &value), Result::out_of_bounds);
  EXPECT_EQ(value, 1u);
  EXPECT_EQ(refusal(machine, good, &value, 0), Result::bad_value);
  std::vector<std::uint8_t> lines;
  for (std::size_t i = 0; i < wire::max_lines_a_frame; ++i)
    lines.insert(lines.end(), {0x41, static_cast<std::uint8_t>(i % 2 == 0 ? 1 : 255)});
  EXPECT_EQ(refusal(machine, lines), Result::ok);
  lines.insert(lines.end(), {0x41, 1});
  EXPECT_EQ(refusal(machine, lines), Result::bad_value);
  machine.settings.set_milli(Id::laser_mode, 0);
  EXPECT_EQ(refusal(machine, good, &value), Result::bad_value);
  EXPECT_EQ(value, settings::number(Id::laser_mode));
}

/// A frame without room is refused, whatever STATUS reported, and accepted once there is room.
TEST(Rows, AreNotTakenWithoutRoom) {
  Rig rig(raster_machine());
  rig.run(ps_per_ms);
  machine::Controller& core = rig.board.controller();
  wire::JobHeader header = row_header(raster_machine());
  header.mode = wire::mode_rows;
  header.points_total = 1000;
  ASSERT_EQ(core.on_begin(header), Result::ok);
  constexpr std::uint32_t places = stepper::PowerTable::capacity, places_a_line = 201;
  constexpr std::uint32_t lines = places / places_a_line;
  EXPECT_EQ(rig.status().free_runs, places);
  std::vector<std::uint8_t> frame{0xC3, 0, 0x87, 0x93, 3, 0xC4, 200};
  frame.resize(frame.size() + 400, 0);
  frame.insert(frame.end(), {0x01, 100});
  for (std::uint32_t taken = 1; taken <= lines; ++taken) {
    ASSERT_EQ(core.on_data(frame), Result::ok);
    EXPECT_EQ(rig.status().free_runs, places - places_a_line * taken);
    EXPECT_EQ(rig.status().received, taken);
  }
  const std::uint32_t free_points = rig.status().free_points;
  EXPECT_EQ(core.on_data(frame), Result::no_space);
  // Each of the two lines needs a place for itself.
  constexpr std::uint32_t left = places % places_a_line;
  const auto two_lines = [](std::uint8_t runs) {
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 2; ++i) {
      bytes.insert(bytes.end(), {0xC4, runs});
      bytes.resize(bytes.size() + 2 * runs, 0);
      bytes.insert(bytes.end(), {0x01, 100});
    }
    return bytes;
  };
  EXPECT_EQ(core.on_data(two_lines(left / 2)), Result::no_space);
  EXPECT_EQ(rig.status().free_points, free_points);
  EXPECT_EQ(rig.status().received, lines);
  rig.run(ps_per_s);
  EXPECT_EQ(rig.status().free_runs, places);
  EXPECT_EQ(rig.status().first_unfired, lines);
  EXPECT_EQ(core.on_data(frame), Result::ok);
  // Lines without light need no runs, but they need room.
  std::vector<std::uint8_t> rapids;
  for (std::size_t i = 0; i < wire::max_lines_a_frame; ++i)
    rapids.insert(rapids.end(), {0x41, static_cast<std::uint8_t>(i % 2 == 0 ? 1 : 255)});
  while (core.on_data(rapids) == Result::ok) {
  }
  EXPECT_LT(rig.status().free_points, wire::max_lines_a_frame);
}

/// Corrupted frames with a correct checksum are accepted whole or not at all and never lead out of
/// the work space; a stop ends the job.
TEST(Rows, OfGarbageAreTakenWholeOrNotAtAll) {
  int taken = 0;
  for (int i = 0; i < scaled(40); ++i) {
    std::mt19937_64 random(static_cast<std::uint64_t>(i));
    const job::Profile machine = raster_machine();
    Rig rig(machine);
    rig.run(ps_per_ms);
    machine::Controller& core = rig.board.controller();
    wire::JobHeader header = row_header(machine);
    header.mode = wire::mode_rows;
    const auto lines = PixelLines(Raster(random(), 4, 60, 3), 40).lines();
    header.points_total = static_cast<std::uint32_t>(lines.size());
    auto frames = row_frames(lines, header, 100);
    ASSERT_EQ(core.on_begin(header), Result::ok);
    for (RowFrame& frame : frames) {
      for (auto k = random() % 3; k != 0; --k)
        frame.payload[random() % frame.payload.size()] = static_cast<std::uint8_t>(random());
      const wire::Status before = rig.status();
      const Result result = core.on_data(frame.payload);
      const wire::Status after = rig.status();
      if (result == Result::ok) {
        ++taken;
        EXPECT_LT(before.free_runs - after.free_runs, 60u);
      } else {
        EXPECT_EQ(after.received, before.received);
        EXPECT_EQ(after.free_points, before.free_points);
        EXPECT_EQ(after.free_runs, before.free_runs);
      }
      rig.run(static_cast<Picoseconds>(random() % 100) * ps_per_ms);
    }
    const StepLimits space = work_space(machine.settings);
    for (int axis = 0; axis < 3; ++axis) {
      for (const PinMonitor::Step& step : rig.monitor.steps(axis))
        ASSERT_TRUE(space.contains(axis, step.position));
    }
    core.on_command({wire::Command::stop, 0});
    rig.run(ps_per_s);
    EXPECT_EQ(rig.state(), MachineState::idle);
    EXPECT_FALSE(rig.board.bus().level(sim::Pin::laser_gate));
  }
  EXPECT_GT(taken, scaled(40));
}

/// Lines of text during a row job: programs are refused, queries answered; the job is unaffected.
TEST(Rows, TakeNoProgramsMeanwhile) {
  RowRig rows(Raster(4, 4, 200, 3));
  for (int k = 0; k < 500; ++k) rows.host.step();
  ASSERT_EQ(rows.rig.state(), MachineState::run);
  rows.cable.type("G0 X50\n$J=G91 X5 F100\n$G\n$32=0\n");
  for (int k = 0; k < 40; ++k) rows.host.step();
  std::vector<std::string> answers;
  for (const std::string& text : rows.host.texts())
    if (text == "ok" || text.starts_with("error:")) answers.push_back(text);
  EXPECT_EQ(answers, (std::vector<std::string>{"error:8", "error:8", "ok", "error:8"}));
  ASSERT_TRUE(rows.host.run(30));
  rows.expect_burnt();
}

/// A row job fires no shots and refuses a change of the lamp's frequency, even with a lamp.
TEST(Rows, FireNoShotsBesideALamp) {
  const Raster raster(5, 3, 200, 3);
  job::Profile machine = raster_machine();
  machine.settings.set_milli(Id::lamp_mode, 1000);
  Rig rig(machine);
  BoardCable cable(rig);
  RowHost host(cable, PixelLines(raster).lines(), row_header(machine));
  for (int k = 0; k < 300; ++k) host.step();
  ASSERT_EQ(rig.state(), MachineState::run);
  EXPECT_EQ(rig.board.controller().on_command({wire::Command::lamp_frequency, 50'000}),
            Result::unsupported);
  ASSERT_TRUE(host.run(30));
  EXPECT_TRUE(rig.monitor.fires().empty());
  const CellLight light = cell_light(raster, rig.monitor, rig.board.world().beam());
  EXPECT_EQ(light.right, raster.pixels());
}

}  // namespace
}  // namespace lamplock::test
