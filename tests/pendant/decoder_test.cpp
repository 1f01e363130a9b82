// Reports of pendants, byte for byte, decoded to events; their quirks; robustness against noise.
#include "host/pendant/decoder.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>
#include <set>
#include <tuple>

#include "host/pendant/shuttle.hpp"
#include "host/pendant/xhc_hb04.hpp"
#include "host/pendant/xhc_whb04b.hpp"
#include "tests/scale.hpp"

namespace lamplock::pendant {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Bytes = std::vector<std::uint8_t>;

Event down(Key key) { return key_event(Event::Kind::key_down, key); }
Event up(Key key) { return key_event(Event::Kind::key_up, key); }
Event wheel(int clicks) { return count_event(Event::Kind::wheel, clicks); }
Event spring(int place) { return count_event(Event::Kind::spring, place); }
const Event asleep = plain_event(Event::Kind::asleep), awake = plain_event(Event::Kind::awake);
const Event off = selector_event(Selector::off);

/// Names and codes of LinuxCNC's xhc-hb04-layout2.cfg.
TEST(XhcHb04, the_keys_of_the_model_with_18_keys) {
  const std::vector<std::pair<std::uint8_t, Key>> table{{0x01, Key::go_to_zero},
                                                        {0x02, Key::start},
                                                        {0x03, Key::rewind},
                                                        {0x04, Key::probe},
                                                        {0x05, key_of_row(Key::macro_1, 3)},
                                                        {0x06, Key::half},
                                                        {0x07, Key::zero},
                                                        {0x08, Key::safe_z},
                                                        {0x09, Key::home},
                                                        {0x0a, Key::macro_1},
                                                        {0x0b, key_of_row(Key::macro_1, 2)},
                                                        {0x0c, Key::spindle},
                                                        {0x0d, Key::step},
                                                        {0x0e, Key::mode},
                                                        {0x0f, key_of_row(Key::macro_1, 6)},
                                                        {0x10, key_of_row(Key::macro_1, 7)},
                                                        {0x16, Key::stop},
                                                        {0x17, Key::reset}};
  for (const auto& [code, key] : table) {
    XhcHb04 pendant(18);
    EXPECT_THAT(pendant.take(Bytes{4, code, 0, 0, 0, 0x33}), ElementsAre(down(key)));
    EXPECT_THAT(pendant.take(Bytes{4, code, 0, 0, 0, 0x34}), IsEmpty());
    EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0, 0, 0x33}), ElementsAre(up(key)));
  }
}

/// xhc-hb04-layout1.cfg
TEST(XhcHb04, the_keys_of_the_model_with_16_keys) {
  const std::vector<std::pair<std::uint8_t, Key>> table{
      {0x01, Key::stop},   {0x02, Key::start},  {0x03, Key::rewind},  {0x04, Key::safe_z},
      {0x05, Key::home},   {0x06, Key::half_x}, {0x07, Key::half_y},  {0x08, Key::probe},
      {0x09, Key::zero_x}, {0x0a, Key::zero_y}, {0x0b, Key::zero_z},  {0x0c, Key::go_to_zero},
      {0x0d, Key::step},   {0x0e, Key::mode},   {0x0f, Key::spindle}, {0x17, Key::reset}};
  for (const auto& [code, key] : table)
    EXPECT_THAT(XhcHb04(16).take(Bytes{4, code, 0, 0, 0, 0x33}), ElementsAre(down(key)));
}

/// "Stop" on one model is "go to zero" on the other.
TEST(XhcHb04, an_unknown_model_stops_rather_than_moves) {
  XhcHb04 pendant;
  EXPECT_THAT(pendant.take(Bytes{4, 0x01, 0, 0, 0, 1}), ElementsAre(down(Key::stop)));
  EXPECT_THAT(pendant.take(Bytes{4, 0x0d, 0, 0, 0, 1}),
              ElementsAre(up(Key::stop), down(Key::step)));
  EXPECT_THAT(pendant.take(Bytes{4, 0x09, 0, 0, 0, 1}),
              ElementsAre(up(Key::step), down(Key::ambiguous)));
  // The model with 16 keys has no key 16, so the model is now known.
  EXPECT_THAT(pendant.take(Bytes{4, 0x16, 0, 0, 0, 1}),
              ElementsAre(up(Key::ambiguous), down(Key::stop)));
  EXPECT_THAT(pendant.take(Bytes{4, 0x01, 0, 0, 0, 1}),
              ElementsAre(up(Key::stop), down(Key::go_to_zero)));
}

TEST(XhcHb04, switch_and_wheel) {
  XhcHb04 pendant(18);
  EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0x11, 0, 0x55}),
              ElementsAre(selector_event(Selector::x)));
  EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0x11, 3, 0x55}), ElementsAre(wheel(3)));
  EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0x11, 0xff, 0}), ElementsAre(wheel(-1)));
  EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0x18, 0x80, 0}),
              ElementsAre(selector_event(Selector::a), wheel(-128)));
  for (const auto& [code, selector] :
       std::vector<std::pair<std::uint8_t, Selector>>{{0x12, Selector::y},
                                                      {0x13, Selector::z},
                                                      {0x14, Selector::power},
                                                      {0x15, Selector::feed},
                                                      {0x19, Selector::off}})
    EXPECT_THAT(pendant.take(Bytes{4, 0, 0, code, 0, 7}), ElementsAre(selector_event(selector)));
}

TEST(XhcHb04, falls_asleep_and_wakes) {
  XhcHb04 pendant(18);
  pendant.take(Bytes{4, 0x0d, 0, 0x11, 0, 0x55});
  EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0, 0, 0}), ElementsAre(up(Key::step), off, asleep));
  EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0, 0, 0}), IsEmpty());
  EXPECT_THAT(pendant.take(Bytes{4, 0, 0, 0x11, 1, 0x55}),
              ElementsAre(awake, selector_event(Selector::x), wheel(1)));
}

/// Codes from the protocol notes of LinuxCNC's xhc-whb04b-6.
TEST(XhcWhb04b, keys_and_the_row_with_fn) {
  const auto macro = [](int number) { return key_of_row(Key::macro_1, number); };
  const std::vector<std::tuple<std::uint8_t, Key, Key>> table{
      {0x01, Key::reset, Key::reset},     {0x02, Key::stop, Key::stop},
      {0x03, Key::start, macro(13)},      {0x04, Key::feed_plus, macro(1)},
      {0x05, Key::feed_minus, macro(2)},  {0x06, Key::power_plus, macro(3)},
      {0x07, Key::power_minus, macro(4)}, {0x08, Key::home, macro(5)},
      {0x09, Key::safe_z, macro(6)},      {0x0a, Key::go_to_zero, macro(7)},
      {0x0b, Key::spindle, macro(8)},     {0x0d, Key::probe, macro(9)},
      {0x0e, Key::continuous, macro(15)}, {0x0f, Key::step, macro(16)},
      {0x10, macro(10), macro(14)}};
  for (const auto& [code, plain, with_function] : table) {
    XhcWhb04b pendant;
    pendant.take(Bytes{4, 0x10, 0, 0, 0x0d, 6, 0, 0x10});
    EXPECT_THAT(pendant.take(Bytes{4, 0x10, code, 0, 0x0d, 6, 0, 0x77}), ElementsAre(down(plain)));
    EXPECT_THAT(pendant.take(Bytes{4, 0x10, 0, 0, 0x0d, 6, 0, 0}), ElementsAre(up(plain)));
    EXPECT_THAT(pendant.take(Bytes{4, 1, 0x0c, 0, 0x0d, 6, 0, 0}), IsEmpty());
    EXPECT_THAT(pendant.take(Bytes{4, 1, 0x0c, code, 0x0d, 6, 0, 0}),
                ElementsAre(down(with_function)));
    // Fn is released first: the key is still the one that was pressed.
    EXPECT_THAT(pendant.take(Bytes{4, 1, code, 0, 0x0d, 6, 0, 0}), IsEmpty());
    EXPECT_THAT(pendant.take(Bytes{4, 1, 0, 0, 0x0d, 6, 0, 0}), ElementsAre(up(with_function)));
  }
}

TEST(XhcWhb04b, switches_and_wheel) {
  XhcWhb04b pendant;
  const auto rate = [&pendant](std::uint8_t code) {
    const Events events = pendant.take(Bytes{4, 9, 0, 0, code, 6, 0, 9});
    return events.size() == 1 ? events[0].rate : Rate{-1};
  };
  EXPECT_EQ(rate(0x0d), (Rate{0.001, 2}));
  EXPECT_EQ(rate(0x0e), (Rate{0.01, 5}));
  EXPECT_EQ(rate(0x0f), (Rate{0.1, 10}));
  EXPECT_EQ(rate(0x10), (Rate{1, 30}));
  EXPECT_EQ(rate(0x1a), (Rate{1, 60}));
  EXPECT_EQ(rate(0x1b), (Rate{1, 100}));
  EXPECT_EQ(rate(0x1c), (Rate{0, 0, true}));
  EXPECT_EQ(rate(0x0d), (Rate{0.001, 2}));
  EXPECT_EQ(rate(0x9b), (Rate{0, 0, true})) << "\"lead\" of later models, LinuxCNC issue 3485";
  EXPECT_EQ(rate(0x42), Rate{}) << "unknown position: no motion";
  // From the issue, of the same pendant: 100 % and X.
  EXPECT_THAT(pendant.take(Bytes{0x04, 0x10, 0, 0, 0x1b, 0x11, 0, 0x10}),
              ElementsAre(rate_event({1, 100}), selector_event(Selector::x)));
  EXPECT_THAT(pendant.take(Bytes{4, 9, 0, 0, 0x1b, 0x16, 0xfe, 9}),
              ElementsAre(selector_event(Selector::c), wheel(-2)));
}

/// An unknown position is reported even if it is the first, so that no step size is assumed.
TEST(XhcWhb04b, the_first_rate_is_always_reported) {
  XhcWhb04b pendant;
  EXPECT_THAT(pendant.take(Bytes{4, 9, 0, 0, 0x42, 0x11, 1, 9}),
              ElementsAre(rate_event({}), selector_event(Selector::x), wheel(1)));
}

TEST(XhcWhb04b, falls_asleep_with_two_reports) {
  XhcWhb04b pendant;
  pendant.take(Bytes{4, 9, 0x0e, 0, 0x0f, 0x11, 0, 9});
  EXPECT_THAT(pendant.take(Bytes{4, 0xa5, 0, 0, 0, 0, 0, 0x5a}),
              ElementsAre(up(Key::continuous), off, asleep));
  EXPECT_THAT(pendant.take(Bytes{4, 0xff, 0xff, 0x02, 0x0f, 0x11, 0x81, 0xff}), IsEmpty());
  EXPECT_THAT(pendant.take(Bytes{4, 9, 0, 0, 0x0f, 0x12, 1, 9}),
              ElementsAre(awake, rate_event({0.1, 10}), selector_event(Selector::y), wheel(1)));
}

TEST(Shuttle, dial_ring_and_buttons) {
  Shuttle pendant(Shuttle::Model::pro);
  EXPECT_THAT(pendant.take(Bytes{0, 0xfe, 0, 0, 0}), IsEmpty())
      << "the first report gives the position";
  EXPECT_THAT(pendant.take(Bytes{0, 0x01, 0, 0, 0}), ElementsAre(wheel(3))) << "the count wraps";
  EXPECT_THAT(pendant.take(Bytes{0, 0xff, 0, 0, 0}), ElementsAre(wheel(-2)));
  EXPECT_THAT(pendant.take(Bytes{0xf9, 0xff, 0, 0, 0}), ElementsAre(spring(-7)));
  EXPECT_THAT(pendant.take(Bytes{7, 0xff, 0, 0, 0}), ElementsAre(spring(7)));
  EXPECT_THAT(pendant.take(Bytes{8, 0xff, 0, 0, 0}), ElementsAre(spring(0)))
      << "impossible position";
  EXPECT_THAT(pendant.take(Bytes{0, 0xff, 0, 0x01, 0x40}),
              ElementsAre(down(Key::button_1), down(Key::button_15)));
  EXPECT_THAT(pendant.take(Bytes{0, 0xff, 0, 0x00, 0x80}),
              ElementsAre(up(Key::button_1), up(Key::button_15)));
}

TEST(Shuttle, the_five_buttons_of_the_xpress) {
  for (int i = 0; i < 5; ++i) {
    Shuttle pendant(Shuttle::Model::xpress);
    const unsigned bits = 0x10u << i;
    EXPECT_THAT(pendant.take(Bytes{0, 7, 0, static_cast<std::uint8_t>(bits & 0xff),
                                   static_cast<std::uint8_t>(bits >> 8)}),
                ElementsAre(down(key_of_row(Key::button_1, i + 1))));
  }
  EXPECT_THAT(Shuttle(Shuttle::Model::xpress).take(Bytes{0, 7, 0, 0x0f, 0xfe}), IsEmpty());
}

/// Bytes of the display, derived by hand from the driver's table.
TEST(Display, of_the_hb04) {
  Display shown;
  shown.work_mm = {1.5, -0.0001, 1234.5678, 42};
  shown.machine_mm = {-65535.9999, 0, 2, 43};
  shown.feed_percent = 110;
  shown.power_percent = 90;
  shown.feed_mm_min = 3000;
  shown.power = 70'000;  // more than the display can show
  shown.step_mm = 0.05;
  using Report = FeatureReport;
  EXPECT_THAT(
      XhcHb04().display(shown),
      ElementsAre(Report{6, 0xfe, 0xfd, 0x0c, 1, 0, 0x88, 0x13},
                  Report{6, 0, 0, 0x01, 0x80, 0xd2, 0x04, 0x2e},
                  Report{6, 0x16, 0xff, 0xff, 0x0f, 0xa7, 0, 0}, Report{6, 0, 0, 2, 0, 0, 0, 110},
                  Report{6, 0, 90, 0, 0xb8, 0x0b, 0xff, 0xff}, Report{6, 7, 0, 0, 0, 0, 0, 0}));
  shown.selector = Selector::a;
  const auto with_a = XhcHb04().display(shown);
  EXPECT_EQ(with_a[0], (Report{6, 0xfe, 0xfd, 0x0c, 42, 0, 0, 0}));
}

TEST(Display, of_the_whb04b) {
  Display shown;
  shown.work_mm = {10.25, -3, 0, 7};
  shown.feed_mm_min = 258;
  shown.power = 1;
  shown.mode = Mode::step;
  using Report = FeatureReport;
  EXPECT_THAT(XhcWhb04b().display(shown),
              ElementsAre(Report{6, 0xfe, 0xfd, 0xfe, 0x81, 10, 0, 0xc4},
                          Report{6, 0x09, 3, 0, 0, 0x80, 0, 0}, Report{6, 0, 0, 2, 1, 1, 0, 0}));
  shown.mode = Mode::continuous;
  shown.alarm = true;
  EXPECT_EQ(XhcWhb04b().display(shown)[0][4], 0xc0);
  shown.mode = Mode::feed;
  shown.selector = Selector::a;
  EXPECT_EQ(XhcWhb04b().display(shown)[0], (Report{6, 0xfe, 0xfd, 0xfe, 0xc2, 7, 0, 0}));
}

TEST(Display, invalid_numbers_are_tolerated) {
  Display shown;
  shown.work_mm = {std::numeric_limits<double>::quiet_NaN(), 1e300, -1e300, 0};
  shown.feed_mm_min = -1;
  const auto reports = XhcHb04().display(shown);
  EXPECT_EQ(reports[0], (FeatureReport{6, 0xfe, 0xfd, 0x0c, 0xff, 0xff, 0x0f, 0x27}));
  EXPECT_EQ(reports.size(), 6u);
}

/// Random bytes: wheel and ring events only for well-formed reports, never more than a byte can
/// encode, and keys are released only after they were pressed.
TEST(Decoder, survives_noise) {
  std::mt19937_64 random(11);
  for (const PendantId& id : pendant_ids) {
    const auto decoder = make_decoder(id.kind);
    std::multiset<Key> held;  // two codes may be the same key
    const std::size_t size = id.kind == Kind::hb04 ? 6 : id.kind == Kind::whb04b ? 8 : 5;
    for (int i = 0; i < test::scaled(20'000); ++i) {
      Bytes report(random() % 4 == 0 ? random() % 70 : size);
      for (auto& byte : report) byte = static_cast<std::uint8_t>(random());
      if (!report.empty() && random() % 2 == 0) report[0] = 4;
      const Events events = decoder->take(report);
      if (report.size() != size) {
        EXPECT_THAT(events, IsEmpty());
      }
      for (const Event& event : events) {
        EXPECT_LE(std::abs(event.count), event.kind == Event::Kind::spring ? 7 : 128);
        if (event.kind == Event::Kind::key_down) {
          held.insert(event.key);
        } else if (event.kind == Event::Kind::key_up) {
          const auto key = held.find(event.key);
          ASSERT_NE(key, held.end());
          held.erase(key);
        }
      }
    }
  }
}

TEST(Key, has_a_name_and_is_found_by_it) {
  for (int i = static_cast<int>(Key::stop); i < static_cast<int>(Key::count); ++i) {
    const Key key = static_cast<Key>(i);
    EXPECT_EQ(key_named(key_name(key)), key) << key_name(key);
  }
  EXPECT_FALSE(key_named(""));
  EXPECT_FALSE(key_named("none"));
  EXPECT_EQ(key_name(key_of_row(Key::macro_1, 16)), "macro-16");
  EXPECT_EQ(key_name(Key::button_15), "button-15");
}

}  // namespace
}  // namespace lamplock::pendant
