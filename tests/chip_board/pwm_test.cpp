// LASER PWM after its low-pass: power is the fraction of the time in which the pin is high,
// reported with the time from which it applies. The test writes duties to the chip's PWM itself and
// monitors the pin.
#include <random>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

constexpr std::uint32_t period_counts = 2000;  // laser_pwm.hpp
constexpr Picoseconds clock = 8 * ps_per_ns;
constexpr Picoseconds period = period_counts * clock;

/// Total time with the pin high.
class HighTime final : public sim::chip::PadListener {
 public:
  explicit HighTime(sim::chip::Chip& chip) : chip_(chip) { chip.gpio().listen(*this); }
  HighTime(const HighTime&) = delete;
  HighTime& operator=(const HighTime&) = delete;

  void pad_changed(unsigned gpio, bool level, sim::chip::Cycle at) override {
    if (gpio != EnergyPads::pwm) return;
    const Picoseconds time = chip_.wheel().time_of(at);
    if (!level) sum_ += time - edge_;
    edge_ = time;
    level_ = level;
  }
  Picoseconds up_to(Picoseconds now) const { return level_ ? sum_ + now - edge_ : sum_; }
  bool level() const { return level_; }
  /// The latest edge.
  Picoseconds edge() const { return edge_; }

 private:
  sim::chip::Chip& chip_;
  Picoseconds sum_ = 0, edge_ = 0;
  bool level_ = false;
};

/// The reported powers.
class PowerLog final : public sim::PowerListener {
 public:
  struct Change {
    std::uint16_t power;
    Picoseconds at;
  };
  explicit PowerLog(sim::PinBus& bus) { bus.listen_to_power(*this); }
  PowerLog(const PowerLog&) = delete;
  PowerLog& operator=(const PowerLog&) = delete;

  void power_changed(std::uint16_t power, Picoseconds at) override {
    if (!changes_.empty()) {
      EXPECT_GE(at, changes_.back().at) << "change " << changes_.size();
    }
    changes_.push_back({power, at});
  }
  const std::vector<Change>& changes() const { return changes_; }
  std::uint16_t power() const {
    return changes_.empty() ? std::uint16_t{0} : changes_.back().power;
  }
  /// Time at full power with the same energy.
  double energy_ps(Picoseconds end) const {
    double sum = 0;
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      const Picoseconds to = i + 1 < changes_.size() ? changes_[i + 1].at : end;
      sum += static_cast<double>(to - changes_[i].at) * changes_[i].power / 65'535.0;
    }
    return sum;
  }

 private:
  std::vector<Change> changes_;
};

class LaserPwm : public testing::Test {
 protected:
  void SetUp() override {
    rig_.boot();
    ASSERT_EQ(log_.power(), 0);
  }
  /// Sets the high counts per period, from the next period on.
  void put(std::uint32_t counts) {
    constexpr std::uint32_t slice = EnergyPads::pwm / 2 % 8, channel = EnergyPads::pwm % 2;
    constexpr std::uint32_t compare = 0x4005'000c + 0x14 * slice;  // PWM CHn_CC
    rig_.board.chip().bus().write(compare, counts << (16 * channel), sim::chip::Width::word,
                                  sim::chip::Master::core0, rig_.board.chip().now());
  }
  static std::uint16_t power_of(std::uint32_t counts) {
    return static_cast<std::uint16_t>(counts * 65'535 / period_counts);
  }
  /// Runs until the last duty is at the pin and reported.
  void settle() { rig_.run(3 * period); }

  ChipRig rig_{chip_profile(), ChipRig::Power::off};
  HighTime pin_{rig_.board.chip()};
  PowerLog log_{rig_.board.bus()};
};

TEST_F(LaserPwm, PowerIsTheDuty) {
  for (const std::uint32_t counts : {1u, 500u, 1999u, 1000u, 2000u, 3u, 0u, 2000u, 2u, 1999u, 0u}) {
    put(counts);
    settle();
    EXPECT_EQ(log_.power(), power_of(counts)) << counts;
  }
}

TEST_F(LaserPwm, OffIsReportedFromTheEndOfTheLastPeriodAndFullFromItsBegin) {
  put(700);
  settle();
  const std::size_t before = log_.changes().size();
  put(0);
  settle();
  ASSERT_EQ(log_.changes().size(), before + 1);
  // The last pulse, 700 counts long, has ended; its period counts as a whole.
  EXPECT_EQ(log_.changes().back().at, pin_.edge() + period - 700 * clock);
  put(period_counts);
  settle();
  ASSERT_EQ(log_.changes().size(), before + 2);
  EXPECT_EQ(log_.power(), 65'535);
  EXPECT_TRUE(pin_.level());
  EXPECT_EQ(log_.changes().back().at, pin_.edge());
  put(0);
  settle();
  ASSERT_EQ(log_.changes().size(), before + 3);
  EXPECT_EQ(log_.changes().back().at, pin_.edge());
}

/// Duties of a program that follows the speed, and pulses of one period or none.
TEST_F(LaserPwm, EnergyIsTheTimeThatThePinIsHigh) {
  std::mt19937_64 random(1);
  const Pick<std::uint32_t> pick(random);
  const Picoseconds begin = rig_.now();
  const int changes = scaled(400);
  for (int i = 0; i < changes; ++i) {
    const std::uint32_t kind = pick(0, 4);
    put(kind == 0 ? 0 : kind == 1 ? period_counts : pick(1, period_counts - 1));
    rig_.run(pick(1, kind < 2 ? 100 : 40) * ps_per_us);
  }
  put(0);
  settle();
  const double high = static_cast<double>(pin_.up_to(rig_.now()));
  ASSERT_GT(high, 0.2 * static_cast<double>(rig_.now() - begin));
  // A duty is rounded to 1/65535 of a period.
  const double periods = static_cast<double>(rig_.now() - begin) / static_cast<double>(period);
  std::cout << high / 1e6 << " us high, power " << log_.energy_ps(rig_.now()) / 1e6 << " us\n";
  EXPECT_NEAR(log_.energy_ps(rig_.now()), high, periods * static_cast<double>(period) / 65'535);
}

}  // namespace
}  // namespace lamplock::test
