// Random programs by the board's interpreter and by LinuxCNC's rs274: the same moves in the same
// places, and the same lines refused.
#include "tests/program/rs274.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "tests/program/rig.hpp"
#include "tests/scale.hpp"

namespace lamplock::program::rs274_test {
namespace {

using lamplock::test::scaled;
using test::CanonicalLine;
using test::CanonicalMove;
using test::Rig;
using test::Rs274;

/// rs274 prints four decimals, of an inch or of a millimetre; each end of a move is rounded.
constexpr double end_tolerance_mm = 4e-3, length_tolerance = 1e-3;

/// Modal state, offsets and place at the start of every program.
constexpr std::string_view reset = "G21 G17 G90 G91.1 G94 G40 G49 G54 G61 G80 G98 G92.1 M5 F100";
const Rs274::Program zero_offsets = {"G10 L2 P1 X0 Y0 Z0 A0 R0",
                                     "G10 L2 P2 X0 Y0 Z0 A0 R0",
                                     "G10 L2 P9 X0 Y0 Z0 A0 R0",
                                     "G0 X0 Y0 Z5 A0",
                                     "G28.1",
                                     "G30.1",
                                     "M3 S100"};

/// Makes programs of lines that both interpreters know.
class Programs {
 public:
  explicit Programs(unsigned seed) : random_(seed) {}

  /// The modal state is that after `reset`.
  void begin() {
    relative_ = series_ = shifts_ = false;
    tools_ = random_() % 2 == 0;
    retract_mm_ = 4;
  }

  /// Everything; few cycles, one at a time: rs274 keeps a series through G28 and a change of units.
  std::string any_line() {
    if (std::exchange(series_, false)) return "G80";
    switch (random_() % 14) {
      case 0:
        return tools_ ? "G43.1 Z1.5" : one_of({"G20", "G21"});
      case 1:
        return one_of({"G90", "G91"});
      case 2:
        return one_of({"G54", "G55", "G59.3"});
      case 3:
        return one_of({"G10 L2 P", "G10 L20 P"}) + one_of({"1", "2", "9"}) + axes();
      case 4:
        // rs274 refuses G53 in G91; grbl and the board do not.
        return one_of({"G92", "G90 G53 G0", "G90 G53 G1", "G28", "G49 G30"}) + axes();
      case 5:
        return one_of({"G92.1", "G92.2", "G92.3", "G28.1", "G30.1", "G49", "G4 P.25"});
      case 6:
        return one_of({"G17", "G18", "G19"});
      case 7:
      case 8:
        return circle();
      case 9:
        return cycle_line();
      case 10:
        return one_of({"G61", "G61.1", "G64", "G64 P.05 Q.01", "G98", "G99", "M3 S100", "G80"});
      default:
        return one_of({"G0", "G1", "G1 F200", "G80 G0", "G1 G80"}) + axes();
    }
  }

  /// Rotated coordinate systems. G28 and G30 name X and Y or neither: of one alone rs274 keeps the
  /// other in the rotated system, where the machine's own place of the first is missed. Arcs are in
  /// the plane that stays a plane of the machine. While a shift of G92 is active G10 changes no
  /// rotation: rs274 turns the current position without that shift.
  std::string rotated_line() {
    switch (random_() % 9) {
      case 0:
        return one_of({"G54", "G55", "G59.3"});
      case 1:
        return shifts_ ? "G4 P.25"
                       : one_of({"G10 L2 P0 R", "G10 L2 P1 R", "G10 L2 P2 R", "G10 L2 P9 R"}) +
                             number(500, -500) + axes_or_none();
      case 2:
        return "G10 L20 P" + one_of({"0", "1", "2", "9"}) + axes();
      case 3:
        return one_of({"G90 G53 G0", "G90 G53 G1"}) + axes();
      case 4:
        if (random_() % 4 == 0) shifts_ = true;
        return shifts_ ? "G92" + axes() : one_of({"G28.1", "G30.1", "G90", "G91"});
      case 5:
        return fmt::format("{} X{} Y{}", one_of({"G28", "G30"}), number(9, -9), number(9, -9));
      case 6:
        return circle(0);
      case 7:
        return fmt::format("G0 X#{}", 5230 + 20 * (random_() % 9));
      default:
        return one_of({"G0", "G1", "G1 F200"}) + axes();
    }
  }

  /// Series of cycles, and what is between them. In a series the retract level only falls: from
  /// below a new one rs274 crosses to the next hole on a slope, the board rises first.
  std::string cycle_line() {
    switch (random_() % 10) {
      case 0:
        series_ = false;
        return one_of({"G80", "G0", "G80 G0 X1.5", "G1 Y-2 G80"});
      case 1:
        return one_of({"G98", "G99"});
      case 2:
        return rise();
      case 3:
      case 4:
      case 5: {
        series_ = true;
        const std::string kind = one_of({"G81", "G82", "G83", "G73", "G85", "G86", "G89"});
        std::string line = one_of({"", "G98 ", "G99 "}) + kind;
        line += " R" + retract() + " X" + number(4, -4) + " Z" + number(-5, -9);
        if (kind == "G82" || kind == "G86" || kind == "G89") line += " P.5";
        // Where the depth is a multiple of Q, rounding makes rs274 peck once more.
        if (kind == "G83" || kind == "G73") line += " Q" + number(3, 1) + "73";
        if (random_() % 3 == 0) line += " L" + std::to_string(1 + random_() % 3);
        return line;
      }
      default: {
        std::string line = one_of({"X", "Y"}) + number(4, -4);
        if (random_() % 4 == 0 && series_) line += " R" + retract();
        if (random_() % 4 == 0 && series_) line += " Z" + number(-5, -9);
        return line;
      }
    }
  }

 private:
  std::string one_of(std::initializer_list<const char*> texts) {
    return texts.begin()[random_() % texts.size()];
  }
  /// Three decimals.
  std::string number(int high, int low) {
    const int n =
        low * 1000 + static_cast<int>(random_() % static_cast<unsigned>((high - low) * 1000 + 1));
    return fmt::format("{}{}.{:03}", n < 0 ? "-" : "", std::abs(n) / 1000, std::abs(n) % 1000);
  }
  /// Ends a series above every retract level.
  std::string rise() {
    retract_mm_ = 4;
    series_ = false;
    if (random_() % 3 == 0) relative_ = !relative_;
    return fmt::format("{} {} X{} Z{}", relative_ ? "G91" : "G90", one_of({"G80 G0", "G0", "G1"}),
                       number(4, -4), relative_ ? number(4, 0) : number(9, 5));
  }
  std::string retract() {
    std::string text = number(relative_ ? retract_mm_ - 4 : retract_mm_, relative_ ? -4 : 0);
    retract_mm_ = static_cast<int>(std::floor(std::stod(text))) + (relative_ ? 4 : 0);
    return text;
  }

  /// Some axis words, at least one.
  std::string axes() {
    std::string text;
    while (text.empty()) text = axes_or_none();
    return text;
  }
  std::string axes_or_none() {
    std::string text;
    for (const char letter : {'X', 'Y', 'Z', 'A'})
      if (random_() % 3 == 0) text += fmt::format(" {}{}", letter, number(9, -9));
    return text;
  }

  /// Full, half and quarter circles and arcs by radius, in every plane.
  std::string circle() { return circle(static_cast<unsigned>(random_() % 3)); }
  std::string circle(unsigned plane) {
    const char* const letters = plane == 0 ? "XYIJZ" : plane == 1 ? "ZXKIY" : "YZJKX";
    const std::string radius = number(5, 1);
    const double r = std::stod(radius);
    std::string line = fmt::format("G91 G{} G{} ", 17 + plane, 2 + random_() % 2);
    switch (random_() % 5) {
      case 0:
        line += fmt::format("{}{}", letters[2], radius);
        break;
      case 1:
        line += fmt::format("{}{:.3f} {}{}", letters[0], 2 * r, letters[2], radius);
        break;
      case 2:
        line += fmt::format("{0}{2} {1}{2} {3}{2} {4}0", letters[0], letters[1], radius, letters[2],
                            letters[3]);
        break;
      case 3:
        line += fmt::format("{}{} {}-{}", letters[2], radius, letters[3], radius);
        break;
      default:
        return line + fmt::format("{}{:.3f} {}0.5 R{}{}", letters[0], r, letters[1],
                                  random_() % 2 == 0 ? "-" : "", radius);
    }
    if (random_() % 3 == 0) line += fmt::format(" {}{}", letters[4], number(3, -3));
    if (random_() % 4 == 0) line += fmt::format(" P{}", 1 + random_() % 3);
    return line;
  }

  std::mt19937 random_;
  bool relative_ = false, series_ = false, shifts_ = false;
  bool tools_ = false;  ///< tool lengths; without units, since rs274 does not convert a tool length
  int retract_mm_ = 4;
};

/// A move of the board's interpreter; a curve is one move with its length.
struct Move {
  CanonicalMove::Kind kind;
  std::array<double, 4> to_mm;
  double length_mm;
};

std::array<double, 4> in_mm(const Place& place) {
  std::array<double, 4> mm{};
  for (std::size_t i = 0; i < 4; ++i) mm[i] = static_cast<double>(place[i]) / one_e7;
  return mm;
}

double distance(const std::array<double, 4>& a, const std::array<double, 4>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/// Moves of no length are left out: rs274 prints some of them. Pieces of a curve are one move,
/// pecks of a cycle are many.
std::vector<Move> moves_of(Rig& rig, std::array<double, 4>& here) {
  const bool pecks = is_cycle(rig.interpreter.modal().motion);
  std::vector<Move> moves;
  double length = 0;
  for (const Action& action : rig.take()) {
    if (action.kind != ActionKind::move) continue;
    const std::array<double, 4> to = in_mm(action.target_e7);
    length += distance(here, to);
    here = to;
    if (!action.programmed_end && !action.rapid && !pecks) continue;
    const auto kind = action.rapid ? CanonicalMove::Kind::rapid : CanonicalMove::Kind::feed;
    if (length > end_tolerance_mm) moves.push_back({kind, to, length});
    length = 0;
  }
  return moves;
}

double arc_length(const std::array<double, 4>& from, const CanonicalMove& move) {
  static constexpr std::size_t axes[3][3] = {{0, 1, 2}, {2, 0, 1}, {1, 2, 0}};
  const auto& [first, second, normal] = axes[move.plane];
  const double x = from[first] - move.centre_mm[0], y = from[second] - move.centre_mm[1];
  const double u = move.to_mm[first] - move.centre_mm[0],
               v = move.to_mm[second] - move.centre_mm[1];
  constexpr double turn = 2 * std::numbers::pi;
  double angle = std::atan2(v, u) - std::atan2(y, x);
  if (move.turns < 0) angle = -angle;
  // The end of a full circle is its start, but for rounding.
  constexpr double rounding = 1e-3;
  while (angle < rounding) angle += turn;
  while (angle > turn + rounding) angle -= turn;
  angle += turn * (std::abs(move.turns) - 1);
  return std::hypot(angle * std::hypot(x, y), move.to_mm[normal] - from[normal]);
}

std::vector<Move> moves_of(const CanonicalLine& line, std::array<double, 4>& here) {
  std::vector<Move> moves;
  for (const CanonicalMove& move : line.moves) {
    if (move.kind == CanonicalMove::Kind::dwell) continue;
    const bool arc = move.kind == CanonicalMove::Kind::arc;
    const double length = arc ? arc_length(here, move) : distance(here, move.to_mm);
    here = move.to_mm;
    if (length > end_tolerance_mm)
      moves.push_back({arc ? CanonicalMove::Kind::feed : move.kind, move.to_mm, length});
  }
  return moves;
}

std::string text_of(const std::vector<Move>& moves) {
  std::string text;
  for (const Move& move : moves)
    text += fmt::format("{} to {:.4f} {:.4f} {:.4f} length {:.4f}; ",
                        move.kind == CanonicalMove::Kind::rapid ? "rapid" : "feed", move.to_mm[0],
                        move.to_mm[1], move.to_mm[2], move.length_mm);
  return text;
}

bool same(const std::vector<Move>& a, const std::vector<Move>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].kind != b[i].kind || distance(a[i].to_mm, b[i].to_mm) > end_tolerance_mm ||
        std::abs(a[i].length_mm - b[i].length_mm) >
            end_tolerance_mm + length_tolerance * b[i].length_mm)
      return false;
  return true;
}

/// What a cycle cuts, and where it ends.
std::vector<Move> cuts(const std::vector<Move>& moves) {
  std::vector<Move> result;
  for (const Move& move : moves)
    if (move.kind == CanonicalMove::Kind::feed || &move == &moves.back()) result.push_back(move);
  if (!result.empty()) result.back().length_mm = 0;
  return result;
}

/// A rapid changes the level and moves across, so that it could hit a clamp.
bool slopes(const std::vector<Move>& moves, std::array<double, 4> here) {
  for (const Move& move : moves) {
    if (move.kind == CanonicalMove::Kind::rapid && std::abs(move.to_mm[2] - here[2]) > 1e-3 &&
        std::hypot(move.to_mm[0] - here[0], move.to_mm[1] - here[1]) > 1e-3)
      return true;
    here = move.to_mm;
  }
  return false;
}

/// In cycles the rapids of rs274 may be others: where the tool is below the level to which G98
/// returns, or below a new retract level, rs274 crosses to the hole on a slope.
enum class Rapids { compared, not_in_cycles };

/// Runs a program by both and compares each line, up to the first one that both refuse.
void expect_same(const Rs274::Program& program, const std::vector<CanonicalLine>& lines,
                 Rapids rapids) {
  Rig rig;
  rig.options.arc_tolerance_e7 = 1000;  // so that the chords are as long as the arc
  ASSERT_EQ(rig.run(reset), "spindle M5");
  std::array<double, 4> here{}, there{};
  std::string text;
  for (std::size_t i = 0; i < program.size(); ++i) {
    text += program[i] + "\n";
    const Fault fault = rig.interpreter.run(program[i]);
    const bool refused = !lines[i].refusal.empty();
    ASSERT_EQ(static_cast<bool>(fault), refused)
        << text << test::text_of(fault) << " / " << lines[i].refusal;
    if (refused) return;
    const std::array<double, 4> start = there;
    std::vector<Move> moves = moves_of(rig, here), theirs = moves_of(lines[i], there);
    if (is_cycle(rig.interpreter.modal().motion) &&
        (rapids == Rapids::not_in_cycles || slopes(theirs, start))) {
      moves = cuts(moves);
      theirs = cuts(theirs);
    }
    ASSERT_TRUE(i < zero_offsets.size() || same(moves, theirs))
        << text << text_of(moves) << "\n / " << text_of(theirs);
  }
}

template <class Line>
void compare(unsigned seed, int count, Rapids rapids, const Line& line) {
  if (!Rs274::available()) GTEST_SKIP() << "toolchain/setup could not unpack rs274";
  constexpr int programs_a_process = 50, lines_a_program = 12;
  Rs274 rs274;
  for (int done = 0; done < count; done += programs_a_process) {
    Programs random(seed + static_cast<unsigned>(done));
    std::vector<Rs274::Program> programs;
    for (int i = 0; i < programs_a_process; ++i) {
      random.begin();
      programs.push_back(zero_offsets);
      for (int k = 0; k < lines_a_program; ++k) programs.back().push_back(line(random));
    }
    const auto results = rs274.run(programs, reset);
    for (std::size_t i = 0; i < programs.size(); ++i) {
      expect_same(programs[i], results[i], rapids);
      if (::testing::Test::HasFatalFailure()) return;
    }
  }
}

TEST(Rs274, RandomProgramsMoveAlike) {
  compare(1, scaled(2000, 100), Rapids::not_in_cycles,
          [](Programs& programs) { return programs.any_line(); });
}

TEST(Rs274, RotatedSystemsMoveAlike) {
  compare(3, scaled(1000, 100), Rapids::compared,
          [](Programs& programs) { return programs.rotated_line(); });
}

TEST(Rs274, SeriesOfCyclesMoveAlike) {
  compare(2, scaled(600, 100), Rapids::compared,
          [](Programs& programs) { return programs.cycle_line(); });
}

}  // namespace
}  // namespace lamplock::program::rs274_test
