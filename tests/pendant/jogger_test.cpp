// An operator at a pendant or a keyboard, and how the machine of a virtual board follows: distance,
// speed, and above all when it stops.
#include "host/pendant/jogger.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <random>
#include <regex>

#include "host/error.hpp"
#include "tests/pendant/hand.hpp"

namespace lamplock::pendant {
namespace {

using test::scaled;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;

constexpr std::uint8_t cancel = 0x85;

/// Distance to rest from a speed, including the time allowed for the reaction to a loss.
double max_distance(double mm_s, double reaction_s) {
  return mm_s * mm_s / (2 * accel_mm_s2) + mm_s * reaction_s + 0.01;
}

KeyMap map_with(double feed_mm_min) {
  KeyMap map = default_key_map();
  map.feed_mm_min = feed_mm_min;
  return map;
}

TEST(Steps, every_click_counts) {
  Hand hand;
  hand.select(Selector::x);
  for (const int clicks : {1, 1, 3, -2, 1}) {
    hand.turn(clicks);
    hand.run_ms(40);
  }
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.x(), 0.4, 1e-9);
  hand.select(Selector::z);
  hand.jogger.choose_step(1);
  hand.turn(-2);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.at(2), -2, 1e-9);
  EXPECT_NEAR(hand.x(), 0.4, 1e-9);
  EXPECT_THAT(hand.cable.realtime, IsEmpty()) << "steps are never cancelled";
  hand.expect_sound();
}

/// A wheel that turns faster than the machine can follow loses clicks; the machine stays close to
/// the operator's movement.
TEST(Steps, at_most_a_quarter_of_a_second_is_queued) {
  Hand hand(map_with(600));
  hand.jogger.choose_step(1);
  hand.select(Selector::x);
  hand.keep_turning(5, 1000);
  const double at = hand.x();
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_LE(hand.x() - at, 10 * 0.25 + 1 + 0.05);
  EXPECT_NEAR(hand.x(), std::round(hand.x()), 1e-9) << "whole steps";
  EXPECT_GT(hand.x(), 8);
}

TEST(Steps, need_an_axis_and_a_step) {
  Hand hand;
  hand.turn(3);
  hand.select(Selector::b);
  hand.turn(3);
  hand.select(Selector::a);  // the machine has three axes
  hand.turn(3);
  hand.select(Selector::x);
  hand.jogger.take(rate_event({}));
  hand.turn(3);
  hand.jogger.set_mode(Mode::continuous);
  hand.turn(3);
  hand.run_ms(300);
  EXPECT_THAT(hand.cable.lines, IsEmpty());
}

/// While the axis switch is off, a keyboard key cannot select an axis for the wheel.
TEST(Steps, a_wheel_obeys_its_axis_switch) {
  Hand hand;
  hand.jogger.use_pendant(true);
  hand.jogger.press("x");
  hand.turn(3);
  hand.select(Selector::y);
  hand.jogger.press("x");
  hand.turn(3);
  hand.run_ms(300);
  EXPECT_THAT(hand.cable.lines, IsEmpty());
  hand.select(Selector::z);
  hand.turn(3);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.at(2), 0.3, 1e-9);
  // A shuttle has no axis switch.
  hand.jogger.use_pendant(false);
  hand.jogger.press("x");
  hand.turn(3);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.x(), 0.3, 1e-9);
}

TEST(Continuous, the_wheel_moves_at_the_feed_and_silence_stops) {
  for (const double mm_s : {5.0, 50.0, 100.0}) {
    Hand hand(map_with(mm_s * 60));
    hand.jogger.set_mode(Mode::continuous);
    hand.select(Selector::y);
    hand.keep_turning(1, 180);
    const double from = hand.at(1);
    hand.keep_turning(1, 90);
    EXPECT_NEAR((hand.at(1) - from) / 0.09, mm_s, mm_s * 0.03 + 0.1);
    const double at = hand.at(1);
    hand.run_ms(400);
    EXPECT_LE(hand.at(1) - at, max_distance(mm_s, 0.25 + 0.02)) << mm_s;
    EXPECT_TRUE(hand.jogger.rests());
    hand.expect_sound();
  }
}

TEST(Continuous, the_rate_switch_sets_the_speed) {
  Hand hand(map_with(6000));
  hand.jogger.set_mode(Mode::continuous);
  hand.jogger.take(rate_event({1, 30}));
  hand.select(Selector::x);
  hand.keep_turning(-1, 300);
  const double from = hand.x();
  hand.keep_turning(-1, 300);
  EXPECT_NEAR((hand.x() - from) / 0.3, -30, 1);
}

TEST(Continuous, an_axis_moves_no_faster_than_it_can) {
  job::Profile profile = Hand::plain_profile();
  job::state_setting(profile, settings::Id::max_rate_x, 600, "test");
  Hand hand(map_with(60'000), profile);
  hand.jogger.set_mode(Mode::continuous);
  hand.select(Selector::x);
  hand.keep_turning(1, 600);
  const double at = hand.x();
  hand.jogger.stop_motion();
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_LE(hand.x() - at, max_distance(10, 0.05));
}

/// The machine is slower than its settings say; the jogger uses the reported positions.
TEST(Continuous, the_distance_ahead_is_bounded_by_reported_positions) {
  job::Profile slow = Hand::plain_profile();
  job::state_setting(slow, settings::Id::max_rate_x, 600, "test");
  Hand hand(map_with(6000), slow, jog_limits(Hand::plain_profile().settings));
  hand.jogger.set_mode(Mode::continuous);
  hand.select(Selector::x);
  hand.keep_turning(1, 900);
  const double at = hand.x();
  hand.run_alone_ms(10'000);
  EXPECT_LE(hand.x() - at, max_distance(100, 0.35)) << "the jogs add up to 90 mm";
}

TEST(Continuous, a_reversal_begins_where_the_machine_came_to_rest) {
  Hand hand(map_with(6000));
  hand.jogger.set_mode(Mode::continuous);
  hand.select(Selector::x);
  hand.keep_turning(1, 300);
  hand.keep_turning(-1, 600);
  EXPECT_LT(hand.x(), 5);
  ASSERT_TRUE(hand.come_to_rest());
  hand.expect_sound();
}

TEST(Continuous, a_spring_ring_jogs_until_it_is_released) {
  Hand hand(map_with(4200));
  hand.select(Selector::x);
  hand.jogger.take(count_event(Event::Kind::spring, 7));
  hand.run_ms(300);
  const double from = hand.x();
  hand.run_ms(100);
  EXPECT_NEAR((hand.x() - from) / 0.1, 70, 2);
  hand.jogger.take(count_event(Event::Kind::spring, 2));
  hand.run_ms(200);
  const double slow_from = hand.x();
  hand.run_ms(100);
  EXPECT_NEAR((hand.x() - slow_from) / 0.1, 20, 2);
  const double at = hand.x();
  hand.jogger.take(count_event(Event::Kind::spring, 0));
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_LE(hand.x() - at, max_distance(20, 0.05));
}

TEST(Continuous, a_silent_spring_ring_is_released_after_a_timeout) {
  Hand hand(map_with(420));
  hand.select(Selector::x);
  hand.jogger.take(count_event(Event::Kind::spring, 1));
  hand.run_ms(29'900);
  EXPECT_NEAR(hand.x(), 29.9, 0.5) << "1 mm/s";
  hand.run_ms(1000);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.x(), 30, 0.5);
  hand.jogger.take(count_event(Event::Kind::spring, 2));
  hand.run_ms(1000);
  EXPECT_GT(hand.x(), 31);
}

TEST(Continuous, stops_inside_the_work_space) {
  Hand hand(map_with(12'000));
  hand.jogger.set_mode(Mode::continuous);
  hand.select(Selector::x);
  hand.keep_turning(1, 1500);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_LE(hand.x(), 50);
  EXPECT_GT(hand.x(), 47) << "accepted jogs end inside the work space and are completed";
  EXPECT_THAT(hand.jogger.take_notes(), Contains(HasSubstr("error:15")));
  hand.keep_turning(-1, 300);
  EXPECT_LT(hand.x(), 46);
}

/// The time, the speed and the operator's preceding actions are random.
TEST(Loss, stops_the_machine_within_its_braking_distance_and_50_ms) {
  std::mt19937_64 random(3);
  const auto pick = [&random](int from, int to) {
    return std::uniform_int_distribution<>(from, to)(random);
  };
  for (int round = 0; round < scaled(60); ++round) {
    const double mm_s = pick(1, 30) * pick(1, 10);
    Hand hand(map_with(mm_s * 60));
    hand.jogger.set_mode(Mode::continuous);
    const int axis = pick(0, 2);
    hand.select(static_cast<Selector>(axis + 1));
    hand.keep_turning(pick(0, 1) == 0 ? 1 : -1, pick(0, 250));
    const double at = hand.at(axis);
    switch (pick(0, 3)) {
      case 0:
        hand.jogger.stop_motion();
        break;
      case 1:
        hand.select(Selector::off);
        break;
      case 2:
        hand.jogger.take(plain_event(Event::Kind::asleep));
        break;
      default:
        hand.key(Key::stop);
    }
    ASSERT_TRUE(hand.come_to_rest());
    EXPECT_LE(std::fabs(hand.at(axis) - at), max_distance(mm_s, 0.05)) << mm_s << " mm/s";
    hand.expect_sound();
  }
}

/// After a killed program or a cut cable there is no host to send a cancel.
TEST(Loss, increments_end_by_themselves) {
  std::mt19937_64 random(5);
  for (int round = 0; round < scaled(20); ++round) {
    const double mm_s = 5 + static_cast<double>(random() % 200);
    Hand hand(map_with(mm_s * 60));
    hand.jogger.set_mode(Mode::continuous);
    hand.select(Selector::x);
    hand.keep_turning(1, 50 + static_cast<double>(random() % 200));
    const double at = hand.x();
    hand.run_alone_ms(500);
    EXPECT_LE(hand.x() - at, max_distance(mm_s, 0.1)) << mm_s << " mm/s";
    const double at_rest = hand.x();
    hand.run_alone_ms(100);
    EXPECT_EQ(hand.x(), at_rest);
  }
}

TEST(Loss, a_silent_board_gets_no_more_lines_and_is_an_error) {
  Hand hand(map_with(3000));
  hand.jogger.set_mode(Mode::continuous);
  hand.select(Selector::x);
  hand.keep_turning(1, 200);
  hand.cable.mute = true;
  const double at = hand.x();
  hand.keep_turning(1, 600);
  EXPECT_THAT(hand.cable.realtime, Contains(cancel));
  const std::size_t lines = hand.cable.lines.size();
  EXPECT_LE(hand.x() - at, max_distance(50, 0.25 + 0.05));
  hand.keep_turning(1, 600);
  EXPECT_EQ(hand.cable.lines.size(), lines);
  try {
    hand.run_ms(5000);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::no_device);
  }
}

/// A cancel overtakes queued lines, even within a line; the rest of that line must not be a jog.
TEST(Loss, over_a_cable_that_accepts_a_few_bytes_at_a_time) {
  std::mt19937_64 random(7);
  for (int round = 0; round < scaled(60); ++round) {
    const double mm_s = 20 + static_cast<double>(random() % 50);
    Hand hand(map_with(mm_s * 60));
    hand.cable.max_written = [&random] { return 3 + random() % 12; };
    hand.jogger.set_mode(Mode::continuous);
    hand.select(Selector::x);
    hand.keep_turning(1, 60 + static_cast<double>(random() % 200));
    const double at = hand.x();
    hand.jogger.stop_motion();
    hand.run_ms(mm_s / accel_mm_s2 * 1000 + 150);
    const double at_rest = hand.x();
    EXPECT_LE(at_rest - at, max_distance(mm_s, 0.1)) << round;
    ASSERT_TRUE(hand.come_to_rest());
    EXPECT_EQ(hand.x(), at_rest) << round;
    hand.expect_sound();
  }
}

/// The first half of a line was sent when it is cancelled; the rest must not start motion.
TEST(Loss, in_the_middle_of_a_line) {
  std::mt19937_64 random(8);
  for (int round = 0; round < scaled(30); ++round) {
    Hand hand(map_with(3000));
    hand.cable.max_written = [&random] { return 3 + random() % 3; };
    hand.jogger.choose_step(1);
    hand.select(Selector::x);
    hand.turn(10);
    hand.run_ms(2 + 2 * static_cast<double>(random() % 5));
    hand.jogger.stop_motion();
    ASSERT_TRUE(hand.come_to_rest());
    EXPECT_LE(hand.x(), 0.5) << round;
    EXPECT_THAT(hand.cable.lines.size(), testing::Le(1u));
  }
}

// --- motion other than continuous jogging ---

/// A machine that homes at 100 mm/s; its switches are out of reach.
job::Profile homing_profile() {
  job::Profile profile = Hand::plain_profile();
  job::state_setting(profile, settings::Id::homing, 1, "test");
  job::state_setting(profile, settings::Id::homing_seek, 6000, "test");
  job::state_setting(profile, settings::Id::homing_feed, 6000, "test");
  return profile;
}

/// Distance of all axes from the position at construction.
class WaySince {
 public:
  explicit WaySince(const Hand& hand) : hand_(hand), from_(place()) {}
  double mm() const {
    const std::vector<double> now = place();
    double sum = 0;
    for (std::size_t a = 0; a < now.size(); ++a) sum += std::pow(now[a] - from_[a], 2);
    return std::sqrt(sum);
  }

 private:
  std::vector<double> place() const { return {hand_.at(0), hand_.at(1), hand_.at(2)}; }
  const Hand& hand_;
  std::vector<double> from_;
};

constexpr double some_mm_s = 100;

/// A motion of at least one second at 100 mm/s, along one axis at a time.
struct Mover {
  const char* name;
  std::function<void(Hand&)> begin;
};
const std::vector<Mover>& movers() {
  static const std::vector<Mover> all{
      {"a long step",
       [](Hand& hand) {
         hand.select(Selector::x);
         hand.turn(1);
       }},
      {"a move to a position", [](Hand& hand) { hand.key(Key::safe_z); }},
      {"a macro of moves", [](Hand& hand) { hand.key(key_of_row(Key::macro_1, 1)); }},
      {"a macro of jogs", [](Hand& hand) { hand.key(key_of_row(Key::macro_1, 2)); }},
      {"a macro that homes", [](Hand& hand) { hand.key(key_of_row(Key::macro_1, 3)); }},
      {"homing", [](Hand& hand) { hand.key(Key::home); }}};
  return all;
}

Hand moving_hand() {
  KeyMap map = map_with(some_mm_s * 60);
  map.steps_mm = {45};
  map.safe_z_mm = -45;
  map.macros.push_back({"moves", {"G91", "G1 X45 F6000", "G1 X-90", "G1 X45"}, false});
  map.macros.push_back({"jogs", {"$J=G91X45F6000", "$J=G91X-90F6000", "$J=G91X45F6000"}, false});
  map.macros.push_back({"homes", {"$H", "G91 G1 X-20 F6000"}, false});
  for (std::size_t i = 0; i < map.macros.size(); ++i)
    map.keys[key_of_row(Key::macro_1, static_cast<int>(i) + 1)] = {Action::none, i};
  return Hand(std::move(map), homing_profile());
}

/// With homing enabled the machine starts locked.
void unlock(Hand& hand) {
  hand.jogger.press("u");
  ASSERT_TRUE(hand.come_to_rest());
  hand.jogger.take_notes();
  hand.cable.realtime.clear();
}

TEST(Loss, stops_every_kind_of_motion) {
  std::mt19937_64 random(17);
  const auto pick = [&random](int from, int to) {
    return std::uniform_int_distribution<>(from, to)(random);
  };
  for (int round = 0; round < scaled(90); ++round) {
    const Mover& mover = movers()[static_cast<std::size_t>(round) % movers().size()];
    SCOPED_TRACE(fmt::format("{}, round {}", mover.name, round));
    Hand hand = moving_hand();
    unlock(hand);
    if (pick(0, 1) == 0) {
      hand.cable.max_written = [&random] { return 1 + random() % 3; };
    }
    mover.begin(hand);
    // The first moments count: lines that are partly sent, motion that is not yet reported.
    hand.run_ms(pick(0, 1) == 0 ? pick(0, 30) : pick(30, 400));
    const WaySince way(hand);
    if (pick(0, 1) == 0)
      hand.jogger.stop_motion();
    else
      hand.jogger.take(plain_event(Event::Kind::asleep));
    hand.run_ms(300);
    EXPECT_LE(way.mm(), max_distance(some_mm_s, 0.1));
    const WaySince more(hand);
    hand.run_ms(2000);
    EXPECT_EQ(more.mm(), 0);
    EXPECT_TRUE(hand.jogger.machine().status.is_at_rest());
    EXPECT_TRUE(hand.jogger.rests() || hand.jogger.machine().status.waits());
    hand.expect_dark();
  }
}

/// Without a loss the machine must keep moving, or the test above proves nothing.
TEST(Loss, without_a_loss_motion_continues) {
  for (const Mover& mover : movers()) {
    Hand hand = moving_hand();
    unlock(hand);
    mover.begin(hand);
    hand.run_ms(150);
    const WaySince way(hand);
    hand.run_ms(150);
    EXPECT_GT(way.mm(), 10) << mover.name;
  }
}

/// The first bytes that would stop the machine are lost.
TEST(Loss, a_lost_byte_is_sent_again) {
  for (const Mover& mover : movers()) {
    SCOPED_TRACE(mover.name);
    Hand hand = moving_hand();
    unlock(hand);
    mover.begin(hand);
    hand.run_ms(200);
    bool lost = false;
    const Time until = hand.cable.now() + Time(10'000);
    hand.cable.loses = [&](std::uint8_t byte) {
      const bool stops = byte == cancel || byte == '!' || byte == 0x18;
      if (!stops || hand.cable.now() >= until) return false;
      return lost = true;
    };
    const WaySince way(hand);
    hand.jogger.stop_motion();
    hand.run_ms(500);
    EXPECT_TRUE(lost);
    EXPECT_LE(way.mm(), max_distance(some_mm_s, 0.15));
    EXPECT_TRUE(hand.jogger.machine().status.is_at_rest());
  }
}

/// The program ends immediately afterwards.
TEST(Homing, that_is_not_yet_reported_is_reset_too) {
  Hand hand = moving_hand();
  unlock(hand);
  hand.key(Key::home);
  hand.run_ms(4);
  EXPECT_FALSE(hand.jogger.machine().status.is("Home"));
  hand.jogger.stop_motion();
  hand.port.flush();
  hand.run_alone_ms(300);
  const WaySince way(hand);
  hand.run_alone_ms(500);
  EXPECT_EQ(way.mm(), 0);
}

TEST(Homing, ends_with_a_reset_and_can_start_again) {
  Hand hand = moving_hand();
  unlock(hand);
  hand.key(Key::home);
  hand.run_ms(200);
  ASSERT_TRUE(hand.jogger.machine().status.is("Home"));
  EXPECT_FALSE(hand.jogger.rests());
  hand.jogger.stop_motion();
  EXPECT_FALSE(hand.jogger.rests()) << "until a report confirms it";
  hand.run_ms(300);
  EXPECT_THAT(hand.cable.realtime, AllOf(Not(IsEmpty()), Each(0x18)));
  EXPECT_TRUE(hand.jogger.machine().status.is("Alarm"));
  EXPECT_TRUE(hand.jogger.rests());
  EXPECT_THAT(hand.jogger.take_notes(), Contains(HasSubstr("homing")));
  hand.key(Key::home);
  hand.run_ms(300);
  EXPECT_TRUE(hand.jogger.machine().status.is("Home"));
  hand.key(Key::start);
  hand.run_ms(300);
  EXPECT_TRUE(hand.jogger.machine().status.is("Alarm")) << "a pause also ends homing";
}

TEST(Keyboard, a_key_is_one_step_and_a_held_key_jogs_smoothly) {
  for (const double hz : {10.9, 25.0, 30.0}) {
    Hand hand(map_with(1200));
    hand.jogger.set_mode(Mode::continuous);
    hand.jogger.press("right");
    hand.run_ms(400);
    EXPECT_NEAR(hand.x(), 0.1, 1e-9);
    std::mt19937_64 random(1);
    std::vector<double> places;
    for (int i = 0; i < static_cast<int>(1.5 * hz); ++i) {
      hand.jogger.press("right");
      const double jitter = static_cast<double>(random() % 10) - 5;
      const auto rounds = static_cast<int>(std::ceil((1000 / hz + jitter) / 2));
      for (int round = 0; round < rounds; ++round) {
        hand.run_ms(2);
        places.push_back(hand.x());
      }
    }
    constexpr std::size_t begin = 150, window = 20;
    for (std::size_t i = begin; i + window < places.size(); ++i)
      EXPECT_NEAR((places[i + window] - places[i]) / 0.04, 20, 1) << hz << " Hz, " << i;
    const double at = hand.x();
    ASSERT_TRUE(hand.come_to_rest());
    EXPECT_LE(hand.x() - at, max_distance(20, 0.3));
    hand.expect_sound();
  }
}

TEST(Keyboard, another_key_ends_the_jog) {
  Hand hand(map_with(3000));
  hand.jogger.set_mode(Mode::continuous);
  for (int i = 0; i < 10; ++i) {
    hand.jogger.press("up");
    hand.run_ms(33);
  }
  const double at = hand.at(1);
  hand.jogger.press("?");
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_LE(hand.at(1) - at, max_distance(50, 0.05));
  EXPECT_THAT(hand.cable.realtime, Contains(cancel));
}

TEST(Keyboard, in_mode_step_every_repeat_is_a_step) {
  Hand hand;
  hand.jogger.set_mode(Mode::step);
  for (int i = 0; i < 10; ++i) {
    hand.jogger.press("left");
    hand.run_ms(33);
  }
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.x(), -1, 1e-9);
}

TEST(Keys, zero_and_moves_to_it) {
  KeyMap map = default_key_map();
  map.safe_z_mm = 20;
  Hand hand(map);
  hand.jogger.choose_step(1);
  hand.select(Selector::x);
  hand.turn(3);
  ASSERT_TRUE(hand.come_to_rest());
  hand.key(Key::zero);
  ASSERT_TRUE(hand.come_to_rest());
  hand.run_ms(1500);  // only some reports include the offset
  EXPECT_NEAR(hand.jogger.display().work_mm[0], 0, 1e-6);
  hand.turn(2);
  ASSERT_TRUE(hand.come_to_rest());
  hand.key(Key::go_to_zero);
  hand.run_ms(100);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.x(), 3, 1e-9);
  hand.key(Key::safe_z);
  hand.run_ms(100);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_NEAR(hand.at(2), 20, 1e-9);
  EXPECT_THAT(hand.cable.lines, Contains("G10 L20 P1 X0"));
}

TEST(Keys, a_move_to_zero_stops_with_the_stop_key) {
  Hand hand(map_with(3000));
  hand.select(Selector::x);
  hand.jogger.choose_step(1);
  for (int i = 0; i < 2; ++i) {
    hand.turn(10);
    ASSERT_TRUE(hand.come_to_rest());
  }
  hand.key(Key::go_to_zero);
  hand.run_ms(100);
  const double at = hand.x();
  hand.key(Key::stop);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_LE(std::fabs(hand.x() - at), max_distance(50, 0.05));
  EXPECT_GT(hand.x(), 1);
}

TEST(Keys, act_as_on_grbl) {
  Hand hand;
  hand.port.send_line("G1 X30 F600");
  hand.run_ms(300);
  ASSERT_TRUE(hand.jogger.machine().status.is("Run"));
  hand.key(Key::start);
  hand.run_ms(300);
  EXPECT_TRUE(hand.jogger.machine().status.is("Hold"));
  hand.select(Selector::x);
  hand.turn(1);
  EXPECT_THAT(hand.jogger.take_notes(), ElementsAre(HasSubstr("cannot jog in state Hold")));
  hand.key(Key::start);
  hand.run_ms(200);
  EXPECT_TRUE(hand.jogger.machine().status.is("Run"));
  hand.key(Key::stop);
  hand.run_ms(300);
  EXPECT_TRUE(hand.jogger.machine().status.is("Hold"));
  hand.key(Key::reset);
  hand.run_ms(500);
  EXPECT_THAT(hand.cable.realtime, ElementsAre('!', '~', '!', 0x18));
  EXPECT_TRUE(hand.jogger.rests());
}

TEST(Keys, overrides) {
  Hand hand;
  hand.jogger.set_mode(Mode::feed);
  hand.select(Selector::x);
  hand.turn(2);
  hand.turn(-1);
  hand.select(Selector::power);
  hand.turn(1);
  hand.key(Key::feed_plus);
  hand.run_ms(20);
  EXPECT_THAT(hand.cable.realtime, ElementsAre(0x93, 0x93, 0x94, 0x9c, 0x91));
  EXPECT_THAT(hand.cable.lines, IsEmpty());
}

KeyMap map_with_macro(std::vector<std::string> lines) {
  KeyMap map = default_key_map();
  map.macros.push_back({"test", std::move(lines), false});
  map.keys[Key::macro_1] = {Action::none, 0};
  return map;
}

TEST(Macros, are_sent_line_by_line) {
  Hand hand(map_with_macro({"G91 G1 X2 F600", "G90", "G10 L20 P1 X0"}));
  hand.select(Selector::y);
  hand.key(Key::macro_1);
  hand.turn(1);
  hand.run_ms(50);
  hand.turn(1);
  ASSERT_TRUE(hand.come_to_rest());
  EXPECT_THAT(hand.cable.lines, ElementsAre("M5", "G91 G1 X2 F600", "G90", "G10 L20 P1 X0"));
  EXPECT_NEAR(hand.x(), 2, 1e-9);
}

TEST(Macros, end_with_an_error_a_loss_and_a_reset) {
  Hand hand(map_with_macro({"G91 G1 X20 F600", "G4 P0", "G1 X20", "G1 X-40"}));
  hand.key(Key::macro_1);
  hand.run_ms(300);
  hand.jogger.stop_motion();
  hand.run_ms(500);
  EXPECT_TRUE(hand.jogger.machine().status.is("Hold"));
  const double at = hand.x();
  hand.key(Key::reset);
  hand.run_ms(1000);
  EXPECT_EQ(hand.x(), at);
  EXPECT_THAT(hand.cable.lines, ElementsAre("M5", "G91 G1 X20 F600", "G4 P0"));

  Hand other(map_with_macro({"G91", "nonsense", "G1 X20 F600"}));
  other.key(Key::macro_1);
  other.run_ms(300);
  EXPECT_EQ(other.x(), 0);
  EXPECT_THAT(other.jogger.take_notes(), Contains(HasSubstr("nonsense")));
}

/// Any restart of the board loses the state that the macro relied on.
TEST(Macros, do_not_continue_after_a_restart) {
  Hand hand(map_with_macro({"G4 P0.3", "G91 G1 X5 F600"}));
  hand.key(Key::macro_1);
  hand.run_ms(100);
  hand.port.send_realtime(0x18);
  hand.run_ms(1000);
  EXPECT_THAT(hand.cable.lines, ElementsAre("M5", "G4 P0.3"));
  EXPECT_EQ(hand.x(), 0);
  EXPECT_TRUE(hand.jogger.rests());
}

/// Random events at random times: the only lines sent are jogs, homing, unlocking and zeroing, and
/// the machine always comes to rest.
TEST(AnyEvents, never_light_a_laser_and_always_end_at_rest) {
  std::mt19937_64 random(13);
  const auto pick = [&random](int from, int to) {
    return std::uniform_int_distribution<>(from, to)(random);
  };
  std::vector<std::string> names;
  for (const auto& [name, binding] : default_key_map().keyboard) names.push_back(name);
  for (int round = 0; round < scaled(15); ++round) {
    KeyMap map = map_with(pick(100, 20'000));
    map.safe_z_mm = pick(-60, 60);
    Hand hand(map);
    for (int i = 0; i < 120; ++i) {
      switch (pick(0, 7)) {
        case 0:
          hand.key(static_cast<Key>(pick(1, static_cast<int>(Key::count) - 1)));
          break;
        case 1:
          hand.select(static_cast<Selector>(pick(0, 8)));
          break;
        case 2:
          hand.jogger.take(count_event(Event::Kind::spring, pick(-7, 7)));
          break;
        case 3:
          hand.jogger.press(
              names[static_cast<std::size_t>(pick(0, static_cast<int>(names.size()) - 1))]);
          break;
        case 4:
          hand.jogger.take(rate_event({pick(0, 3) * 0.1, pick(0, 100), pick(0, 5) == 0}));
          break;
        default:
          hand.turn(pick(-128, 127));
      }
      hand.run_ms(pick(0, 60));
    }
    hand.jogger.stop_motion();
    hand.run_ms(1500);
    // The user may leave a hold active without limit, and it may hold back a line.
    EXPECT_TRUE(hand.jogger.rests() || hand.jogger.machine().status.waits());
    const double at = hand.x();
    hand.run_ms(100);
    EXPECT_EQ(hand.x(), at);
    EXPECT_THAT(hand.cable.lines,
                Each(MatchesRegex("\\$H|\\$X|G10 L20 P1( [XYZ]0)+|\\$J=[GXYZF0-9.-]+")));
    hand.expect_dark();
  }
}

}  // namespace
}  // namespace lamplock::pendant
