// The flash image with more lines than it has room for: each runs once, in order, and a stop acts
// when it arrives, however many lines wait before it.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tests/chip_board/chip_rig.hpp"
#include "tests/figure.hpp"

namespace lamplock::test {
namespace {

job::Profile quick_profile() {
  job::Profile profile = chip_profile();
  job::set_acceleration(profile, 10);
  job::state_setting(profile, Id::laser_mode, 1, "test");
  return profile;
}

/// Positions at which X reversed, in steps, and the last position.
std::vector<std::int32_t> turns(const PinMonitor& monitor) {
  std::vector<std::int32_t> places;
  const auto& steps = monitor.steps(0);
  for (std::size_t i = 0; i + 2 < steps.size(); ++i)
    if (steps[i].position == steps[i + 2].position) places.push_back(steps[i + 1].position);
  if (!steps.empty()) places.push_back(steps.back().position);
  return places;
}

/// A quarter of the lines; together a million in the complete run. Of fewer than 400 the board may
/// accept all before the host has to wait.
class LinesInBursts : public testing::TestWithParam<int> {
 protected:
  static std::size_t lines() {
    constexpr std::size_t in_complete_run = 250'000;
    return is_complete_run() ? in_complete_run
                             : std::max<std::size_t>(400, static_cast<std::size_t>(scaled(400)));
  }
};

TEST_P(LinesInBursts, EachIsAnsweredAndRunOnceAndInOrder) {
  job::Profile profile = quick_profile();
  job::set_acceleration(profile, 100);  // lines take about 1 ms
  const double per_mm = profile.settings.milli(Id::steps_per_mm_x) / 1000.0;
  ChipRig rig(profile);
  std::mt19937_64 random(static_cast<std::uint64_t>(GetParam()));
  const std::size_t lines = this->lines();
  std::vector<std::int32_t> wanted;
  std::string text = "G1 F6000\n";
  for (std::size_t i = 0; i < lines; ++i) {
    // Forth and back, never twice in a row to the same place.
    wanted.push_back(static_cast<std::int32_t>(i % 2 == 0 ? 4 + random() % 4 : random() % 4));
    text += fmt::format("X{:.4f} (a remark makes lines longer than they are slow)\n",
                        wanted.back() / per_mm);
  }
  const Picoseconds limit = rig.now() + (10 + static_cast<Picoseconds>(lines) / 50) * ps_per_s;
  for (std::size_t sent = 0; rig.now() < limit;) {
    const std::size_t burst = std::min<std::size_t>(random() % 3000, text.size() - sent);
    sent += rig.board.write({reinterpret_cast<const std::uint8_t*>(text.data()) + sent, burst});
    rig.run(static_cast<Picoseconds>(random() % 12) * ps_per_ms);
    if (random() % 3 == 0) rig.listen();
    if (rig.user.answers().size() == lines + 1) break;
  }
  EXPECT_EQ(rig.user.answers().size(), lines + 1);
  EXPECT_EQ(rig.user.errors(), 0u);
  rig.run(ps_per_s);  // until all planned motion is over
  EXPECT_THAT(turns(rig.monitor), testing::ElementsAreArray(wanted));
  EXPECT_GT(rig.board.usb_host().statistics().out_naks, 0u) << "the host never had to wait";
}

INSTANTIATE_TEST_SUITE_P(ChipFlood, LinesInBursts, testing::Range(0, 4));

/// Begins an activity and sends slow lines after it until the queue of lines, the ring and, with
/// enough lines, both buffers of the endpoint are full.
void flood(ChipRig& rig, std::string_view begin, std::string_view slow, std::size_t bytes) {
  rig.type(std::string(begin));
  rig.run(50 * ps_per_ms);
  std::string lines;
  while (lines.size() < bytes) lines += slow;
  for (int ms = 0; ms < 100; ++ms) {
    lines.erase(0, rig.type(lines));
    rig.run(ps_per_ms);
  }
}
constexpr std::string_view burn = "M3 S500\nG1 X10 F3000\n", slow_line = "G1 X0.01 F10\n";

/// Braking from 50 mm/s at 10 m/s2, ticks handed out ahead, and a packet.
constexpr Picoseconds at_rest_within = (5 + 30 + 1) * ps_per_ms;
/// The time of a packet, and 1 ms.
constexpr Picoseconds dark_within = 2 * ps_per_ms;

struct ChipStop {
  const char* name;
  std::function<void(ChipRig&)> make;
  const char* state;
  bool dark_at_once;
};

TEST(ChipFlood, StopsActWhenTheyArrive) {
  const auto typed = [](char byte) {
    return [byte](ChipRig& rig) { rig.type(std::string(1, byte)); };
  };
  const auto pin = [](sim::Pin at) { return [at](ChipRig& rig) { rig.set(at, true); }; };
  const ChipStop stops[] = {{"!", typed('!'), "<Hold:0", false},
                            {"0x18", typed('\x18'), "<Alarm", true},
                            {"0x84", typed('\x84'), "<Door", true},
                            {"door", pin(sim::Pin::door), "<Door", true},
                            {"e-stop", pin(sim::Pin::estop), "<Alarm", true}};
  for (const ChipStop& stop : stops) {
    SCOPED_TRACE(stop.name);
    ChipRig rig(quick_profile());
    flood(rig, burn, slow_line, 4000);
    ASSERT_EQ(rig.board.usb_host().unsent(), 0u);
    ASSERT_TRUE(rig.monitor.stepped(rig.now() - 5 * ps_per_ms, rig.now()));
    const Picoseconds stopped = rig.now();
    stop.make(rig);
    rig.run(400 * ps_per_ms);
    expect_figure(stop.name, rig.last_step() - stopped, -10,
                  static_cast<double>(at_rest_within) / ps_per_ms);
    const Picoseconds dark = stop.dark_at_once ? dark_within : at_rest_within;
    EXPECT_FALSE(rig.energy.any_high_within(stopped + dark, rig.now()));
    EXPECT_THAT(rig.status(), StartsWith(stop.state));
    EXPECT_EQ(rig.heard.find("ALARM:3") != std::string::npos, stop.name == std::string("0x18"));
  }
}

/// Also if answers are not read and the buffers of the PC fill up.
TEST(ChipFlood, AResetWorksInEveryState) {
  struct Activity {
    const char* name;
    const char* lines;
    const char* state;
    std::string_view slow = slow_line;
  };
  const Activity activities[] = {
      {"G1 with M4", "M4 S500\nG1 X30 F3000\n", "<Alarm"},
      {"jog", "$J=X30 F3000\n", "<Alarm", "$J=G91 X0.01 F10\n"},
      {"M0", "M3 S500\nM0\n", "<Idle"},
      {"probe", "G38.2 X30 F1200\n", "<Alarm"},
      {"dwell", "M3 S500\nG4 P30\n", "<Idle"},
      {"beat lock", "M3 S500\nM130 P0\nG1 X5 F600\nX10\nX15\nX20\n", "<Alarm"},
      {"hold", "M3 S500\nG1 X30 F3000\n!", "<Idle"},
      {"G0", "G0 X30\n", "<Alarm"},
      {"M6", "M3 S500\nT2 M6\n", "<Idle"},
      {"check", "$C\n", "<Idle"},
      {"sleep", "$SLP\n", "<Alarm"},
  };
  const auto count = static_cast<std::size_t>(scaled(std::size(activities)));
  for (std::size_t i = 0; i < std::min(count, std::size(activities)); ++i) {
    const Activity& activity = activities[i];
    SCOPED_TRACE(activity.name);
    ChipRig rig(quick_profile());
    flood(rig, activity.lines, activity.slow, 4000);
    const Picoseconds stopped = rig.now();
    rig.type("\x18");
    rig.run(200 * ps_per_ms);
    EXPECT_FALSE(rig.monitor.stepped(stopped + at_rest_within, rig.now()));
    EXPECT_FALSE(rig.energy.any_high_within(stopped + dark_within, rig.now()));
    rig.listen();
    EXPECT_THAT(rig.status(), StartsWith(activity.state));
  }
}

TEST(ChipFlood, AResetDropsWaitingLines) {
  ChipRig rig(quick_profile());
  flood(rig, burn, "G91 G1 X1 F10\n", 4000);
  rig.type("\x18");
  rig.run(200 * ps_per_ms);
  rig.listen();
  EXPECT_EQ(rig.answer("$X"), "[MSG:Caution: Unlocked]\r\nok\r\n");
  const Picoseconds unlocked = rig.now();
  rig.run(200 * ps_per_ms);
  EXPECT_FALSE(rig.monitor.stepped(unlocked, rig.now()));
  EXPECT_EQ(rig.answer("G91 G1 X1 F6000"), "ok\r\n");
}

/// Packets that the link's interrupt examines byte by byte come as fast as the bus carries them.
/// They must not keep the interrupts below it from filling ticks: the lattice would stop dead.
TEST(ChipFlood, RealTimeBytesStopNoMotion) {
  for (const std::string& bytes :
       {std::string(1, '?'), std::string("\x90\x99"), std::string("X\x90")}) {
    SCOPED_TRACE(testing::PrintToString(bytes));
    ChipRig rig(quick_profile());
    rig.type("G1 F6000 X12\nX0\n");
    rig.run(30 * ps_per_ms);
    const Picoseconds begin = rig.now();
    std::string packets;
    while (packets.size() < 8192) packets += bytes;
    for (std::size_t i = 200; i < packets.size(); i += 200) packets[i] = '\n';
    while (rig.now() < begin + 150 * ps_per_ms) {
      rig.type(packets);
      rig.run(ps_per_ms / 4);
    }
    EXPECT_TRUE(rig.monitor.stepped(begin, begin + 50 * ps_per_ms));
    EXPECT_TRUE(rig.user.run_until_idle(rig.now() + 10 * ps_per_s));
    EXPECT_EQ(rig.heard.find("ALARM"), std::string::npos);
    EXPECT_EQ(rig.heard.find("Started by"), rig.heard.rfind("Started by"));
    EXPECT_EQ(turns(rig.monitor).back(),
              0);  // a plan that was late brakes, and returns to its path
    EXPECT_EQ(rig.monitor.violation(quick_profile().settings), "");
  }
}

/// A byte waits in the PC's buffers once the board's buffers are full. Closing the port takes
/// effect at once.
TEST(ChipFlood, AFullCableIsStoppedByClosingThePort) {
  ChipRig rig(quick_profile());
  flood(rig, burn, slow_line, 100'000);
  EXPECT_GT(rig.board.usb_host().unsent(), 0u);
  rig.board.usb_host().set_dtr(false);
  const Picoseconds closed = rig.now();
  rig.run(200 * ps_per_ms);
  EXPECT_FALSE(rig.monitor.stepped(closed + at_rest_within, rig.now()));
  EXPECT_FALSE(rig.energy.any_high_within(closed + at_rest_within, rig.now()));
}

/// With a closed port, asleep, or without its cable, the host cannot stop the machine any more.
TEST(ChipHostGone, ItsMotionIsHeldAndDark) {
  using sim::chip::UsbHost;
  struct Way {
    const char* name;
    void (*go)(UsbHost&);
    void (*come)(UsbHost&);
  };
  const Way ways[] = {
      {"closed", [](UsbHost& host) { host.set_dtr(false); },
       [](UsbHost& host) { host.set_dtr(true); }},
      {"asleep", [](UsbHost& host) { host.suspend(); }, [](UsbHost& host) { host.resume(); }},
      {"unplugged", [](UsbHost& host) { host.unplug(); }, [](UsbHost& host) { host.plug(); }}};
  // Three milliseconds of silence on the bus mean suspend; the rest is as for any hold.
  constexpr Picoseconds held_within = 3 * ps_per_ms + at_rest_within;
  for (const Way& way : ways) {
    SCOPED_TRACE(way.name);
    ChipRig rig(quick_profile());
    rig.type("M3 S500\nG1 X30 F3000\nG1 X0\n");
    rig.run(100 * ps_per_ms);
    rig.listen();
    ASSERT_TRUE(rig.monitor.stepped(rig.now() - 5 * ps_per_ms, rig.now()));
    const Picoseconds gone = rig.now();
    way.go(rig.board.usb_host());
    rig.run(300 * ps_per_ms);
    expect_figure("last step after the host has gone", rig.last_step() - gone, 0,
                  static_cast<double>(held_within) / ps_per_ms);
    EXPECT_FALSE(rig.energy.any_high_within(gone + held_within, rig.now()));
    way.come(rig.board.usb_host());
    ASSERT_TRUE(rig.board.run_until_found(1000 * ps_per_ms));
    EXPECT_THAT(rig.status(), StartsWith("<Hold"));
    rig.type("~");
    rig.run(100 * ps_per_ms);
    EXPECT_TRUE(rig.monitor.stepped(rig.now() - 5 * ps_per_ms, rig.now()));
  }
}

}  // namespace
}  // namespace lamplock::test
