// Each event in each state of each activity, by bytes, frames and pins: the states that the machine
// passes through are those of the table below.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <sstream>

#include "tests/board/bench.hpp"
#include "tests/scale.hpp"

namespace lamplock::test::state_table_test {
namespace {

using machine::Activity;
using machine::State;

/// A state in one or two letters: its own, and that of the activity.
std::string letters(const machine::Machine& machine) {
  static constexpr std::string_view of_state = "ICZAERHDSTX", of_activity = " prgjh";
  std::string text(1, of_state.at(static_cast<std::size_t>(machine.state())));
  if (machine.activity() != Activity::none)
    text += of_activity.at(static_cast<std::size_t>(machine.activity()));
  if (machine.state() == State::alarm) text += std::to_string(machine.alarm());
  return text;
}

struct Cell {
  std::string_view name;
  std::string_view letters;  ///< of its state
  std::function<void(Bench&)> reach;
  bool parking = false;
};

void type(Bench& bench, std::string_view lines, int ms) {
  bench.type(lines);
  bench.pass(ms * ps_per_ms);
}
void job(Bench& bench, void (*begin)(Bench&), int ms = 300) {
  begin(bench);
  bench.pass(ms * ps_per_ms);
}
void byte(Bench& bench, std::uint8_t value, int ms = 2) {
  bench.board().write({&value, 1});
  bench.pass(ms * ps_per_ms);
}
void door(Bench& bench, int ms = 2) {
  bench.door(true);
  bench.pass(ms * ps_per_ms);
}
void stop(Bench& bench) {
  bench.command(wire::Command::stop);
  bench.pass(2 * ps_per_ms);
}

constexpr std::string_view move = "M3 S500\nG1 X45 F3000\n", jog = "$J=X45 F3000\n";

const std::vector<Cell>& cells() {
  static const std::vector<Cell> all{
      {"power-up", "I", [](Bench& b) { b.pass(10 * ps_per_ms); }},
      {"idle", "I", [](Bench& b) { type(b, "G1 X1 F3000\n", 300); }},
      {"check", "C", [](Bench& b) { type(b, "$C\nG1 X5 F3000\n", 5); }},
      {"sleep", "Z", [](Bench& b) { type(b, "$SLP\n", 5); }},
      {"alarm", "A2", [](Bench& b) { type(b, "G1 X99 F3000\n", 5); }},
      {"e-stop", "E",
       [](Bench& b) {
         b.set(sim::Pin::estop, true);
         b.pass(5 * ps_per_ms);
       }},
      {"held at rest", "H", [](Bench& b) { byte(b, '!'); }},
      {"door at rest", "D", [](Bench& b) { byte(b, door_byte); }},
      {"points", "Rp", [](Bench& b) { job(b, begin_points); }},
      {"rows", "Rr", [](Bench& b) { job(b, begin_rows); }},
      {"program", "Rg", [](Bench& b) { type(b, move, 300); }},
      {"jog", "Rj", [](Bench& b) { type(b, jog, 300); }},
      {"homing", "Rh", [](Bench& b) { type(b, "$H\n", 300); }},
      {"held points", "Hp",
       [](Bench& b) {
         job(b, begin_points);
         byte(b, '!', 300);
       }},
      {"held rows", "Hr",
       [](Bench& b) {
         job(b, begin_rows);
         byte(b, '!', 300);
       }},
      {"held program", "Hg",
       [](Bench& b) {
         type(b, move, 300);
         byte(b, '!', 300);
       }},
      {"M0", "Hg", [](Bench& b) { type(b, "G1 X1 F3000\nM0\nG1 X9\n", 300); }},
      {"door in points", "Dp",
       [](Bench& b) {
         job(b, begin_points);
         door(b, 300);
       }},
      {"door in rows", "Dr",
       [](Bench& b) {
         job(b, begin_rows);
         door(b, 300);
       }},
      {"door in a program", "Dg",
       [](Bench& b) {
         type(b, move, 300);
         door(b, 300);
       }},
      {"parking", "Dg",
       [](Bench& b) {
         type(b, move, 300);
         door(b, 150);
       },
       true},
      {"stopping points", "Sp",
       [](Bench& b) {
         job(b, begin_points);
         b.host_step = nullptr;
         stop(b);
       }},
      {"stopping rows", "Sr",
       [](Bench& b) {
         job(b, begin_rows);
         b.host_step = nullptr;
         stop(b);
       }},
      {"stopping program", "Sg",
       [](Bench& b) {
         type(b, move, 300);
         stop(b);
       }},
      {"stopping jog", "Sj",
       [](Bench& b) {
         type(b, jog, 300);
         byte(b, jog_cancel_byte);
       }},
      {"stopping homing", "Sh",
       [](Bench& b) {
         type(b, "$H\n", 300);
         byte(b, '!');
       }},
      {"reset of points", "Tp",
       [](Bench& b) {
         job(b, begin_points);
         b.host_step = nullptr;
         stop(b);
         byte(b, reset_byte);
       }},
      {"reset of a program", "Xg",
       [](Bench& b) {
         type(b, move, 300);
         byte(b, reset_byte);
       }},
      {"reset of a jog", "Xj",
       [](Bench& b) {
         type(b, jog, 300);
         byte(b, reset_byte);
       }},
      {"reset of homing", "Xh",
       [](Bench& b) {
         type(b, "$H\n", 300);
         byte(b, reset_byte);
       }},
  };
  return all;
}

struct Cause {
  std::string_view name;
  std::function<void(Bench&)> make;
};

void begin_job(Bench& bench) {
  const job::Job job = job::make_job({{1, 0, 0}, {2, 0, 0}}, bench.profile, {});
  bench.board().controller().on_begin(job::header_from(job, 0));
}

const std::vector<Cause>& causes() {
  static const auto typed = [](std::string_view line) {
    return [line](Bench& b) { b.type(line); };
  };
  static const auto real_time = [](std::uint8_t value) {
    return [value](Bench& b) { b.board().write({&value, 1}); };
  };
  static const auto frame = [](wire::Command value) {
    return [value](Bench& b) { b.command(value); };
  };
  static const auto set = [](sim::Pin changed, bool level) {
    return [changed, level](Bench& b) { b.set(changed, level); };
  };
  static const std::vector<Cause> all{
      {"0x18", real_time(reset_byte)},
      {"!", real_time('!')},
      {"~", real_time('~')},
      {"0x84", real_time(door_byte)},
      {"0x85", real_time(jog_cancel_byte)},
      {"hold", frame(wire::Command::hold)},
      {"resume", frame(wire::Command::resume)},
      {"stop", frame(wire::Command::stop)},
      {"begin", begin_job},
      {"line", typed("G1 X3 F3000\n")},
      {"M0", typed("M0\n")},
      {"jog", typed("$J=X3 F3000\n")},
      {"$H", typed("$H\n")},
      {"$X", typed("$X\n")},
      {"$SLP", typed("$SLP\n")},
      {"$C", typed("$C\n")},
      {"opened", set(sim::Pin::door, true)},
      {"shut", set(sim::Pin::door, false)},
      {"limit", set(sim::Pin::limit_y, true)},
      {"estop", set(sim::Pin::estop, true)},
      {"released", set(sim::Pin::estop, false)},
      {"gone",
       [](Bench& b) {
         b.host_step = nullptr;
         b.board().set_host_present(false);
       }},
  };
  return all;
}

/// The states after the event, in order; "=" if it changes nothing in 0.4 s but what would have
/// come without it.
std::string passed(const Cell& cell, const Cause* cause) {
  Bench bench(cell.parking, cell.name != "power-up");
  cell.reach(bench);
  const machine::Machine& machine = bench.board().controller().machine();
  std::string last = letters(machine), path;
  EXPECT_EQ(last, cell.letters) << cell.name;
  if (cause != nullptr) cause->make(bench);
  for (int i = 0; i < 1600; ++i) {
    bench.pass(ps_per_ms / 4);
    const std::string now = letters(machine);
    if (now == last) continue;
    path += (path.empty() ? "" : ">") + now;
    last = now;
  }
  return path;
}

std::string entry(const std::string& path, const std::string& without) {
  if (path == without) return "=";
  return path.empty() ? "." : path;
}

constexpr std::string_view table = R"(
                    0x18     !        ~        0x84     0x85     hold     resume   stop     begin    line     M0       jog      $H       $X       $SLP     $C       opened   shut     limit    estop    released gone     
power-up            =        H        =        D        =        =        =        =        Rp       Rg>I     Hg       Rj>I     Rh       =        Z        C        =        =        A1       E        =        =        
idle                =        H        =        D        =        H        =        =        Rp       Rg>I     Hg       Rj>I     Rh       =        Z        C        =        =        A1       E        =        =        
check               I        =        =        =        =        =        =        =        =        =        =        =        =        =        Z        I        =        =        A1       E        =        =        
sleep               A3       =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        E        =        =        
alarm               =        =        =        =        =        =        =        =        =        =        =        =        Rh       I        Z        =        =        =        =        E        =        =        
e-stop              =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        A10      =        
held at rest        I        =        I        D        =        =        I        I        =        Hg       Hg       =        =        =        =        =        D        =        A1       E        =        =        
door at rest        I        =        I        =        =        =        I        I        =        Dg       Dg       =        =        =        =        =        =        =        A1       E        =        =        
points              Hp>Sp>I  Hp       =        Hp       =        Hp       =        Sp>I     =        =        =        =        =        =        =        =        Dp       =        A1       E        =        Hp       
rows                Sr>I     Hr       =        Hr       =        Hr       =        Sr>I     =        =        =        =        =        =        =        =        Dr       =        A1       E        =        Hr       
program             Xg>A3    Hg       =        Dg       =        Hg       =        Sg>I     =        =        =        =        =        =        =        =        Dg       =        A1       E        =        Hg       
jog                 Xj>A3    Sj>I     =        Sj>I     Sj>I     Sj>I     =        Sj>I     =        =        =        =        =        =        =        =        Sj>I     =        A1       E        =        Sj>I     
homing              Xh>A6    Sh>A6    =        Sh>A7    Sh>A6    Sh>A6    =        Sh>A6    =        =        =        =        =        =        =        =        Sh>A7    =        =        E        =        =        
held points         I        =        Rp>I     =        =        =        Rp>I     I        =        =        =        =        =        =        =        =        Dp       =        A1       E        =        =        
held rows           Sr>I     =        Rr       =        =        =        Rr       Sr>I     =        =        =        =        =        =        =        =        Dr       =        A1       E        =        =        
held program        I        =        Rg       Dg       =        =        Rg       Sg>I     =        =        =        =        =        =        =        =        Dg       =        A1       E        =        =        
M0                  I        =        Rg>I     Dg       =        =        Rg>I     I        =        =        =        =        =        =        =        =        Dg       =        A1       E        =        =        
door in points      I        =        =        =        =        =        =        I        =        =        =        =        =        =        =        =        =        Hp       A1       E        =        =        
door in rows        Sr>I     =        =        =        =        =        =        Sr>I     =        =        =        =        =        =        =        =        =        Hr       A1       E        =        =        
door in a program   I        =        =        =        =        =        =        Sg>I     =        =        =        =        =        =        =        =        =        =        A1       E        =        =        
parking             Xg>A3    =        =        =        =        =        =        Sg>I     =        =        =        =        =        =        =        =        =        =        A1       E        =        =        
stopping points     Tp>I     =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        A1       E        =        =        
stopping rows       Tr>I     =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        A1       E        =        =        
stopping program    Xg>A3    =        =        =        =        =        =        =        =        =        =        Rj>I     Rh       =        Z        C        =        =        A1       E        =        =        
stopping jog        Xj>A3    =        =        =        =        =        =        =        =        Rg>I     Hg       Rj>I     Rh       =        Z        C        =        =        A1       E        =        =        
stopping homing     Xh>A6    =        =        =        =        =        =        =        =        =        =        =        Rh       I        Z        =        =        =        =        E        =        =        
reset of points     =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        A1       E        =        =        
reset of a program  =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        A1       E        =        =        
reset of a jog      =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        A1       E        =        =        
reset of homing     =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        =        E        =        =        
)";

/// The entry of the table in a row of cells() and a column of causes().
std::string expected_entry(std::size_t row, std::size_t column) {
  constexpr std::size_t name_width = 20, width = 9;
  std::size_t begin = 1;
  for (std::size_t line = 0; line <= row; ++line) begin = table.find('\n', begin) + 1;
  const std::string_view text = table.substr(begin + name_width + width * column, width);
  return std::string(text.substr(0, text.find(' ')));
}

TEST(StateTable, EachEventInEachStateOfEachActivity) {
  std::string seen = fmt::format("\n{:<20}", "");
  for (const Cause& cause : causes()) seen += fmt::format("{:<9}", cause.name);
  seen += "\n";
  for (std::size_t row = 0; row < cells().size(); ++row) {
    const Cell& cell = cells()[row];
    const std::string without = passed(cell, nullptr);
    seen += fmt::format("{:<20}", cell.name);
    for (std::size_t column = 0; column < causes().size(); ++column) {
      const bool tries = test::tries_cell(row * causes().size() + column);
      seen += fmt::format("{:<9}", tries ? entry(passed(cell, &causes()[column]), without)
                                         : expected_entry(row, column));
    }
    seen += "\n";
  }
  EXPECT_EQ(seen, table);
}

}  // namespace
}  // namespace lamplock::test::state_table_test
