// Arbitrary input at the cable of a virtual board: random bytes, corrupted lines, real-time bytes,
// settings. The board never crashes, leaves the work space or fires; it is dark before M3 or M4, at
// rest and while the door is open; it answers every line once and still answers at the end.
#include <fmt/format.h>

#include <algorithm>
#include <random>

#include "firmware/motion/profile/limits.hpp"
#include "tests/board/program_host.hpp"

namespace lamplock::test {
namespace {

using Random = std::mt19937_64;

/// Times at which any axis moves, from the ticks that are output.
class MotionTimes final : public sim::TickListener {
 public:
  explicit MotionTimes(sim::VirtualBoard& board) { board.listen(*this); }
  void ticks_played(const sim::PlayedTicks& played) override {
    const auto& axes = played.block.axis;
    const bool moves =
        played.block.moving &&
        std::any_of(axes.begin(), axes.end(), [](const auto& run) { return !run.is_at_rest(); });
    if (!moves) return;
    if (times_.empty() || times_.back().end < played.start)
      times_.push_back({played.start, played.end});
    else
      times_.back().end = played.end;
  }
  void beat_begins(std::uint64_t /*tick*/, Picoseconds /*at*/) override {}

  /// Light at rest, for longer than the tick in which an axis turns.
  bool shone_at_rest(const sim::Beam& beam, Picoseconds now) const {
    constexpr Picoseconds turn = 5 * ps_per_us;
    Picoseconds rest = 0;
    for (const Time& time : times_) {
      if (time.start - rest > 2 * turn && beam.shone(rest + turn, time.start - turn)) return true;
      rest = time.end;
    }
    return now - rest > turn && beam.shone(rest + turn, now);
  }

 private:
  struct Time {
    Picoseconds start, end;
  };
  std::vector<Time> times_;
};

/// True if the line has an M word that does not switch a laser; other tests cover those.
bool has_other_m_words(std::string_view line) {
  for (std::size_t at = line.find_first_of("Mm"); at != std::string_view::npos;
       at = line.find_first_of("Mm", at + 1))
    if (at + 1 == line.size() || line[at + 1] < '3' || line[at + 1] > '5') return true;
  return false;
}

/// Longest dwell of the line, seconds; 0 if it has none.
double dwell_s(std::string line) {
  std::erase(line, ' ');
  const std::size_t at = line.find_first_of("Pp");
  return at == std::string::npos ? 0 : std::strtod(line.c_str() + at + 1, nullptr);
}

/// Before and after the first command for the laser.
enum class Light { not_asked_for, asked_for };

std::string random_line(Random& random, Light light) {
  static const std::array<const char*, 34> seeds{"M3 S500",
                                                 "M4 S900",
                                                 "M3 S1000 G1 X5 F3000",
                                                 "M4 S700 G1 X-5 Y3 F5000",
                                                 "S200",
                                                 "G1 X-3 Y-8 F1500 S1000",
                                                 "G1 X10 Y5 F6000",
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
                                                 "G41.1 D0.2",
                                                 "G42.1 D1 G1 X5 F600",
                                                 "G3 X2 Y2 J1",
                                                 "G40",
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
  // No accidental reset, hold or loader.
  std::erase_if(line, [](char c) { return c == '!' || c == '?' || c == '~'; });
  const bool m_word = line.find_first_of("Mm") != std::string::npos;
  if (m_word && (light == Light::not_asked_for || has_other_m_words(line))) line = "M5";
  if (dwell_s(line) > 100) line = "G4 P0.05";
  if (line.size() > 1 && line[0] == '$' && (line[1] == 'B' || line[1] == 'S')) line = "$G";
  return line;
}

class Fuzz : public testing::Test {
 protected:
  /// No program may switch on the Q-switch or a shutter.
  static void expect_no_shots(const Rig& rig) {
    EXPECT_TRUE(rig.monitor.fires().empty());
    EXPECT_EQ(rig.monitor.openings(), 0);
    EXPECT_EQ(rig.shots().size(), 0u);
  }
  static void expect_dark(Rig& rig) { EXPECT_EQ(rig.board.world().beam().openings(), 0u); }
  void expect_inside(const Rig& rig) const {
    const auto space = work_space(profile_.settings);
    for (int a = 0; a < 3; ++a)
      for (const PinMonitor::Step& step : rig.monitor.steps(a))
        ASSERT_TRUE(space.contains(a, step.position));
  }
  /// After a reset and an unlock the board answers.
  static void expect_answers(Rig& rig, ProgramHost& host) {
    host.send("\n");
    host.run_ms(50);
    const std::size_t banners = host.count(Said::banner);
    host.send(0x18);
    const double limit_ms = 1500 + 1000 * max_stop_s(rig.board.stored_settings());
    for (int ms = 0; ms < limit_ms && host.count(Said::banner) == banners; ++ms) host.run_ms(1);
    host.run_ms(50);
    host.send("$X\n");
    host.run_ms(50);
    const auto texts = host.ask("$G\n");
    ASSERT_FALSE(texts.empty());
    EXPECT_EQ(texts.back(), "ok");
    EXPECT_NE(host.status(), "<silence>");
  }
  /// Longest time in which an axis comes to rest by its settings, in moves of at most 0.1 mm or a
  /// step and with only the acceleration that jerk permits at once: the same fraction of it on
  /// every axis, as for lines (line/rise.hpp).
  static double max_stop_s(const settings::Values& values) {
    constexpr double at_once_s = motion::flat_rise_ticks * 1e-6;
    double share = 1;
    for (int a = 0; a < values.whole(Id::axes); ++a) {
      const double jerk_mm_s3 = values.milli(Id::jerk_x, a);
      const double accel_mm_s2 = values.milli(Id::acceleration_x, a) / 1e3;
      if (jerk_mm_s3 != 0) share = std::min(share, jerk_mm_s3 * at_once_s / accel_mm_s2);
    }
    double longest = 0;
    for (int a = 0; a < values.whole(Id::axes); ++a) {
      const double way_mm = std::max(0.1, 1e3 / values.milli(Id::steps_per_mm_x, a));
      const double accel_mm_s2 = share * values.milli(Id::acceleration_x, a) / 1e3;
      longest = std::max(longest, 2 * std::sqrt(way_mm / accel_mm_s2));
    }
    return longest;
  }

  void use_laser() { job::state_setting(profile_, Id::laser_mode, 1, "test"); }

  job::Profile profile_ = program_profile();
};

TEST_F(Fuzz, RandomBytes) {
  for (int i = 0; i < scaled(6); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 100);
    SCOPED_TRACE(testing::Message() << "seed " << i + 100);
    Rig rig(profile_);
    ProgramHost host(rig, ProgramHost::Banner::kept);
    for (int k = 0; k < 60; ++k) {
      std::string bytes(1 + random() % 40, ' ');
      for (char& c : bytes) c = static_cast<char>(random() % (k % 3 == 0 ? 256 : 128));
      host.send_some(bytes);
      host.run_ms(static_cast<double>(1 + random() % 10));
    }
    expect_no_shots(rig);
    expect_dark(rig);
    EXPECT_EQ(rig.monitor.violation(rig.board.stored_settings()), "");
    expect_answers(rig, host);
  }
}

/// Valid lines with small changes: one answer each, whatever they are.
TEST_F(Fuzz, CorruptedLines) {
  use_laser();
  std::size_t openings = 0;
  for (int i = 0; i < scaled(6); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 200);
    SCOPED_TRACE(testing::Message() << "seed " << i + 200);
    Rig rig(profile_);
    ProgramHost host(rig, ProgramHost::Banner::kept);
    host.run_ms(5);
    const MotionTimes motion(rig.board);
    for (int k = 0; k < 80; ++k) {
      if (k == 20) expect_dark(rig);
      const std::string line =
          random_line(random, k < 20 ? Light::not_asked_for : Light::asked_for);
      const std::size_t before = host.answers().size();
      host.send(line + "\n");
      ASSERT_TRUE(host.wait_for(before + 1, 5000)) << line << "\n" << host.status();
      host.run_ms(1);
      ASSERT_EQ(host.answers().size(), before + 1) << line;
      if (host.status().starts_with("<Alarm")) host.ask("$X\n");
      // The moves take longer than their lines: without waiting the run would end while M3 and M4
      // are still in the queue. A slow feed may take longer than this.
      if (k % 40 == 39) host.wait_for_rest(5);
    }
    expect_no_shots(rig);
    EXPECT_FALSE(motion.shone_at_rest(rig.board.world().beam(), rig.now()));
    openings += rig.board.world().beam().openings();
    ASSERT_NO_FATAL_FAILURE(expect_inside(rig));
    expect_answers(rig, host);
  }
  EXPECT_TRUE(openings != 0 || scaled(6) < 6) << "no run had light";
}

/// Lines with real-time bytes between and inside them. A reset drops lines, so there are at most as
/// many answers as lines.
TEST_F(Fuzz, RealTimeBytesAnywhere) {
  use_laser();
  std::size_t openings = 0;
  constexpr std::string_view realtime = "?!!~~\x18\x84\x85\x90\x91\x92\x93\x94\x95\x96\x97\x99\x9A";
  for (int i = 0; i < scaled(6); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 300);
    SCOPED_TRACE(testing::Message() << "seed " << i + 300);
    Rig rig(profile_);
    ProgramHost host(rig, ProgramHost::Banner::kept);
    host.run_ms(5);
    const MotionTimes motion(rig.board);
    const sim::Beam& beam = rig.board.world().beam();
    std::size_t lines = 0;
    for (int k = 0; k < 80; ++k) {
      if (k == 20) expect_dark(rig);
      std::string line =
          random_line(random, k < 20 ? Light::not_asked_for : Light::asked_for) + "\n";
      for (std::uint64_t n = random() % 4; n > 0; --n)
        line.insert(random() % line.size(), 1, realtime[random() % realtime.size()]);
      host.send_some(line);
      ++lines;
      host.run_ms(static_cast<double>(random() % 30));
      if (random() % 8 == 0) {
        host.send_some("~$X\n");
        ++lines;
      }
      if (random() % 12 != 0) continue;
      const Picoseconds opened = rig.now();
      rig.board.world().schedule(sim::Pin::door, true, opened);
      host.run_ms(static_cast<double>(2 + random() % 30));
      EXPECT_FALSE(beam.shone(opened + ps_per_ms, rig.now()));
      rig.set(sim::Pin::door, false);
      host.run_ms(1);
    }
    host.run_ms(500);
    EXPECT_FALSE(motion.shone_at_rest(beam, rig.now()));
    openings += beam.openings();
    EXPECT_LE(host.answers().size(), lines);
    EXPECT_EQ(host.fault(), "");
    expect_no_shots(rig);
    ASSERT_NO_FATAL_FAILURE(expect_inside(rig));
    expect_answers(rig, host);
  }
  EXPECT_TRUE(openings != 0 || scaled(6) < 6) << "no run had light";
}

/// After any accepted settings a program runs or is refused.
TEST_F(Fuzz, SettingsOfAnyValue) {
  for (int i = 0; i < scaled(8); ++i) {
    Random random(static_cast<std::uint64_t>(i) + 400);
    SCOPED_TRACE(testing::Message() << "seed " << i + 400);
    Rig rig(profile_);
    ProgramHost host(rig, ProgramHost::Banner::kept);
    host.run_ms(5);
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
    expect_no_shots(rig);
    expect_dark(rig);
    EXPECT_EQ(host.fault(), "") << script;
    expect_answers(rig, host);
  }
}

}  // namespace
}  // namespace lamplock::test
