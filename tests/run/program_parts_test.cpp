// A stopped program names the part with which its command begins again, not a line.
#include <gmock/gmock.h>

#include <string>

#include "host/run/run_program.hpp"
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

}  // namespace
}  // namespace lamplock::test::program_parts_test
