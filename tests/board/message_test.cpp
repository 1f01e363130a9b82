// Messages in comments on the virtual board: reported when the line is accepted.
#include "tests/board/program_host.hpp"

namespace lamplock::test::message_test {
namespace {

using testing::ElementsAre;

TEST(Message, IsReportedBeforeTheAnswerOfItsLine) {
  const job::Profile profile = program_profile();
  Rig rig(profile);
  ProgramHost host(rig);
  EXPECT_THAT(host.ask("#1=2 G1 X1 F6000 (MSG, cut begins)(debug, #1 parts)\n"),
              ElementsAre("[MSG:cut begins]", "[MSG:2.000000 parts]", "ok"));
  EXPECT_THAT(host.ask("(print, %.1f#5420)\n"), ElementsAre("[MSG:1.0]", "ok"));
  EXPECT_THAT(host.ask("(comment)\n"), ElementsAre("ok"));
  // A line with an error has none.
  EXPECT_THAT(host.ask("G1 X (MSG, a)\n"), ElementsAre("error:2"));
}

}  // namespace
}  // namespace lamplock::test::message_test
