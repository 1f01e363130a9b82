// Step pulses of the flash image at the pads: high and low time of STEP, set-up and hold of DIR are
// at least as set, at the highest rate that the board takes, and from the moment that it has
// answered a setting; higher rates are refused with the highest one.
#include <fmt/format.h>

#include "shared/pulse_times.hpp"
#include "sim/chip_board/board_timing.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "tests/chip_board/board_bench.hpp"

namespace lamplock::test::pulse_times_test {
namespace {

/// Shortest and longest times between the edges of STEP and DIR of all axes.
class PulseWatch final : public sim::PinListener {
 public:
  explicit PulseWatch(sim::PinBus& bus) {
    for (int axis = 0; axis < max_axes; ++axis) {
      bus.listen(sim::step_pin(axis), *this);
      bus.listen(sim::dir_pin(axis), *this);
    }
  }
  void pin_changed(sim::Pin pin, bool level, Picoseconds at) override {
    Axis& axis = axes_[static_cast<std::size_t>(pin) / 2];
    if (static_cast<std::size_t>(pin) % 2 != 0) {
      min_hold = std::min(min_hold, at - axis.rose);
      axis.turned = at;
      ++turns;
    } else if (level) {
      min_low = std::min(min_low, at - axis.fell);
      min_setup = std::min(min_setup, at - axis.turned);
      axis.rose = at;
      ++pulses;
    } else {
      min_high = std::min(min_high, at - axis.rose);
      max_high = std::max(max_high, at - axis.rose);
      axis.fell = at;
    }
  }
  void restart() {
    min_high = min_low = min_setup = min_hold = sim::never;
    max_high = 0;
    pulses = turns = 0;
  }

  Picoseconds min_high = sim::never, max_high = 0, min_low = sim::never, min_setup = sim::never,
              min_hold = sim::never;
  std::size_t pulses = 0, turns = 0;

 private:
  static constexpr Picoseconds long_ago = -ps_per_s;
  struct Axis {
    Picoseconds rose = long_ago, fell = long_ago, turned = long_ago;
  };
  PerAxis<Axis> axes_{};
};

/// In nanoseconds.
struct Times {
  std::int32_t high = 500, low = 300, setup = 500, hold = 500;
};

void set_times(settings::Values& values, const Times& times) {
  ASSERT_TRUE(values.set_milli(Id::step_pulse, times.high));
  ASSERT_TRUE(values.set_milli(Id::step_low, times.low));
  ASSERT_TRUE(values.set_milli(Id::direction_setup, times.setup));
  ASSERT_TRUE(values.set_milli(Id::direction_hold, times.hold));
}

void expect_kept(const PulseWatch& watch, const Times& times) {
  EXPECT_GE(watch.min_high, times.high * ps_per_ns);
  EXPECT_GE(watch.min_low, times.low * ps_per_ns);
  EXPECT_GE(watch.min_setup, times.setup * ps_per_ns);
  EXPECT_GE(watch.min_hold, times.hold * ps_per_ns);
}

// --- the highest rate --------------------------------------------------------------------------

constexpr int fast_mm_s = 200;

/// A board and its map with four axes.
struct FastCase {
  Times times;
  const BoardRow* board = &boards::pico;
  boards::PinMap map = boards::PinMap::cut;
};

/// Four axes on a lamp, whose highest rate is the highest that the board takes.
job::Profile fast_profile(const FastCase& fast) {
  job::Profile profile = chip_profile(1000);
  settings::Values& values = profile.settings;
  set_times(values, fast.times);
  values.set_milli(Id::pin_map, static_cast<int>(fast.map) * 1000);
  values.set_milli(Id::axes, max_axes * 1000);
  for (int axis = 0; axis < max_axes; ++axis) {
    const auto put = [&values, axis](Id first, std::int64_t milli) {
      ASSERT_TRUE(values.set_milli(settings::for_axis(first, axis), static_cast<int>(milli)));
    };
    const std::int64_t steps_s =
        ticks_per_second * max_step_percent / 100 / pulse_times(values).period_ticks;
    put(Id::steps_per_mm_x, steps_s / fast_mm_s * 1000);
    put(Id::max_rate_x, max_rate_milli(values, axis));
    put(Id::acceleration_x, 20'000'000);
  }
  return profile;
}

job::Job fast_job(const job::Profile& profile) {
  const std::array<int, 5> places_mm{-9, 9, -9, 8, 0};
  geometry::PointCloud points;
  for (const int mm : places_mm) points.push_back({1.0 * mm, -1.0 * mm, 1.0 * mm});
  job::Job job = job::make_job(points, profile, {});
  const int steps_per_mm = profile.settings.whole(Id::steps_per_mm_x);
  for (std::size_t i = 0; i < places_mm.size(); ++i)
    for (std::size_t axis = 0; axis < max_axes; ++axis)
      job.targets[i].steps[axis] = places_mm[i] * (axis % 2 == 0 ? steps_per_mm : -steps_per_mm);
  return job;
}

class FastPulses : public testing::TestWithParam<FastCase> {};

TEST_P(FastPulses, AreAsLongAsSetOnFourAxesAtTheHighestRate) {
  const Times& times = GetParam().times;
  const sim::chip::Image& image = image_of(*GetParam().board);
  const job::Profile profile = fast_profile(GetParam());
  const job::Job job = fast_job(profile);
  ChipRig rig(profile.settings, world_for(profile), ChipRig::Power::off, image);
  const sim::BoardTiming timing(rig.board, image);
  const StepLog log(profile.settings, rig.board.bus());
  rig.boot();
  PulseWatch watch(rig.board.bus());
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job));
  const sim::TimingTable table =
      timing.table(profile.settings.milli(Id::q_switch_delay) * ps_per_us / 1000);
  std::printf("%s", sim::timing_text(table).c_str());
  EXPECT_EQ(table.step_error_worst_ns, 0);
  expect_kept(watch, times);
  const PulseTimes pulses = pulse_times(profile.settings);
  std::size_t closest = 0;
  for (int axis = 0; axis < max_axes; ++axis) {
    const auto& steps = log.steps()[index(axis)];
    ASSERT_GT(steps.size(), 1000u);
    EXPECT_EQ(steps.back().position, job.targets.back().steps[index(axis)]);
    // The highest rate is 98 % of one step a period: some steps are a tick later.
    const Picoseconds close = (pulses.period_ticks + 1 + pulses.period_ticks / 20) * ps_per_tick;
    for (std::size_t i = 1; i < steps.size(); ++i)
      closest += steps[i].at - steps[i - 1].at < close - ps_per_ns ? 1u : 0u;
  }
  EXPECT_GT(closest, watch.pulses / 2) << "most steps must be as close as they may";

  // Refused above, never clipped.
  for (int axis = 0; axis < max_axes; ++axis) {
    const int number = settings::number(settings::for_axis(Id::max_rate_x, axis));
    const auto most = static_cast<double>(max_rate_milli(profile.settings, axis)) / 1e3;
    EXPECT_EQ(rig.answer(fmt::format("${}={:.3f}", number, most + 0.001)),
              fmt::format("[MSG:${} at most {:.3f} mm/min with $0 and $1077]\r\nerror:12\r\n",
                          number, most));
  }
  EXPECT_EQ(rig.board.stored_settings(), profile.settings);
}

INSTANTIATE_TEST_SUITE_P(
    Times, FastPulses,
    testing::Values(FastCase{{2500, 2500, 5000, 5000}}, FastCase{{500, 500, 200, 200}},
                    FastCase{{600, 1700, 500, 500}}, FastCase{{10'000, 10'000, 10'000, 20'000}},
                    FastCase{
                        {2500, 2500, 5000, 5000}, &boards::skr_pico, boards::skr_pico.first_map}),
    [](const auto& fast) {
      return fmt::format("{}High{}Low{}", fast.param.board == &boards::pico ? "" : "Apart",
                         fast.param.times.high, fast.param.times.low);
    });

// --- settings that change ----------------------------------------------------------------------

/// Slow enough for the longest pulses.
job::Profile slow_profile() {
  job::Profile profile = chip_profile();
  profile.settings.set_milli(Id::lamp_mode, 0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto put = [&profile, axis](Id id, double value) {
      job::state_setting(profile, settings::for_axis(id, axis), value, "test");
    };
    put(Id::max_rate_x, 12'000);
    put(Id::speed_jump_x, 400);
  }
  return profile;
}

/// Turns at full speed.
constexpr std::string_view zigzag = "G91G1F12000X1Y-1Z1\nX-1Y1Z-1\nX.5\nX-.5\nG90G0X0Y0Z0\n";

/// Sends the lines and waits until the machine is at rest.
void run_lines(ProgramSender& sender, sim::Board& board, std::string_view lines) {
  sender.give(std::string(lines));
  const Picoseconds end = board.now() + 2 * ps_per_s;
  ASSERT_TRUE(sender.run_until_answered(end) && sender.run_until_idle(end));
}

TEST(PulseSettings, AreInForceWithTheirAnswerAndTheSameOnTheVirtualBoard) {
  const job::Profile profile = slow_profile();
  ChipRig rig(profile);
  sim::VirtualBoard other(profile.settings, world_for(profile));
  ProgramSender other_sender(other);
  other_sender.listen();
  PulseWatch watch(rig.board.bus()), other_watch(other.bus());
  // The drives of both worlds are those of the settings at the start, the shortest times.
  Times present;
  for (const Times& times :
       {Times{500, 300, 500, 500}, Times{2500, 2500, 500, 500}, Times{10'000, 300, 200, 200},
        Times{510, 10'000, 200, 50'000}, Times{10'000, 10'000, 50'000, 200},
        Times{400, 300, 200, 200}, Times{400, 10'000, 50'000, 50'000}}) {
    const auto send = [&](Id id, std::int32_t ns, std::int32_t before) {
      if (ns == before) return;
      const std::string line = fmt::format("${}={:.3f}", settings::number(id), ns / 1e3);
      EXPECT_EQ(rig.answer(line), "ok\r\n") << line;
      EXPECT_EQ(other_sender.answer(line, ps_per_s), "ok\r\n") << line;
    };
    send(Id::step_pulse, times.high, present.high);
    send(Id::step_low, times.low, present.low);
    send(Id::direction_setup, times.setup, present.setup);
    send(Id::direction_hold, times.hold, present.hold);
    present = times;
    SCOPED_TRACE(fmt::format("high {}, low {}, set-up {}, hold {}", times.high, times.low,
                             times.setup, times.hold));
    for (PulseWatch* each : {&watch, &other_watch}) each->restart();
    ASSERT_NO_FATAL_FAILURE(run_lines(rig.user, rig.board, zigzag));
    ASSERT_NO_FATAL_FAILURE(run_lines(other_sender, other, zigzag));
    for (const PulseWatch* each : {&watch, &other_watch}) {
      expect_kept(*each, times);
      EXPECT_EQ(each->pulses, 1400u);
      EXPECT_GE(each->turns, 5u) << "X turns three times, Y and Z once";
    }
    // A short pulse ends with the tick line, rounded up to a clock.
    settings::Values values = profile.settings;
    set_times(values, times);
    const std::uint32_t high_ticks = pulse_times(values).high_ticks;
    const Picoseconds high =
        high_ticks == 0 ? short_pulse_ns * ps_per_ns : high_ticks * ps_per_tick;
    EXPECT_EQ(other_watch.max_high, high);
    EXPECT_LE(watch.max_high, high + rig.clock());
    EXPECT_EQ(watch.min_high, watch.max_high);
    EXPECT_EQ(rig.board.world().drives().position(), StepPosition{});
    EXPECT_EQ(other.world().drives().position(), StepPosition{});
  }
  // The rates of the axes leave no time for these.
  EXPECT_EQ(rig.answer("$0=0.5"), "ok\r\n");
  EXPECT_EQ(rig.answer("$110=60000"),
            "[MSG:$110 at most 22615.384 mm/min with $0 and $1077]\r\nerror:12\r\n");
}

}  // namespace
}  // namespace lamplock::test::pulse_times_test
