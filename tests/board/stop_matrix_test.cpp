// Every stop during every activity, with any number of waiting lines: motion stops, the laser is
// dark, and the state is that of the table in docs/safety.md.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <functional>
#include <map>

#include "tests/board/bench.hpp"
#include "tests/docs/page.hpp"
#include "tests/scale.hpp"

namespace lamplock::test::stop_matrix_test {
namespace {

/// The machine of this test moves at 50 mm/s at most and brakes at 2 m/s2.
constexpr sim::Picoseconds braking = 25 * ps_per_ms;
/// Ticks handed out ahead, and a round of the main loop.
constexpr sim::Picoseconds reaction = 30 * ps_per_ms;
constexpr sim::Picoseconds dark_at_once = ps_per_ms;

std::string short_lines() {
  std::string text = "M4 S800\nG1 F3000\n";
  for (int i = 1; i <= 60; ++i) text += fmt::format("X{:.2f}Y{:.2f}\n", 0.3 * i, 0.02 * (i % 2));
  return text;
}

struct Activity {
  const char* name;
  std::function<void(Bench&)> begin;
  int ms = 300;          ///< time until the stop
  bool parking = false;  ///< parking is set
  bool framed = false;   ///< a job of frames or no activity: no waiting lines
  bool jogs = false;     ///< waiting lines are jogs
};

const std::vector<Activity>& activities() {
  static const auto typed = [](std::string_view lines) {
    return [lines](Bench& bench) { bench.type(lines); };
  };
  static const std::vector<Activity> all{
      {"idle", typed("G1 X1 F3000\n"), 300, false, true},
      {"G0", typed("G0 X45\n")},
      {"G1 with M3", typed("M3 S500\nG1 X45 F3000\n")},
      {"G1 with M4", typed("M4 S500\nG1 X45 F3000\n")},
      {"short lines", [](Bench& bench) { bench.type(short_lines()); }},
      {"hold",
       [](Bench& bench) {
         bench.type("M3 S500\nG1 X45 F3000\n");
         bench.pass(150 * ps_per_ms);
         bench.type("!");
       }},
      {"jog", typed("$J=X45 F3000\n"), 300, false, false, true},
      {"homing", typed("$H\n")},
      {"probe", typed("G38.2 X45 F1200\n")},
      {"door",
       [](Bench& bench) {
         bench.type("M3 S500\nG1 X45 F3000\n");
         bench.pass(150 * ps_per_ms);
         bench.door(true);
       }},
      {"parking",
       [](Bench& bench) {
         bench.type("M3 S500\nG1 X45 F3000\n");
         bench.pass(150 * ps_per_ms);
         bench.door(true);
       },
       300, true},
      {"dwell", typed("M3 S500\nG1 X1 F3000\nG4 P30\n")},
      {"M0", typed("M3 S500\nG1 X1 F3000\nM0\nG1 X9\n")},
      {"M6", typed("M3 S500\nG1 X1 F3000\nT2 M6\nG1 X9\n")},
      {"beat lock",
       typed("M3 S500\nM130 P0\nG1 X1 F3000\nX2\nX3\nX4\nX5\nX6\nX7\nX8\nX9\nX10\nX12\n"
             "X14\nX16\nX18\nX20\nX22\nX24\nX26\nX28\nX30\nX32\nX34\nX36\nX38\n")},
      {"points", begin_points, 300, false, true},
      {"rows", begin_rows, 300, false, true},
      {"check", typed("$C\nG1 X45 F3000\n")},
      {"alarm", typed("G1 X99 F3000\n")},
      {"sleep", typed("$SLP\n")},
  };
  return all;
}

struct Stop {
  const char* name;
  std::function<void(Bench&)> make;
  bool dark_at_once = false;  ///< else the light may last while the machine brakes
  bool framed = false;        ///< a frame, which waits for the lines before it
};

const std::vector<Stop>& stops() {
  static const auto byte = [](std::uint8_t value) {
    return [value](Bench& bench) { bench.board().write({&value, 1}); };
  };
  static const std::vector<Stop> all{
      {"0x18", byte(reset_byte), true},
      {"!", byte('!')},
      {"0x84", byte(door_byte), true},
      {"0x85", byte(jog_cancel_byte)},
      {"door", [](Bench& bench) { bench.door(true); }, true},
      {"e-stop",
       [](Bench& bench) { bench.board().world().schedule(sim::Pin::estop, true, bench.now()); },
       true},
      {"stop", [](Bench& bench) { bench.command(wire::Command::stop); }, false, true},
      {"hold", [](Bench& bench) { bench.command(wire::Command::hold); }, false, true},
      {"host gone",
       [](Bench& bench) {
         bench.host_step = nullptr;
         bench.board().set_host_present(false);
       }},
  };
  return all;
}

struct Flood {
  std::size_t bytes;
  bool reads;
};
constexpr std::array floods{Flood{0, true},     Flood{1000, true},      Flood{9000, true},
                            Flood{9000, false}, Flood{1'000'000, true}, Flood{1'000'000, false}};

/// Result of a stop; times are the longest of all numbers of waiting lines.
struct Cell {
  std::string state;
  sim::Picoseconds rest = 0, dark = 0;
  bool moved = false;
  std::size_t shots = 0;  ///< after the stop
};

std::string state_of(Bench& bench) {
  const wire::Status status = bench.machine.rig.status();
  switch (status.state) {
    case MachineState::idle:
      return "idle";
    case MachineState::run:
      return "runs on";
    case MachineState::hold:
      return "hold";
    case MachineState::alarm:
      return fmt::format("alarm {}", status.alarm);
    case MachineState::door:
      return "door";
    case MachineState::estop:
      return "e-stop";
    case MachineState::home:
      return "homing";
  }
  return "?";
}

sim::Picoseconds last_step(const PinMonitor& monitor, sim::Picoseconds from) {
  sim::Picoseconds last = from;
  for (int a = 0; a < 3; ++a)
    if (!monitor.steps(a).empty()) last = std::max(last, monitor.steps(a).back().at);
  return last;
}

sim::Picoseconds last_light(Bench& bench, sim::Picoseconds from) {
  sim::Picoseconds last = from;
  for (const sim::BeamChange& change : bench.board().world().beam().changes())
    if (change.light() == 0) last = std::max(last, change.at);
  if (bench.board().world().beam().shone(bench.now() - 1, bench.now())) return bench.now();
  return last;
}

void measure(const Activity& activity, const Stop& stop, const Flood& flood, Cell& cell) {
  Bench bench(activity.parking);
  activity.begin(bench);
  std::string lines;
  const std::string_view line = activity.jogs ? "$J=G91 X0.1 F60\n" : "G1 X0.1 F60\nG1 X0 F60\n";
  while (lines.size() < flood.bytes) lines += line;
  if (!bench.host_step)
    bench.board().write({reinterpret_cast<const std::uint8_t*>(lines.data()), lines.size()});
  const auto pass = [&](sim::Picoseconds time) {
    flood.reads ? bench.pass(time) : bench.machine.rig.run(time);
  };
  pass(activity.ms * ps_per_ms);
  const sim::Picoseconds stopped = bench.now();
  stop.make(bench);
  pass(1'500 * ps_per_ms);
  cell.state = state_of(bench);
  const sim::Picoseconds end = bench.now();
  const sim::Picoseconds rest = last_step(bench.machine.rig.monitor, stopped) - stopped;
  const sim::Picoseconds dark = last_light(bench, stopped) - stopped;
  cell.moved = cell.moved || bench.machine.rig.monitor.stepped(stopped - 5 * ps_per_ms, stopped);
  cell.rest = std::max(cell.rest, rest);
  cell.dark = std::max(cell.dark, dark);
  cell.shots += bench.machine.rig.monitor.fired(stopped + 2 * ps_per_ms, end);
}

/// Required state after the stop. "-": the stop has no meaning there.
using Row = std::map<std::string, std::string>;
const std::map<std::string, Row>& wanted() {
  static const Row program{{"0x18", "alarm 3"}, {"!", "hold"},    {"0x84", "door"},
                           {"0x85", "-"},       {"door", "door"}, {"e-stop", "e-stop"},
                           {"stop", "idle"},    {"hold", "hold"}, {"host gone", "hold"}};
  static const auto with = [](Row row, std::initializer_list<Row::value_type> changes) {
    for (const auto& [stop, state] : changes) row[stop] = state;
    return row;
  };
  static const Row idle = with(program, {{"0x18", "idle"},
                                         {"!", "hold"},
                                         {"door", "idle"},
                                         {"stop", "idle"},
                                         {"hold", "hold"},
                                         {"host gone", "idle"}});
  static const Row locked = with(idle, {{"0x18", "alarm 2"},
                                        {"!", "alarm 2"},
                                        {"0x84", "alarm 2"},
                                        {"0x85", "alarm 2"},
                                        {"door", "alarm 2"},
                                        {"stop", "alarm 2"},
                                        {"hold", "alarm 2"},
                                        {"host gone", "alarm 2"}});
  static const std::map<std::string, Row> all{
      {"idle", idle},
      {"G0", program},
      {"G1 with M3", program},
      {"G1 with M4", program},
      {"short lines", program},
      {"hold", with(program, {{"0x18", "idle"}, {"0x85", "hold"}})},
      {"jog", with(program, {{"!", "idle"},
                             {"0x84", "idle"},
                             {"0x85", "idle"},
                             {"door", "idle"},
                             {"hold", "idle"},
                             {"host gone", "idle"}})},
      {"homing", with(program, {{"0x18", "alarm 6"},
                                {"!", "alarm 6"},
                                {"0x84", "alarm 7"},
                                {"0x85", "alarm 6"},
                                {"door", "alarm 7"},
                                {"stop", "alarm 6"},
                                {"hold", "alarm 6"},
                                {"host gone", "-"}})},
      {"probe", program},
      {"door", with(program, {{"0x18", "idle"},
                              {"!", "door"},
                              {"0x85", "door"},
                              {"hold", "door"},
                              {"host gone", "door"}})},
      {"parking", with(program, {{"!", "door"},
                                 {"0x85", "door"},
                                 {"host gone", "-"},
                                 {"0x84", "-"},
                                 {"door", "-"},
                                 {"hold", "door"}})},
      {"dwell", with(program, {{"0x18", "idle"}})},
      {"M0", with(program, {{"0x18", "idle"}, {"0x85", "hold"}})},
      {"M6", with(program, {{"0x18", "idle"}, {"0x85", "hold"}})},
      // A program with points ends the session of the job before.
      {"beat lock", with(program, {{"stop", "-"}, {"hold", "-"}})},
      {"points", with(program, {{"0x18", "idle"}, {"0x84", "hold"}})},
      {"rows", with(program, {{"0x18", "idle"}, {"0x84", "hold"}})},
      {"check", with(idle, {{"!", "idle"}, {"0x84", "idle"}, {"hold", "idle"}})},
      {"alarm", locked},
      {"sleep",
       with(idle, {{"0x18", "alarm 3"}, {"!", "idle"}, {"0x84", "idle"}, {"hold", "idle"}})},
  };
  return all;
}

std::string printed(const Cell& cell, bool stops_something) {
  if (!stops_something) return "-";
  const auto ms = [](sim::Picoseconds time) { return (time + ps_per_ms - 1) / ps_per_ms; };
  if (!cell.moved) return cell.state;
  return fmt::format("{}, {}", cell.state, ms(cell.rest));
}

/// Runs and judges one cell; returns its text in the table.
std::string tried(const Activity& activity, const Stop& stop, const std::string& state) {
  const bool stops = state != "-";
  // Frames wait for lines, and a job has no lines.
  const bool floods_too = stops && !stop.framed && !activity.framed;
  Cell cell;
  for (const Flood& flood : floods) {
    if (flood.bytes != 0 && !floods_too) continue;
    SCOPED_TRACE(fmt::format("{} by {} after {} bytes{}", activity.name, stop.name, flood.bytes,
                             flood.reads ? "" : ", answers not read"));
    measure(activity, stop, flood, cell);
    if (!stops) continue;
    EXPECT_EQ(cell.state, state);
    EXPECT_EQ(cell.shots, 0u);
    if (!cell.moved) continue;
    EXPECT_LE(cell.rest, braking + reaction);
    EXPECT_LE(cell.dark, stop.dark_at_once ? dark_at_once : braking + reaction);
  }
  return printed(cell, stops);
}

TEST(StopMatrix, EveryStopWorksInEveryState) {
  std::string table = "| state |", line = "|---|";
  for (const Stop& stop : stops()) {
    table += fmt::format(" {} |", stop.name);
    line += "---|";
  }
  table += "\n" + line + "\n";
  std::size_t number = 0;
  bool is_whole = true;
  for (const Activity& activity : activities()) {
    table += fmt::format("| {} |", activity.name);
    const Row& row = wanted().at(activity.name);
    for (const Stop& stop : stops()) {
      const bool tries = test::tries_cell(number++);
      is_whole = is_whole && tries;
      if (tries) table += fmt::format(" {} |", tried(activity, stop, row.at(stop.name)));
    }
    table += "\n";
  }
  if (!is_whole) return;
  const std::string page = read_repository_file("docs/safety.md");
  EXPECT_NE(page.find(table), std::string::npos) << "docs/safety.md should say:\n" << table;
}

}  // namespace
}  // namespace lamplock::test::stop_matrix_test
