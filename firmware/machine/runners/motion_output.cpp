#include "firmware/machine/runners/motion_output.hpp"

namespace lamplock::machine {
namespace {

std::uint32_t clocks_of(std::uint32_t ns) {
  return ns / 1000 * clocks_per_us + ns % 1000 * clocks_per_us / 1000;
}

}  // namespace

void MotionOutput::set_lags(const settings::Values& values) {
  for (int a = 0; a < max_axes; ++a) {
    const std::int32_t lag_ns =
        a < values.whole(settings::Id::axes) ? values.milli(settings::Id::drive_lag_x, a) : 0;
    lag_clocks_[index(a)] = clocks_of(static_cast<std::uint32_t>(lag_ns));
  }
  // Of two axes that share motors, the slower drive sets both lags.
  for (const AxisPair& pair : generator_.kinematics().pairs()) {
    std::uint32_t &u = lag_clocks_[pair.first], &v = lag_clocks_[pair.second];
    u = v = u > v ? u : v;
  }
  const std::int32_t lead_ns = values.milli(settings::Id::laser_lead);
  const auto lead = static_cast<std::int32_t>(
      clocks_of(static_cast<std::uint32_t>(lead_ns < 0 ? -lead_ns : lead_ns)));
  laser_lead_clocks_ = lead_ns < 0 ? -lead : lead;
}

// The length of a tick may have changed since the last start.
void MotionOutput::set_leads(lamp::BeatClock& clock) {
  PerAxis<std::uint32_t> leads{};
  for (int a = 0; a < max_axes; ++a) leads[index(a)] = clock.ticks_in(lag_clocks_[index(a)]);
  const bool later = laser_lead_clocks_ < 0;
  const auto laser = static_cast<std::int32_t>(
      clock.ticks_in(static_cast<std::uint32_t>(later ? -laser_lead_clocks_ : laser_lead_clocks_)));
  generator_.set_leads(leads, later ? -laser : laser);
  clock.set_lead(generator_.lead());
}

}  // namespace lamplock::machine
