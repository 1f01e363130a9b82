// A stopped program names the part with which its command begins again, not a line.
#include <gmock/gmock.h>

#include <string>

#include "host/job/profile.hpp"
#include "host/run/run_program.hpp"
#include "host/run/sent_program.hpp"
#include "tests/run/silent_frontend.hpp"

namespace lamplock::test::program_parts_test {
namespace {

class Listener : public SilentFrontend {
 public:
  void notice(const std::string& text) override { text_ += text; }
  const std::string& shown() const { return text_; }

 private:
  std::string text_;
};

std::string notice_at(std::size_t line, const run::ProgramParts& parts, bool has_flow = false) {
  run::ProgramOutcome outcome{"twelve.dxf", 60};
  outcome.result.end = link::LineEnd::stopped;
  outcome.result.last_line = 40;
  outcome.result.at_line = line;
  outcome.parts = parts;
  outcome.has_flow = has_flow;
  Listener listener;
  EXPECT_EQ(run::judge_program(outcome, "virtual", listener), Exit::interrupted);
  return listener.shown();
}

TEST(ProgramParts, TheRemedyCountsThem) {
  // The cuts 4, 5 and 6 of a plan, after a begin of three lines.
  const run::ProgramParts cuts{"cut", {4, 12, 20}, {4, 5, 6}};
  const auto names = [&](std::size_t line, int cut) {
    const std::string text = notice_at(line, cuts), number = std::to_string(cut);
    EXPECT_THAT(text, testing::HasSubstr("cut " + number + " was under way"));
    EXPECT_THAT(text, testing::HasSubstr("--from " + number + " begins with it"));
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("line")));
  };
  for (const std::size_t line : {1u, 4u, 11u}) names(line, 4);
  for (const std::size_t line : {12u, 19u}) names(line, 5);
  for (const std::size_t line : {20u, 60u}) names(line, 6);
  EXPECT_THAT(notice_at(0, cuts), testing::HasSubstr("one of cut 6"));
}

TEST(ProgramParts, ALineIsNamedWithItsRemedyWhereItCanBegin) {
  for (const bool has_flow : {false, true}) {
    const std::string text = notice_at(8, {}, has_flow);
    EXPECT_THAT(text, testing::HasSubstr("line 8 of twelve.dxf was under way"));
    EXPECT_EQ(text.find("--from 8 begins with it") == std::string::npos, has_flow) << text;
  }
}

TEST(ProgramParts, ALineWithWhichTheProgramCannotBeginIsNotARemedy) {
  run::ProgramOutcome outcome{"part.ngc", 60};
  outcome.result.end = link::LineEnd::stopped;
  outcome.result.last_line = outcome.result.at_line = 3;
  const run::ProgramText text{"part.ngc", "G21 G90\nG10 L2 P1 X1\nG0 X1 Y1\nX2\n", {}};
  outcome.from_refusal = run::from_refusal(text, 3, job::default_profile().settings, {});
  Listener listener;
  EXPECT_EQ(run::judge_program(outcome, "virtual", listener), Exit::interrupted);
  EXPECT_THAT(listener.shown(),
              testing::HasSubstr("--from 3 cannot begin with it (part.ngc:2: --from cannot leave "
                                 "'G10' out; begin at this line or before it)"));
  EXPECT_EQ(run::from_refusal(text, 2, job::default_profile().settings, {}), "");
}

}  // namespace
}  // namespace lamplock::test::program_parts_test
