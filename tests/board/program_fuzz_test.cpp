// Anything at all at the cable of a virtual board: random bytes, spoilt lines, real-time bytes,
// settings. It never crashes, never leaves the work space, never fires, never shines by itself; it
// answers every line once, and it still answers at the end.
#include <fmt/format.h>

#include <random>

#include "tests/board/wire_host.hpp"

namespace lamplock::test {
namespace {

using Random = std::mt19937_64;

/// Watches the outputs that no program without a laser may switch on.
class QuietPins final : private sim::PinListener {
 public:
  explicit QuietPins(sim::PinBus& bus) {
    for (const sim::Pin pin : {sim::Pin::q_switch, sim::Pin::laser_gate, sim::Pin::shutter_1,
                               sim::Pin::shutter_2, sim::Pin::shutter_3, sim::Pin::shutter_4})
      bus.listen(pin, *this);
  }
  bool quiet() const { return quiet_; }

 private:
  void pin_changed(sim::Pin, bool level, sim::Picoseconds) override { quiet_ = quiet_ && !level; }
  bool quiet_ = true;
};

std::string random_line(Random& random) {
  static const std::array<const char*, 24> seeds{"G1 X10 Y5 F6000",
                                                 "G0 X-20 Y20 Z3",
                                                 "G2 X10 Y10 I5 J5 F3000",
                                                 "G3 X0 Y0 R12.5 F900",
                                                 "G91 G1 X-1.25 Y0.5 F600",
                                                 "G90 G17 G21 G94",
                                                 "G4 P0.05",
                                                 "G93 G1 X5 F20",
                                                 "G10 L2 P1 X1 Y2 Z3",
                                                 "G92 X0 Y0",
                                                 "G54 G0 X0 Y0",
                                                 "G28.1",
                                                 "G53 G0 X0",
                                                 "G5 I0 J3 P0 Q-3 X9 Y9",
                                                 "S500 F1000",
                                                 "N100 G1 X1.234567",
                                                 "(note) G1 X3 ; more",
                                                 "$G",
                                                 "$#",
                                                 "$I",
                                                 "$J=G91 X1 F600",
                                                 "G61.1 G1 X2 F500",
                                                 "G41 D1",
                                                 "M5"};
  std::string line = seeds[random() % seeds.size()];
  const auto printable = [&random] { return static_cast<char>(0x20 + random() % 0x5F); };
  for (std::uint64_t changes = random() % 4; changes > 0 && !line.empty(); --changes) {
    const std::size_t at = random() % line.size();
    switch (random() % 4) {
      case 0:
        line.erase(at, 1);
        break;
      case 1:
        line.insert(at, 1, printable());
        break;
      case 2:
        line[at] = printable();
        break;
      default:
        line.insert(at, line.substr(at, random() % 8));
    }
  }
  // No reset or hold by accident here, no laser, and no loader.
  std::erase_if(line, [](char c) { return c == '!' || c == '?' || c == '~'; });
  if (line.find_first_of("Mm") != std::string::npos) line = "M5";
  if (line.size() > 1 && line[0] == '$' && (line[1] == 'B' || line[1] == 'S')) line = "$G";
  return line;
}

class Fuzz : public testing::Test {
 protected:
  void expect_sound(Rig& rig, const QuietPins& pins) {
    EXPECT_TRUE(pins.quiet());
    EXPECT_EQ(rig.shots().size(), 0u);
    EXPECT_EQ(rig.board.world().beam().openings(), 0u);
  }
  /// Reset, unlocked, asked.
  static void expect_answers(WireHost& host) {
    host.send_byte('\n');
    host.send_byte(0x18);
    host.run_ms(1500);
    host.send("$X\n");
    host.run_ms(50);
    const auto texts = host.ask("$G\n");
    ASSERT_FALSE(texts.empty());
    EXPECT_EQ(texts.back(), "ok");
    EXPECT_NE(host.status(), "");
  }

  job::Profile profile_ = lamp_profile(100, settings::LampMode::free_beat);
};

TEST_F(Fuzz, RandomBytes) {
  for (int i = 0; i < scaled(6); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 100);
    SCOPED_TRACE(testing::Message() << "seed " << i + 100);
    Rig rig(profile_);
    WireHost host(rig);
    const QuietPins pins(rig.board.bus());
    for (int k = 0; k < 60; ++k) {
      std::string bytes(1 + random() % 40, ' ');
      for (char& c : bytes) c = static_cast<char>(random() % (k % 3 == 0 ? 256 : 128));
      host.send_some(bytes);
      host.run_ms(static_cast<double>(1 + random() % 10));
    }
    expect_sound(rig, pins);
    EXPECT_EQ(rig.monitor.violation(rig.board.stored_settings()), "");
    expect_answers(host);
  }
}

/// Valid lines, changed a little: one answer each, whatever they are.
TEST_F(Fuzz, SpoiltLines) {
  for (int i = 0; i < scaled(6); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 200);
    SCOPED_TRACE(testing::Message() << "seed " << i + 200);
    Rig rig(profile_);
    WireHost host(rig);
    host.run_ms(5);
    const QuietPins pins(rig.board.bus());
    for (int k = 0; k < 60; ++k) {
      const std::string line = random_line(random);
      const std::size_t before = host.answers().size();
      host.send(line + "\n");
      ASSERT_TRUE(host.wait_for(before + 1, 300)) << line << "\n" << host.status();
      host.run_ms(1);
      ASSERT_EQ(host.answers().size(), before + 1) << line;
      if (host.status().starts_with("<Alarm")) host.ask("$X\n");
    }
    expect_sound(rig, pins);
    const auto space = work_space(profile_.settings);
    for (int a = 0; a < 3; ++a)
      for (const PinMonitor::Step& step : rig.monitor.steps(a))
        ASSERT_TRUE(space.contains(a, step.position));
    expect_answers(host);
  }
}

/// Lines with real-time bytes between and inside of them. A reset throws lines away, so no more
/// answers than lines.
TEST_F(Fuzz, RealTimeBytesAnywhere) {
  constexpr std::string_view realtime = "?!!~~\x18\x84\x85\x90\x91\x92\x93\x94\x95\x96\x97\x99\x9A";
  for (int i = 0; i < scaled(6); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 300);
    SCOPED_TRACE(testing::Message() << "seed " << i + 300);
    Rig rig(profile_);
    WireHost host(rig);
    host.run_ms(5);
    const QuietPins pins(rig.board.bus());
    std::size_t lines = 0;
    for (int k = 0; k < 60; ++k) {
      std::string line = random_line(random) + "\n";
      for (std::uint64_t n = random() % 4; n > 0; --n)
        line.insert(random() % line.size(), 1, realtime[random() % realtime.size()]);
      host.send_some(line);
      ++lines;
      host.run_ms(static_cast<double>(random() % 30));
      if (random() % 8 == 0) {
        host.send_some("~$X\n");
        ++lines;
      }
    }
    host.run_ms(500);
    EXPECT_LE(host.answers().size(), lines);
    EXPECT_EQ(host.fault(), "");
    expect_sound(rig, pins);
    const auto space = work_space(profile_.settings);
    for (int a = 0; a < 3; ++a)
      for (const PinMonitor::Step& step : rig.monitor.steps(a))
        ASSERT_TRUE(space.contains(a, step.position));
    expect_answers(host);
  }
}

/// Whatever settings are accepted: a program afterwards runs or is refused.
TEST_F(Fuzz, SettingsOfAnyValue) {
  for (int i = 0; i < scaled(8); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 400);
    SCOPED_TRACE(testing::Message() << "seed " << i + 400);
    Rig rig(profile_);
    WireHost host(rig);
    host.run_ms(5);
    const QuietPins pins(rig.board.bus());
    std::string script;
    for (int k = 0; k < 40; ++k) {
      const settings::Row& row = settings::table[random() % settings::table.size()];
      const double span = std::log10(std::max(2.0, row.max_milli / 1e3));
      double value = std::pow(10, std::uniform_real_distribution<double>(-3, span)(random));
      if (random() % 4 == 0) value = -value;
      const std::string line = row.whole ? fmt::format("${}={:.0f}\n", row.number, value)
                                         : fmt::format("${}={:.3f}\n", row.number, value);
      const auto said = host.ask(line);
      ASSERT_FALSE(said.empty()) << script << line;
      if (said.back() == "ok") script += line;
    }
    const std::size_t before = host.answers().size();
    host.send("G21 G90\nG1 X0.01 F600\nG1 X0\n");
    host.run_ms(2000);
    EXPECT_LE(host.answers().size(), before + 3) << script;
    expect_sound(rig, pins);
    EXPECT_EQ(host.fault(), "") << script;
    expect_answers(host);
  }
}

}  // namespace
}  // namespace lamplock::test
