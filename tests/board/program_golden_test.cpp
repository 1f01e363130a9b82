// Golden runs: programs on the virtual board against answers, paths, times and light that were
// worked out by hand (tests/board/program_golden). Every code and every error of docs/gcode.md that
// a program line can cause has a case.
#include <fmt/format.h>

#include <map>
#include <regex>
#include <set>

#include "sim/virtual_board/motion_trace.hpp"
#include "sim/world/pin_names.hpp"
#include "tests/board/program_host.hpp"
#include "tests/docs/page.hpp"
#include "tests/judges/path_judge.hpp"

namespace lamplock::test {
namespace {

const std::vector<std::string>& files() {
  static const std::vector<std::string> names{"moves",   "places", "cycles",
                                              "outputs", "errors", "beats"};
  return names;
}

std::vector<GoldenCase> all_cases() {
  std::vector<GoldenCase> all;
  for (const std::string& name : files()) {
    const std::string text =
        read_repository_file(fmt::format("tests/board/program_golden/{}.golden", name));
    const std::vector<GoldenCase> cases = GoldenReader::read(text);
    EXPECT_FALSE(cases.empty()) << name;
    all.insert(all.end(), cases.begin(), cases.end());
  }
  return all;
}

sim::Pin pin_of(const std::string& name) {
  for (std::size_t i = 0; i < sim::pin_count; ++i)
    if (sim::pin_names[i] == name) return static_cast<sim::Pin>(i);
  throw std::invalid_argument("no wire " + name);
}

job::Profile profile_of(const GoldenCase& golden, Id machine, int value) {
  job::Profile profile = program_profile();
  profile.settings.set_milli(Id::pin_map, golden.pin_map * 1000);
  profile.settings.set_milli(machine, value * 1000);
  return profile;
}

/// Changes of the programs' outputs and the position of X at each.
class OutputRecord final : private sim::PinListener {
 public:
  explicit OutputRecord(sim::VirtualBoard& board) : board_(board) {
    for (const sim::Pin pin : {sim::Pin::air, sim::Pin::aux_out}) board.bus().listen(pin, *this);
  }
  struct Edge {
    sim::Pin pin;
    double level;
    std::int32_t x;
  };
  std::vector<Edge> of(sim::Pin pin) const {
    std::vector<Edge> edges;
    std::copy_if(edges_.begin(), edges_.end(), std::back_inserter(edges),
                 [pin](const Edge& edge) { return edge.pin == pin; });
    return edges;
  }

 private:
  void pin_changed(sim::Pin pin, bool level, Picoseconds /*at*/) override {
    const double value = pin == sim::Pin::aux_out ? board_.bus().aux() / 65535.0 : level;
    edges_.push_back({pin, value, board_.world().drives().position()[0]});
  }
  sim::VirtualBoard& board_;
  std::vector<Edge> edges_;
};

/// One case on a board of its own.
class GoldenRun {
 public:
  GoldenRun(const GoldenCase& golden, Id machine, int value)
      : case_(golden), profile_(profile_of(golden, machine, value)) {
    for (const GoldenEdge& set : golden.sets)
      rig_.board.world().schedule(pin_of(set.wire), set.level != 0,
                                  static_cast<Picoseconds>(set.x_or_ms * 1e9));
  }

  void run() {
    sim::MotionTrace trace(rig_.board, {-max_beats, max_beats},
                           sim::MotionTrace::Zero::first_motion);
    StepRecord record(rig_.board);
    send();
    EXPECT_TRUE(host_.wait_for_rest());
    host_.run_ms(10);  // until the ticks handed out are over
    places_ = record.places();
    expect_answers();
    expect_ways();
    expect_edges();
    expect_time(trace);
    for (const std::string& text : case_.says) EXPECT_THAT(host_.said(), Contains(HasSubstr(text)));
    expect_undisturbed(rig_);
    expect_shots();
  }

 private:
  static constexpr std::int64_t max_beats = 1'000'000;
  static constexpr double max_ms = 30'000;

  void send() {
    std::string text;
    std::size_t answers = 0;
    for (const GoldenLine& line : case_.lines) {
      if (!line.resume) {
        text += line.text + "\n";
        ++answers;
        continue;
      }
      host_.send(text);
      text.clear();
      // The pause is answered at its end.
      run_until([&] { return rig_.state() == MachineState::hold; });
      EXPECT_EQ(host_.answers().size(), answers - 1);
      host_.run_ms(5);  // until the ticks handed out are over
      const StepPosition stood = rig_.board.world().drives().position();
      host_.run_ms(20);
      EXPECT_EQ(rig_.state(), MachineState::hold);
      EXPECT_EQ(rig_.board.world().drives().position(), stood);
      EXPECT_FALSE(rig_.board.world().beam().at(rig_.now()).shines());
      host_.send("~");
    }
    host_.send(text);
    run_until([&] { return host_.answers().size() >= answers; });
  }
  template <class Done>
  void run_until(Done done) {
    for (double ms = 0; ms < max_ms && !done(); ms += 1) host_.run_ms(1);
  }

  void expect_answers() const {
    std::vector<std::string> wanted;
    for (const GoldenLine& line : case_.lines)
      if (!line.resume) wanted.push_back(line.answer);
    EXPECT_EQ(host_.answers(), wanted);
  }

  void expect_ways() const {
    WayFollower follower(places_);
    for (const GoldenWay& way : case_.ways) {
      const std::string what = fmt::format("way to {} {} {}", way.to[0], way.to[1], way.to[2]);
      ASSERT_EQ(follower.follow(way), "") << what;
      if (case_.looks_at_light) expect_light(way, follower, what);
    }
    EXPECT_TRUE(follower.at_end()) << "motion continues from " << follower.text_of(follower.last());
  }

  void expect_light(const GoldenWay& way, const WayFollower& follower,
                    const std::string& what) const {
    const std::size_t quarter = (follower.last() - follower.first()) / 4;
    const std::vector<sim::BeamChange> changes = rig_.board.world().beam().changes();
    double least = 1, most = 0;
    for (std::size_t i = follower.first() + quarter; i + quarter < follower.last(); ++i) {
      const auto next = std::upper_bound(
          changes.begin(), changes.end(), places_[i].at,
          [](Picoseconds at, const sim::BeamChange& change) { return at < change.at; });
      const double light = next == changes.begin() ? 0 : std::prev(next)->light() / 65535.0;
      least = std::min(least, light);
      most = std::max(most, light);
    }
    EXPECT_NEAR(least, way.light[0], 0.01) << what;
    EXPECT_NEAR(most, way.light[1], way.light[1] == 0 ? 0 : 0.01) << what;
  }

  void expect_edges() const {
    std::map<std::string, std::vector<GoldenEdge>> wires{{"air", {}}, {"aux_out", {}}};
    for (const GoldenEdge& edge : case_.edges) wires[edge.wire].push_back(edge);
    for (const auto& [wire, wanted] : wires) {
      if (case_.edges.empty()) break;
      const std::vector<OutputRecord::Edge> edges = outputs_.of(pin_of(wire));
      ASSERT_EQ(edges.size(), wanted.size()) << wire;
      for (std::size_t i = 0; i < edges.size(); ++i) {
        EXPECT_NEAR(edges[i].level, wanted[i].level, 1e-4) << wire << " " << i;
        EXPECT_NEAR(edges[i].x, wanted[i].x_or_ms * 200, 1) << wire << " " << i;
      }
    }
  }

  /// Each shot is at its place to the step, on a beat of its own.
  void expect_shots() const {
    const auto& shots = rig_.board.lattice_shots();
    ASSERT_EQ(shots.size(), case_.shots.size());
    ASSERT_EQ(rig_.shots().size(), case_.shots.size());
    for (std::size_t i = 0; i < shots.size(); ++i) {
      for (std::size_t a = 0; a < 3; ++a)
        EXPECT_EQ(shots[i].steps[a], std::lround(case_.shots[i][a] * WayFollower::steps_per_mm))
            << "shot " << i << " axis " << a;
      if (i != 0) {
        EXPECT_GT(rig_.shots()[i].beat, rig_.shots()[i - 1].beat);
      }
    }
  }

  void expect_time(const sim::MotionTrace& trace) const {
    if (!case_.ms) return;
    std::uint64_t first = 0, end = 0;
    for (const sim::MotionPiece& piece : trace.pieces()) {
      if (!piece.moves()) continue;
      if (end == 0) first = piece.first_tick;
      end = piece.end_tick();
    }
    const double ms = static_cast<double>(end - first) * 1000 / ticks_per_second;
    EXPECT_GE(ms, *case_.ms - 0.1);
    EXPECT_LE(ms, *case_.ms + case_.slack_ms);
  }

  const GoldenCase& case_;
  job::Profile profile_;
  Rig rig_{profile_};
  OutputRecord outputs_{rig_.board};
  ProgramHost host_{rig_};
  std::vector<PassedPlace> places_;
};

TEST(ProgramGolden, RunsAsWorkedOut) {
  for (const GoldenCase& golden : all_cases()) {
    SCOPED_TRACE(fmt::format("case {}", golden.name));
    GoldenRun(golden, Id::kinematics, 0).run();
  }
}

/// The same paths, times and light with motors that make X + Y and X - Y.
TEST(ProgramGolden, RunsAsWorkedOutOnACoreXy) {
  for (const GoldenCase& golden : all_cases()) {
    SCOPED_TRACE(fmt::format("case {}", golden.name));
    GoldenRun(golden, Id::kinematics, 1).run();
  }
}

/// First cells of the rows of the table under this heading.
std::vector<std::string> first_cells(const std::string& heading) {
  const std::string page = read_repository_file("docs/gcode.md");
  const std::size_t from = page.find(fmt::format("\n## {}\n", heading));
  if (from == std::string::npos) return {};
  const std::string text = page.substr(from, page.find("\n## ", from + 1) - from);
  const std::regex row("\n\\| ([GM0-9][^|]*) \\|");
  std::vector<std::string> cells;
  for (std::sregex_iterator r(text.begin(), text.end(), row), last; r != last; ++r)
    cells.push_back((*r)[1]);
  return cells;
}

/// Errors that no program line can cause here, with their cause.
const std::set<std::string> not_of_lines{
    "error:5",   // $H
    "error:6",   // settings
    "error:7",   // settings, at the start
    "error:8",   // $ commands; program lines only in a job or while the beat is undecided
    "error:10",  // settings
    "error:12",  // settings
    "error:13",  // $ commands
    "error:14",  // $N, $I
    "error:17",  // settings
    "error:18",  // a reset meanwhile
    "error:40",  // lines of the user in a tool change
    "error:45",  // homing
    "error:46",  // homing
    "error:50",  // $ commands while the emergency stop is active
    "error:52",  // settings
    "error:53",  // settings
};

TEST(ProgramGolden, HasACaseForEveryCodeAndEveryError) {
  std::set<std::string> covered, wanted;
  for (const GoldenCase& golden : all_cases()) {
    for (const std::string& what : golden.covers) {
      covered.insert(what);
      const bool error = what.starts_with("error:");
      // A code may precede another word, but not a digit or a point.
      const std::regex code(fmt::format("(^|[^A-Z]){}($|[^0-9.])", what));
      const bool there =
          std::any_of(golden.lines.begin(), golden.lines.end(), [&](const GoldenLine& line) {
            return error ? line.answer == what : std::regex_search(line.text, code);
          });
      EXPECT_TRUE(there) << golden.name << " has no " << what;
    }
  }
  const std::regex code("[GM][0-9.]+");
  for (const std::string& cell : first_cells("Codes"))
    for (std::sregex_iterator c(cell.begin(), cell.end(), code), last; c != last; ++c)
      wanted.insert(c->str());
  for (const std::string& cell : first_cells("Errors")) {
    const std::string error = fmt::format("error:{}", cell);
    if (not_of_lines.count(error) == 0) wanted.insert(error);
  }
  EXPECT_GT(wanted.size(), 100u);
  EXPECT_EQ(covered, wanted);
}

}  // namespace
}  // namespace lamplock::test
