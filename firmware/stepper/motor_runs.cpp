#include "firmware/stepper/motor_runs.hpp"

namespace lamplock::stepper {
namespace {

constexpr Int128 half_step = middle_of_step(0);

/// Mean of two numbers that are both even or both odd; their sum may not fit.
constexpr std::int64_t mean(std::int64_t a, std::int64_t b) {
  return (a >> 1) + (b >> 1) + (a & 1);
}

}  // namespace

AxisRun motor_run(const AxisPair& pair, const AxisRun& u, const AxisRun& v, bool second) {
  const bool core = pair.kind == AxisPair::Kind::core;
  if (!core && !second) return u;
  const Int128 from_middle_q64 = v.position_q64 - half_step;
  if (core && second)
    return {u.position_q64 - from_middle_q64, u.rate_q62 - v.rate_q62, u.accel_q62 - v.accel_q62};
  return {u.position_q64 + from_middle_q64, u.rate_q62 + v.rate_q62, u.accel_q62 + v.accel_q62};
}

[[gnu::cold]] AxisRuns axis_runs(const AxisPair& pair, const AxisRun& first,
                                 const AxisRun& second) {
  if (pair.kind == AxisPair::Kind::ganged)
    return {first,
            {second.position_q64 - first.position_q64 + half_step, second.rate_q62 - first.rate_q62,
             second.accel_q62 - first.accel_q62}};
  const Int128 sum = first.position_q64 + second.position_q64;
  const Int128 difference = first.position_q64 - second.position_q64;
  return {
      {sum >> 1, mean(first.rate_q62, second.rate_q62), mean(first.accel_q62, second.accel_q62)},
      {(difference >> 1) + half_step, mean(first.rate_q62, -second.rate_q62),
       mean(first.accel_q62, -second.accel_q62)}};
}

[[gnu::cold]] void snap_to_motors(const AxisPair& pair, Int128& first_q64, Int128& second_q64) {
  const auto motor = [&](bool second) -> AxisRun {
    return {middle_of_step(motor_run(pair, {first_q64}, {second_q64}, second).step())};
  };
  const AxisRuns axes = axis_runs(pair, motor(false), motor(true));
  first_q64 = axes.first.position_q64;
  second_q64 = axes.second.position_q64;
}

std::uint32_t ticks_one_way(const AxisRun& run, std::uint32_t n) {
  const bool back = run.backwards();
  if (back == (run.accel_q62 < 0) || run.accel_q62 == 0) return n;
  const auto turned = [&run, back](std::uint32_t tick) {
    const std::int64_t rate = run.rate_q62 + short_product(run.accel_q62, tick);
    return back ? rate > 0 : rate < 0;
  };
  if (!turned(n - 1)) return n;
  std::uint32_t low = 0, high = n - 1;  // not turned, turned
  while (high - low > 1) {
    const std::uint32_t middle = (low + high) / 2;
    (turned(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace lamplock::stepper
