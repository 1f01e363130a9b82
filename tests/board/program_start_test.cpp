// Programs that begin in their middle on a board with tools, offsets and rotations: they end in the
// state of the whole program, or are refused with a remedy that works.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <optional>
#include <string>
#include <vector>

#include "firmware/program/interpreter.hpp"
#include "host/error.hpp"
#include "host/job/profile.hpp"
#include "host/program/board_state.hpp"
#include "host/program/interpreter_options.hpp"
#include "host/program/program_flow.hpp"
#include "host/program/start_at.hpp"

namespace lamplock::test::program_start {
namespace {

using program_run::BoardState;
using testing::Contains;
using testing::HasSubstr;
using testing::Not;

using Lines = std::vector<link::ProgramLine>;

settings::Values values() {
  settings::Values values = job::default_profile().settings;
  values.set_milli(settings::Id::laser_mode, 1000);
  values.set_milli(settings::Id::pin_map, 2000);  // cut_io, with AUX OUT
  return values;
}

/// Tool 1 is 5 mm long, tool 2 is 20 mm; G54 and G28 are not at machine zero.
std::optional<BoardState> state_with(const std::string& tool_line, const std::string& selected) {
  link::BoardStatus status;
  status.state = "Idle";
  status.position = {3, 4, 5};
  std::vector<std::string> offsets{
      "[G54:1.000,2.000,-3.000]",      "[G55:10.000,0.000,0.000]",
      "[G92:0.500,0.000,0.000]",       "[TLO:0.000]",
      "[T:1|0.000,0.000,5.000|1.000]", "[T:2|0.000,0.000,20.000|3.000]",
      "[G28:-7.000,8.000,40.000]"};
  for (const char* const system : {"G56", "G57", "G58", "G59"})
    offsets.push_back(fmt::format("[{}:0.000,0.000,0.000]", system));
  if (!tool_line.empty()) offsets.push_back(tool_line);
  return program_run::parse_state(
      status, offsets, {fmt::format("[GC:G0 G54 G17 G21 G90 G94 M5 M9 T{} F0 S0]", selected)}, {});
}

std::optional<BoardState> usual_state() { return state_with("[TOOL:1]", "1"); }

Lines lines_of(const std::string& text) { return link::program_lines(text, "p.ngc"); }

std::vector<std::string> texts_of(const Lines& lines) {
  std::vector<std::string> texts;
  texts.reserve(lines.size());
  for (const link::ProgramLine& line : lines) texts.push_back(line.text);
  return texts;
}

struct Ended {
  program::State state;
  std::int64_t length_e7 = 0;
  std::uint16_t output = 0;
};

Ended run(const Lines& lines, const std::optional<BoardState>& state) {
  program::Parameters parameters;
  const program::Options options = program_run::program_options(values());
  program::Interpreter interpreter(parameters, options);
  if (state) program_run::begin_with(*state, interpreter, parameters);
  std::uint16_t output = 0;
  for (const link::ProgramLine& line : lines) {
    EXPECT_FALSE(interpreter.run(line.text)) << line.text;
    for (program::Action action; interpreter.next(action);)
      if (action.kind == program::ActionKind::output) output = action.io.level;
  }
  Ended ended{interpreter.state(), parameters.tool_length_e7, output};
  ended.state.modal.decimals = 0;  // of the words, which the approach writes in its own way
  return ended;
}

/// From each of these lines the program ends as the whole one does.
void expect_same_end(const std::string& text, const std::vector<std::size_t>& firsts,
                     const std::optional<BoardState>& state = usual_state()) {
  const Ended whole = run(lines_of(text), state);
  for (const std::size_t first : firsts) {
    const Lines part = program_run::start_at(lines_of(text), first, values(), "p.ngc", state);
    SCOPED_TRACE(fmt::format("from {}: {}", first, fmt::join(texts_of(part), " / ")));
    const Ended ended = run(part, state);
    EXPECT_EQ(ended.state.modal, whole.state.modal);
    EXPECT_EQ(ended.length_e7, whole.length_e7);
    EXPECT_EQ(ended.output, whole.output);
    for (std::size_t a = 0; a < 3; ++a)
      EXPECT_NEAR(static_cast<double>(ended.state.machine_e7[a]),
                  static_cast<double>(whole.state.machine_e7[a]), 4);
  }
}

/// The message of the error, empty without one.
template <class Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

std::string refusal(const std::string& text, std::size_t first,
                    const std::optional<BoardState>& state = usual_state()) {
  return message_of(
      [&] { program_run::start_at(lines_of(text), first, values(), "p.ngc", state); });
}

std::vector<std::string> part_of(const std::string& text, std::size_t first,
                                 const std::optional<BoardState>& state) {
  return texts_of(program_run::start_at(lines_of(text), first, values(), "p.ngc", state));
}

TEST(ProgramStart, TheToolAndItsLengthAreRestored) {
  expect_same_end("G21 G90\nT2 M6\nG0 X0 Y0 Z10\nG1 X10 F600\nX[#5400] Y[#5403]\nG43\nG0 Z10\nX5\n",
                  {2, 3, 4, 5, 6, 7, 8});
  expect_same_end("G0 X0 Y0\nT2 M6\nG0 X0 Y0 Z0\nG41\nG1 X10 F600\nX20\nG40\nG0 X30\nG1 X31\n",
                  {3, 4, 9});
  expect_same_end("G0 X0 Y0 Z0\nT2\nX1\nX#<_selected_tool>\nM6\nX3\nT1\nX4 Y#5400\n",
                  {2, 3, 4, 5, 6, 7, 8});
  expect_same_end("G0 X0 Y0 Z0\nM61 Q2\nG43 H1\nG43.2 H2\nZ1\nG20 G43.1 Z1\nZ1\nG49\nG0 Z0\n",
                  {3, 4, 5, 6, 7, 8, 9});
}

TEST(ProgramStart, AToolChangeIsAskedForOnlyIfTheToolDiffers) {
  const std::string text = "G21 G90\nT2 M6\nG43 H2\nG0 Z10\nT1\nX1\n";
  const auto asked = part_of(text, 6, usual_state());
  EXPECT_THAT(asked, Contains("T2 M6"));
  EXPECT_THAT(asked, Contains("T1"));
  EXPECT_THAT(asked, Contains("G43 H2"));
  const auto loaded = part_of(text, 6, state_with("[TOOL:2]", "1"));
  EXPECT_THAT(loaded, Not(Contains(HasSubstr("M6"))));
  EXPECT_THAT(loaded, Contains("G43 H2"));
  EXPECT_THAT(part_of(text, 6, state_with("", "2")), Contains("T2 M6"));
}

/// At M6 the operator may touch off, which the lines do not say.
TEST(ProgramStart, ALengthBeforeAChangeOfToolsIsNotTakenForTheLengthAfterIt) {
  const std::string text = "G43 H1\nG0 X1 Z9\nT2 M6\nX2\nG43 H2\nX3\n";
  EXPECT_THAT(refusal(text, 4), HasSubstr("p.ngc:4: the tool length after the M6"));
  expect_same_end(text, {2, 3, 6});
  expect_same_end("G49\nG0 X1 Z9\nT2 M6\nX2\nX3\n", {2, 3, 4, 5});
}

TEST(ProgramStart, AnUnknownToolIsNotGuessed) {
  const auto unknown = state_with("", "2");
  ASSERT_TRUE(unknown);
  EXPECT_FALSE(unknown->loaded_tool);
  EXPECT_EQ(state_with("", "0")->loaded_tool, 0u);
  EXPECT_EQ(state_with("[TOOL:1]", "2")->loaded_tool, 1u);
  const auto is_refused = [&](const std::string& line, const std::string& use) {
    const std::string what =
        use + " needs the tool in the spindle, which the board does not report";
    EXPECT_THAT(refusal("G0 X0 Y0 Z0\n" + line + "\nX1\n", 3, unknown), HasSubstr(what));
    const auto flow = [&](const std::string& before) {
      return message_of([&] {
        program_run::run_flow(lines_of(before + "o1 if [1]\n" + line + "\no1 endif\n"), "p.ngc",
                              values(), unknown);
      });
    };
    EXPECT_THAT(flow(""), HasSubstr(what));
    EXPECT_EQ(flow("M61 Q1\n").find(what), std::string::npos);
  };
  is_refused("G43", "G43");
  is_refused("G41", "G41");
  is_refused("X#5400", "#5400");
  is_refused("x # 5403", "#5403");
  is_refused("x#< _CURRENT_Tool >", "#<_CURRENT_TOOL>");
  EXPECT_EQ(refusal("G0 X0 Y0 Z0\nG43 H2\nX1\n", 3, unknown), "");
}

/// The tool that is chosen for the next M6 is not the one in the spindle.
TEST(ProgramStart, ValuesAreThoseOfTheToolInTheSpindle) {
  const auto state = state_with("[TOOL:1]", "2");
  const auto lines = program_run::run_flow(
      lines_of("G43\no1 if [#5400 EQ 1]\nG0 X#5400 Y#5403 Z#<_selected_tool>\no1 endif\n"), "p.ngc",
      values(), state);
  EXPECT_THAT(texts_of(lines), Contains("G0X1Y5Z2"));
}

TEST(ProgramStart, ALoadedToolMayBeMissingInTheTable) {
  const auto state = state_with("[TOOL:9]", "9");
  EXPECT_EQ(run({}, state).state.modal.loaded_tool, 9);
  EXPECT_EQ(run({}, state).state.modal.tool, 9u);
}

/// The first lines of CAM programs, and what is over before the line.
TEST(ProgramStart, WhatIsOverOrHasNoEffectMayBeLeftOut) {
  const std::string begin = "G21 G90 G17 G40 G49 G80 G94 G15 G50 G69 G97 M48\nG0 X0 Y0 Z5\n";
  for (const std::string over : {"G43.1 Z2",
                                 "G54.1 P1",
                                 "G28",
                                 "G91 G28 Z0\nG90",
                                 "G53 G0 X1 Z2",
                                 "G30 X3",
                                 "M49",
                                 "G81 X1 Z-1 R1 F100\nX2\nG80",
                                 "G85 X1 Z-1 R1 F100",
                                 "G86 X1 Z-1 R1 P0.1 F100",
                                 "G89 X1 Z-1 R1 P0.1 F100",
                                 "G68 X0 Y0 R90\nG0 X1 Y1\nG69",
                                 "G92.1",
                                 "G92.2",
                                 "G5.2 P1 L3 F600\nX0 Y10 P1\nX20 Y10 P1\nX20 Y0\nG5.3",
                                 "G41.1 D1\nG1 X9 F100\nG40\nG0 X0",
                                 "G42 D1\nG1 X9 F100\nY9\nG40\nG0 X0",
                                 "M61 Q2",
                                 "M70\nG91\nM72\nM71",
                                 "M130 P0\nG1 X1 F100\nM131",
                                 "M62 P0",
                                 "M64 P0",
                                 "M67 E0 Q25\nG1 X1 F100",
                                 "M68 E0 Q50",
                                 "M117 Hello G10 X5",
                                 "M126 P1\nM127 P20\nM128 P50",
                                 "M3 S5\nM30\nG90",
                                 "M0",
                                 "M60",
                                 "G20\nM127 P20\nM126 P0"}) {
    SCOPED_TRACE(over);
    const std::string text = begin + over + "\nG0 X3 Y4\nZ6 F200\n";
    const std::size_t last = lines_of(text).back().number;
    expect_same_end(text, {last - 1, last});
  }
}

TEST(ProgramStart, WhatCannotBeRestoredIsRefused) {
  const std::string begin = "G21 G90 G0 X0 Y0 Z5\n";
  for (const std::string code : {"G10 L2 P1 X1", "G92 X0", "G92.3", "G28.1", "G30.1",
                                 "G38.2 Z-1 F100", "M66 P0 L0", "M101"}) {
    const std::string word = code.substr(0, code.find(' '));
    EXPECT_THAT(refusal(begin + code + "\nG0 X1\n", 3),
                HasSubstr("p.ngc:2: --from cannot leave '" + word + "' out"));
  }
  EXPECT_THAT(refusal(begin + "X#5061\nG0 X1\n", 3), HasSubstr("p.ngc:2: #5061 is not known"));
  EXPECT_THAT(refusal(begin + "G43 H[1+1]\nG0 X1\n", 3), HasSubstr("p.ngc:2: --from cannot"));
}

/// The remedy of the refusal leads to lines at which the program begins.
TEST(ProgramStart, WhatMustBeginAsAWholeNamesItsEnds) {
  struct Case {
    std::string text, what;
    std::vector<std::size_t> refused, accepted;
  };
  for (const Case& c : std::initializer_list<Case>{
           {"G0 X0 Y0 Z5\nG41 D1\nG1 X9 F100\nY9\nG40\nZ9\nX0\nX3\n",
            "continues a path with cutter compensation",
            {3, 4, 5, 6, 7},
            {2, 8}},
           {"G0 X0 Y0\nG5.2 P1 L3 F600\nX0 Y10 P1\nX20 Y10 P1\nX20 Y0\nG5.3\nG0 X1\n",
            "is within a NURBS",
            {3, 4, 5, 6},
            {2, 7}},
           {"G0 X0 Y0\nG68 X1 Y0 R45\nX3 Y2\nG69\nX1\n", "is within a rotation", {3, 4}, {2, 5}},
           {"G0 X0 Y0\nM130 P0\nG1 X1 F100\nM131\nX1\n", "is within points", {3, 4}, {2, 5}},
           {"G0 X0 Y0\nM70\nG91\nM72\nM71\nX1\n", "may restore modes", {3, 4, 5}, {2, 6}},
           {"G0 X0 Y0 Z0\nG81 X1 Z-1 R1 F100\nX2\nS5\nX3\nG80\nG0 X4\nG0 X5\n",
            "continues a curve or cycle",
            {3, 4, 5},
            {2, 6, 7, 8}},
           {"G0 X0 Y0\nM30\nX1 F100\nG0 X2\n",
            "continues G1, for which no feed is in force",
            {3},
            {2, 4}}}) {
    SCOPED_TRACE(c.text);
    for (const std::size_t first : c.refused)
      EXPECT_THAT(refusal(c.text, first), HasSubstr(c.what)) << first;
    for (const std::size_t first : c.accepted) EXPECT_EQ(refusal(c.text, first), "") << first;
  }
}

/// One coordinate of a rotated plane alone does not say where the machine is after the rotation.
TEST(ProgramStart, AxesWhosePlaceIsLostAreNotMoved) {
  const std::string what = "the position of X before this line is not known";
  EXPECT_THAT(refusal("G68 X0 Y0 R30\nG0 X1\nG69\nG0 Z1\nX2 Y2\nX3\n", 4), HasSubstr(what));
  EXPECT_EQ(refusal("G68 X0 Y0 R30\nG0 X1\nG69\nG0 Z1\nX2 Y2\nX3\n", 6), "");
  // Without the offsets of the board no place of the machine has coordinates.
  EXPECT_THAT(refusal("G0 X1\nG55\nY1\nX1\nX3\n", 3, {}), HasSubstr(what));
  EXPECT_EQ(refusal("G0 X1\nG55\nY1\nX1\nX3\n", 5, {}), "");
  EXPECT_THAT(refusal("G0 X1\nG28\nG0 Y1\n", 3, {}), HasSubstr(what));
  EXPECT_THAT(refusal("G0 X1\nG53 X2\nG0 Y1\n", 3, {}), HasSubstr(what));
  EXPECT_THAT(refusal("G0 Z1\nG49\nG0 Y1\n", 3, {}), HasSubstr("the position of Z before"));
  EXPECT_EQ(refusal("G49 G54\nG0 Z1 X1 Y1\nG0 Y1\n", 3, {}), "");
}

}  // namespace
}  // namespace lamplock::test::program_start
