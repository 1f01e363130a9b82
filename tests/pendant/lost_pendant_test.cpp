// A pendant whose receiver is unplugged during a jog: from hidapi to the drives.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host/pendant/pendant.hpp"
#include "tests/pendant/hand.hpp"
#include "tests/pendant/hid_bench.hpp"

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;

constexpr double accel_mm_s2 = 2000;  // of the machine in Hand
constexpr double reaction_s = 0.05;
constexpr double tolerance_mm = 0.01;

/// One round of the loop of `lamplock jog`, 2 ms of the machine's time; false if the pendant is
/// gone.
bool round(Hand& hand, Pendant& pendant) {
  hand.run_ms(2);
  for (const Event& event : pendant.poll()) hand.jogger.take(event);
  if (!pendant.gone()) return true;
  hand.jogger.stop_motion();
  return false;
}

TEST(LostPendant, the_machine_stops_within_its_braking_distance_and_50_ms) {
  if (!inside_umockdev()) return;
  std::mt19937_64 random(11);
  for (int i = 0; i < test::scaled(10); ++i) {
    const double mm_s = 10 + static_cast<double>(random() % 190);
    HidBench bench("10CE", "EB70");
    const auto found = find_pendants("hb04");
    ASSERT_EQ(found.size(), 1u);
    Pendant pendant(*found[0].id, open_pendant(found[0]), open_pendant(found[0]), {});
    KeyMap map = default_key_map();
    map.feed_mm_min = mm_s * 60;
    Hand hand(map);
    hand.jogger.set_mode(Mode::continuous);
    const int rounds = 60 + static_cast<int>(random() % 60);
    for (int turned = 0; turned < rounds; ++turned) {
      if (turned % 15 == 0) bench.send({4, 0, 0, 0x11, 1, 0x55});
      ASSERT_TRUE(round(hand, pendant));
    }
    ASSERT_GT(hand.x(), 0) << "the machine must be jogging";
    bench.unplug();
    const double at = hand.x();
    while (round(hand, pendant)) continue;
    ASSERT_TRUE(hand.come_to_rest());
    EXPECT_LE(hand.x() - at, mm_s * mm_s / (2 * accel_mm_s2) + mm_s * reaction_s + tolerance_mm)
        << mm_s << " mm/s";
    hand.expect_sound();
  }
}

}  // namespace
}  // namespace lamplock::pendant
