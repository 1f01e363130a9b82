// The real hidapi with a pendant emulated by umockdev.
#include "host/pendant/hid.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "host/error.hpp"
#include "host/pendant/pendant.hpp"
#include "tests/pendant/hid_bench.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

/// Events that arrive within two seconds.
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
  Pendant pendant(*found[0].id, open_pendant(found[0]), open_pendant(found[0]), {});
  EXPECT_TRUE(pendant.poll().empty());
  bench.send({4, 0, 0, 0x12, 0xfe, 0x33});
  EXPECT_THAT(wait_for_events(pendant),
              ElementsAre(selector_event(Selector::y), count_event(Event::Kind::wheel, -2)));
  Display display;
  display.work_mm = {1, 2, 3, 0};
  for (int i = 0; i < 20; ++i) pendant.show(display, Time(i));
  const std::vector<FeatureReport> wanted = make_decoder(Kind::hb04)->display(display);
  for (int i = 0; i < 2000 && bench.shown().size() < wanted.size(); ++i)
    std::this_thread::sleep_for(1ms);
  EXPECT_EQ(bench.shown(), wanted) << "the whole display, once";
  bench.unplug();
  EXPECT_TRUE(wait_for_events(pendant).empty());
  EXPECT_TRUE(pendant.gone());
  EXPECT_TRUE(pendant.poll().empty());
  pendant.show({}, 10s);
}

TEST(Hidapi, a_device_that_is_no_pendant_is_ignored) {
  if (!inside_umockdev()) return;
  const HidBench bench("046D", "C077");
  EXPECT_TRUE(list_pendants().empty());
}

TEST(Hidapi, without_permission_it_names_the_remedy) {
  if (!inside_umockdev()) return;
  const HidBench bench("10CE", "EB93", Node::locked);
  const auto found = list_pendants();
  ASSERT_EQ(found.size(), 1u);
  // Root can open every node.
  constexpr uid_t unprivileged = 65534;
  const bool root = ::geteuid() == 0;
  if (root) {
    ASSERT_EQ(::setresuid(unprivileged, unprivileged, 0), 0);
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

/// A device whose display hangs until it is released.
class HangingDevice final : public HidDevice {
 public:
  struct Display {
    std::mutex hangs{};
    std::atomic<int> begun{0}, taken{0};
  };
  explicit HangingDevice(std::shared_ptr<Display> display) : display_(std::move(display)) {}
  std::size_t read(std::span<std::uint8_t> report, std::chrono::milliseconds) override {
    constexpr std::array<std::uint8_t, 6> x_axis{4, 0, 0, 0x11, 0, 0};
    std::copy(x_axis.begin(), x_axis.end(), report.begin());
    return std::exchange(sent_, true) ? 0 : x_axis.size();
  }
  bool send_feature(std::span<const std::uint8_t>) override {
    ++display_->begun;
    const std::lock_guard wait(display_->hangs);
    ++display_->taken;
    return true;
  }
  bool gone() const override { return false; }

 private:
  std::shared_ptr<Display> display_;
  bool sent_ = false;
};

TEST(PendantDisplay, a_hanging_display_blocks_no_caller) {
  const auto display = std::make_shared<HangingDevice::Display>();
  std::unique_lock hang(display->hangs);
  {
    Pendant pendant(pendant_ids[0], std::make_unique<HangingDevice>(display),
                    std::make_unique<HangingDevice>(display), {});
    Display shown;
    pendant.show(shown, 1s);
    while (display->begun == 0) std::this_thread::sleep_for(1ms);
    // If any of these calls waited for the display, the test would not end.
    EXPECT_THAT(pendant.poll(), ElementsAre(selector_event(Selector::x)));
    for (int i = 0; i < 100; ++i) {
      shown.feed_mm_min = i;
      pendant.show(shown, std::chrono::seconds(2 + i));
    }
  }
  EXPECT_EQ(display->taken, 0);
  hang.unlock();
  const auto reports = static_cast<int>(make_decoder(Kind::hb04)->display({}).size());
  while (display->taken < reports) std::this_thread::sleep_for(1ms);
  // The thread releases the device when it ends.
  while (display.use_count() > 1) std::this_thread::sleep_for(1ms);
  EXPECT_EQ(display->taken, reports) << "only the display that hung, none of the later ones";
}

TEST(Hidapi, a_device_that_has_disappeared_is_an_error) {
  const HidInfo info{&pendant_ids[0], "/dev/no-such-hidraw"};
  EXPECT_THROW(open_pendant(info), Error);
}

}  // namespace
}  // namespace lamplock::pendant
