// Motion to a place by a click, over real connections; pages that die on the way:
// dead_page_test.cpp.
#include <gtest/gtest.h>

#include "tests/serve/running_server.hpp"

namespace lamplock::serve::test::jog_to_test {
namespace {

using namespace std::chrono_literals;

/// Renews until the machine rests; the place then.
std::vector<double> travel(RunningServer& server, RawClient& page, const Json& place) {
  Json go = place;
  go["feed"] = 6000;
  go["seen"] = page.time();
  EXPECT_EQ(error_of(page.call("jog.go", go)), "");
  for (int i = 0; i < 60; ++i) {
    page.watch(70ms);
    if (i > 3 && page.status()["board"]["jogs"] == false) break;
    page.call("jog.renew", {{"seen", page.time()}});
  }
  return server.machine().view().board.machine_mm;
}

TEST(JogTo, a_place_ends_there_and_axes_without_one_stay) {
  RunningServer server;
  RawClient page = server.client("page");
  page.call("subscribe");
  EXPECT_NE(error_of(page.call("jog.go", {{"x", 1}, {"feed", 600}, {"seen", 0}})), "");
  page.call("control.take");
  page.watch(150ms);
  std::vector<double> at = travel(server, page, {{"x", 7.123}, {"y", -3.458}});
  EXPECT_NEAR(at.at(0), 7.123, 0.0051);  // a step is 0.005 mm
  EXPECT_NEAR(at.at(1), -3.458, 0.0051);
  EXPECT_NEAR(at.at(2), 0, 1e-9);
  at = travel(server, page, {{"z", 2}});
  EXPECT_NEAR(at.at(0), 7.123, 0.0051);
  EXPECT_NEAR(at.at(2), 2, 0.0051);
}

TEST(JogTo, a_place_is_not_continued_after_a_stop) {
  RunningServer server;
  RawClient page = server.client("page"), watcher = server.client("watcher");
  page.call("subscribe");
  page.call("control.take");
  page.watch(150ms);
  page.call("jog.go", {{"x", 40}, {"feed", 3000}, {"seen", page.time()}});
  page.watch(150ms);
  page.call("jog.renew", {{"seen", page.time()}});
  watcher.call("machine.stop");
  for (int i = 0; i < 4; ++i) {
    page.watch(70ms);
    page.call("jog.renew", {{"seen", page.time()}});
  }
  const double at = server.machine().view().board.machine_mm.at(0);
  EXPECT_GT(at, 1);
  page.watch(450ms);
  EXPECT_EQ(server.machine().view().board.machine_mm.at(0), at);
}

/// A stop of any client ends the jog of a button that is held: its renewals move nothing until it
/// is released.
TEST(JogTo, a_held_button_moves_nothing_after_a_stop_of_a_watcher) {
  for (const char* how : {"machine.stop", "jog.stop"}) {
    SCOPED_TRACE(how);
    RunningServer server;
    RawClient page = server.client("page"), watcher = server.client("watcher");
    page.call("subscribe");
    page.call("control.take");
    page.watch(150ms);
    const auto hold_for = [&](int renewals) {
      for (int i = 0; i < renewals; ++i) {
        page.call("jog.run", {{"direction", {1, 0, 0}}, {"feed", 3000}, {"seen", page.time()}});
        page.watch(70ms);
      }
      return server.machine().view().board.machine_mm.at(0);
    };
    EXPECT_GT(hold_for(3), 1);
    watcher.call(how);
    const double stopped = hold_for(5);
    EXPECT_EQ(hold_for(5), stopped);
    page.call("jog.stop");
    EXPECT_GT(hold_for(4), stopped + 1);
  }
}

}  // namespace
}  // namespace lamplock::serve::test::jog_to_test
