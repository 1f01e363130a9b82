// Lines that begin with "$" as people type them: spaces, case and comments change nothing.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "tests/board/program_host.hpp"

namespace lamplock::test::system_lines_test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using Lines = std::vector<std::string>;

job::Profile profile() {
  job::Profile profile = lamp_profile(100, settings::LampMode::free_beat);
  profile.settings.set_milli(Id::laser_mode, 1000);
  return profile;
}

/// Everything that the board says to a line, and to a status after it.
Lines said_to(std::string_view line) {
  Rig rig(profile());
  ProgramHost host(rig);
  Lines lines = host.ask(std::string(line) + "\n", 3);
  host.run_ms(100);
  const Lines state = host.ask("$30\n$G\n$#\n$N\n$I\n");
  lines.insert(lines.end(), state.begin(), state.end());
  lines.push_back(host.status());
  return lines;
}

/// The line with other letters, spaces and comments outside of its text.
std::string varied(const std::string& line, std::mt19937& random) {
  const bool has_text = line.starts_with("$I=") || line.starts_with("$N0=");
  const std::size_t name = has_text ? line.find('=') + 1 : line.size();
  std::string text;
  const auto blanks = [&] {
    static constexpr std::array<std::string_view, 5> all{"", "", " ", "\t", "  "};
    text += all[random() % all.size()];
  };
  blanks();
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (i >= name) {
      text += line[i];
      continue;
    }
    const char c = line[i];
    text += random() % 2 == 0 ? c : static_cast<char>(std::tolower(c));
    if (i + 1 == name) break;
    blanks();
    if (i > 0 && random() % 8 == 0) text += "(an (aside)";
  }
  for (std::size_t i = name; i < line.size(); ++i) text += line[i];
  if (!has_text && random() % 3 == 0) text += random() % 2 == 0 ? " ; $X" : "(end";
  return text;
}

TEST(SystemLines, SpacesCaseAndCommentsChangeNothing) {
  std::mt19937 random(1);
  for (const std::string line : {"$",
                                 "$$",
                                 "$G",
                                 "$I",
                                 "$N",
                                 "$#",
                                 "$X",
                                 "$H",
                                 "$HX",
                                 "$C",
                                 "$SLP",
                                 "$30=500",
                                 "$110=1234.5",
                                 "$999=1",
                                 "$30=",
                                 "$RST=$",
                                 "$RST=#",
                                 "$RST=*",
                                 "$RST=P",
                                 "$RST=Q",
                                 "$I=My Laser (2)",
                                 "$N0=G54 (first) G90",
                                 "$N0=",
                                 "$J=G91 X5 F600",
                                 "$J=X1",
                                 "$Q",
                                 "$BOOT=1"}) {
    const Lines plain = said_to(line);
    for (int i = 0; i < scaled(20, 4); ++i) {
      const std::string typed = varied(line, random);
      ASSERT_EQ(said_to(typed), plain) << typed;
    }
  }
}

TEST(SystemLines, CommentsDoNotCountTowardsTheLengthOfALine) {
  Rig rig(profile());
  ProgramHost host(rig);
  const std::string comment(300, 'c');
  EXPECT_THAT(host.ask(fmt::format("G21 ({}) G90 ({})\n", comment, comment)), ElementsAre("ok"));
  EXPECT_THAT(host.ask(fmt::format("G20 ;{}(\n", comment)), ElementsAre("ok"));
  EXPECT_THAT(host.ask(fmt::format("$30=400 ({}\n", comment)), ElementsAre("ok"));
  EXPECT_THAT(host.ask("$$\n"), Contains("$30=400"));
  EXPECT_THAT(host.ask(fmt::format("({}) G1{:260}F100\n", comment, "")), ElementsAre("error:11"));
  EXPECT_THAT(host.ask("G21\n"), ElementsAre("ok"));
}

/// Senders for grblHAL write $10=511; what its further bits ask for is always reported.
TEST(SystemLines, TheReportMaskOfGrblHalIsAccepted) {
  Rig rig(profile());
  ProgramHost host(rig);
  EXPECT_THAT(host.ask("$10=511\n$10=512\n"), ElementsAre("ok", "error:52"));
  EXPECT_THAT(host.ask("$$\n"), Contains("$10=511"));
  EXPECT_THAT(host.status(), AllOf(HasSubstr("|MPos:"), HasSubstr("|Bf:"), HasSubstr("|FS:")));
  host.ask("$10=508\n");
  EXPECT_THAT(host.status(), AllOf(HasSubstr("|WPos:"), Not(HasSubstr("|Bf:"))));
}

TEST(SystemLines, TheAlarmOfASoftLimitComesBeforeItsError) {
  Rig rig(profile());
  ProgramHost host(rig);
  EXPECT_THAT(host.ask("G0 X999\n"), ElementsAre("ALARM:2", "error:33"));
}

TEST(SystemLines, AToolLengthThatSurvivesAResetIsSaid) {
  Rig rig(profile());
  ProgramHost host(rig);
  host.ask("G43.1 Z1.25\n");
  host.send(std::uint8_t{0x18});
  host.run_ms(20);
  EXPECT_THAT(host.said(),
              Contains("[MSG:Tool length offset 1.250 mm is active: G49 ends it]").Times(1));
  host.ask("G49\n");
  host.send(std::uint8_t{0x18});
  host.run_ms(20);
  EXPECT_THAT(host.said(), Contains(testing::HasSubstr("Tool length")).Times(1));
}

}  // namespace
}  // namespace lamplock::test::system_lines_test
