// hidapi itself, at a pendant that umockdev makes.
#include "host/pendant/hid.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <thread>

#include "host/error.hpp"
#include "host/pendant/pendant.hpp"
#include "tests/pendant/hid_bench.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

/// What comes within two seconds.
Events wait_for_events(Pendant& pendant) {
  for (int i = 0; i < 2000; ++i) {
    if (Events events = pendant.poll(); !events.empty() || pendant.gone()) return events;
    std::this_thread::sleep_for(1ms);
  }
  return {};
}

TEST(Hidapi, a_pendant_is_found_read_shown_to_and_lost) {
  if (!inside_umockdev()) return;
  HidBench bench("10CE", "EB70");
  const auto found = find_pendants("auto");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].path, HidBench::node);
  EXPECT_TRUE(find_pendants("whb04b").empty());
  Pendant pendant(*found[0].id, open_pendant(found[0]), {});
  EXPECT_TRUE(pendant.poll().empty());
  bench.send({4, 0, 0, 0x12, 0xfe, 0x33});
  EXPECT_THAT(wait_for_events(pendant),
              ElementsAre(selector_event(Selector::y), count_event(Event::Kind::wheel, -2)));
  Display display;
  display.work_mm = {1, 2, 3, 0};
  for (int i = 0; i < 20; ++i) pendant.show(display, Time(i));
  EXPECT_EQ(bench.shown(), make_decoder(Kind::hb04)->display(display)) << "once, all of it";
  bench.unplug();
  EXPECT_TRUE(wait_for_events(pendant).empty());
  EXPECT_TRUE(pendant.gone());
  EXPECT_TRUE(pendant.poll().empty());
  pendant.show({}, 10s);
}

TEST(Hidapi, a_device_that_is_no_pendant_is_left_alone) {
  if (!inside_umockdev()) return;
  const HidBench bench("046D", "C077");
  EXPECT_TRUE(list_pendants().empty());
}

TEST(Hidapi, without_permission_it_says_what_to_do) {
  if (!inside_umockdev()) return;
  const HidBench bench("10CE", "EB93", Node::locked);
  const auto found = list_pendants();
  ASSERT_EQ(found.size(), 1u);
  // Root may open everything.
  constexpr uid_t nobody = 65534;
  const bool root = ::geteuid() == 0;
  if (root) {
    ASSERT_EQ(::setresuid(nobody, nobody, 0), 0);
  }
  std::string text;
  Exit exit = Exit::done;
  try {
    open_pendant(found[0]);
  } catch (const Error& error) {
    text = error.what();
    exit = error.exit();
  }
  if (root) {
    ASSERT_EQ(::setresuid(0, 0, 0), 0);
  }
  EXPECT_EQ(exit, Exit::no_device);
  EXPECT_THAT(text, HasSubstr("XHC WHB04B"));
  EXPECT_THAT(text, HasSubstr("60-lamplock.rules"));
}

TEST(Hidapi, one_that_has_gone_meanwhile_is_an_error) {
  const HidInfo info{&pendant_ids[0], "/dev/no-such-hidraw"};
  EXPECT_THROW(open_pendant(info), Error);
}

}  // namespace
}  // namespace lamplock::pendant
