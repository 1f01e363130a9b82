// The table [pendant] of a machine profile, and the lines allowed in macros.
#include "host/job/read_profile.hpp"
#include "host/pendant/read_key_map.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "host/job/profile.hpp"
#include "tests/error_of.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::pendant {
namespace {

using test::error_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

KeyMap read(const std::string& text) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("m.toml", text);
  job::read_profile(file);  // which ignores this table
  return read_key_map(file);
}
std::string error(const std::string& text) {
  return error_of([&text] { read(text); });
}

TEST(KeyMap, contains_the_stated_changes) {
  const KeyMap map = read(R"toml(
axes = 3
[pendant]
steps = [1, 0.01]
feed = 1200
safe_z = -5.5
hb04_keys = 16
[pendant.keys]
macro-1 = "touch"
stop = "reset"
[pendant.keyboard]
p = "touch"
f5 = "home"
[pendant.macros.touch]
lines = ["G91 G38.2 Z-20 F100 (slowly!)", "G90"]
[pendant.macros.red]
lines = ["M3 S5"]
laser = true
)toml");
  EXPECT_THAT(map.steps_mm, ElementsAre(0.01, 1));
  EXPECT_EQ(map.feed_mm_min, 1200);
  EXPECT_EQ(map.safe_z_mm, -5.5);
  EXPECT_EQ(map.hb04_keys, 16);
  EXPECT_EQ(map.keys.at(Key::stop), (Binding{Action::reset, {}}));
  EXPECT_EQ(map.keys.at(Key::start), (Binding{Action::start_pause, {}}));
  EXPECT_EQ(map.keyboard.at("f5"), (Binding{Action::home, {}}));
  const auto touch = map.keyboard.at("p").macro;
  ASSERT_TRUE(touch);
  EXPECT_EQ(map.keys.at(Key::macro_1).macro, touch);
  EXPECT_THAT(map.macros.at(*touch).lines, ElementsAre("G91 G38.2 Z-20 F100", "G90"));
}

TEST(KeyMap, without_a_table_is_the_default) {
  const KeyMap map = read("axes = 3\n");
  EXPECT_EQ(map.keys, default_key_map().keys);
  EXPECT_EQ(map.keyboard, default_key_map().keyboard);
  EXPECT_EQ(map.keys.count(Key::spindle), 0u);
  EXPECT_EQ(map.keys.count(Key::macro_1), 0u);
}

TEST(KeyMap, refuses_unknown_keys) {
  EXPECT_THAT(error("pendant = 3\n"), HasSubstr("m.toml:1: 'pendant' must be a table"));
  EXPECT_THAT(error("[pendant]\nfed = 3\n"), AllOf(HasSubstr(":2:"), HasSubstr("'fed'")));
  EXPECT_THAT(error("[pendant.keys]\nstopp = \"stop\"\n"), HasSubstr("'stopp'"));
  EXPECT_THAT(error("[pendant.keys]\nstop = \"halt\"\n"), HasSubstr("no macro 'halt'"));
  EXPECT_THAT(error("[pendant.keys]\nstop = 1\n"), HasSubstr("must be a text"));
  EXPECT_THAT(error("[pendant.keyboard]\nf13 = \"stop\"\n"), HasSubstr("'f13'"));
  EXPECT_THAT(error("[pendant.keyboard]\n\"\\n\" = \"stop\"\n"),
              HasSubstr("a keyboard has no key"));
  EXPECT_THAT(error("[pendant]\nsteps = []\n"), HasSubstr("'steps'"));
  EXPECT_THAT(error("[pendant]\nsteps = [0]\n"), HasSubstr("out of range"));
  EXPECT_THAT(error("[pendant]\nsteps = [\"1\"]\n"), HasSubstr("must be a number"));
  EXPECT_THAT(error("[pendant]\nfeed = nan\n"), HasSubstr("must be a number"));
  EXPECT_THAT(error("[pendant]\nfeed = -1\n"), HasSubstr("out of range"));
  EXPECT_THAT(error("[pendant]\nhb04_keys = 17\n"), HasSubstr("neither 16 nor 18"));
  EXPECT_THAT(error("[pendant.macros]\nstop = 3\n"), HasSubstr("name of an action"));
  EXPECT_THAT(error("[pendant.macros]\nx = 3\n"), HasSubstr("needs lines"));
  EXPECT_THAT(error("[pendant.macros.x]\nlines = [\"G90\"]\nlight = true\n"),
              HasSubstr("a macro has no key 'light'"));
  EXPECT_THAT(error("[pendant\n"), HasSubstr("m.toml:1"));
}

/// In every form that a board accepts.
TEST(Macro, lights_no_laser_without_permission) {
  for (const char* line : {"M3", "m03", "M 4", "G1X1 S100", "G1 X1 s 1", "M(x)3", "M62 P0",
                           "M68 E0 Q1", "M130 P0", "G1 X3 M3", "M3.0", "G1 X30 S10:20*5", "M[1+2]",
                           "#1=3 M#1", "M128 P5", "M6", "G1 X1 /M3", "\tM00003"}) {
    EXPECT_FALSE(laser_word(line).empty()) << line;
    EXPECT_THAT(error(fmt::format("[pendant.macros.x]\nlines = ['{}']\n", line)),
                AllOf(HasSubstr(":2: "), HasSubstr("may turn on a laser")))
        << line;
    EXPECT_EQ(
        read(fmt::format("[pendant.macros.x]\nlines = ['{}']\nlaser = true\n", line)).macros.size(),
        1u)
        << line;
  }
  for (const char* line :
       {"G1 X1 F100", "M5", "m 5", "G38.2 Z-1 F10 (M3)", "M8 ; M3 S1", "M0", "G4 P1"})
    EXPECT_EQ(laser_word(line), "") << line;
}

TEST(Macro, changes_no_settings_of_the_board) {
  for (const char* line : {"$32=1", "$N0=M3 S1", "$RST=*", "$BOOT", "$C", "$I", "$SLP"})
    EXPECT_THAT(error(fmt::format("[pendant.macros.x]\nlines = ['{}']\nlaser = true\n", line)),
                HasSubstr("not valid in a macro"));
  for (const char* line : {"$H", "$hz", "$X", "$J=G91 X1 F100"})
    EXPECT_EQ(macro_line(line, false, "x"), line);
  EXPECT_THAT(error_of([] { macro_line("G1 X1 !", false, "x"); }), HasSubstr("0x21"));
  EXPECT_THAT(error_of([] { macro_line(std::string(79, '0'), true, "x"); }), HasSubstr("too long"));
}

TEST(Actions, have_names_that_are_found) {
  for (const ActionRow& row : action_rows()) {
    EXPECT_EQ(action_named(row.name), row.action);
    EXPECT_FALSE(row.about.empty());
  }
  EXPECT_FALSE(action_named(""));
}

}  // namespace
}  // namespace lamplock::pendant
