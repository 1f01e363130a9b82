#include "firmware/machine/motion_output.hpp"

namespace lamplock::machine {

void MotionOutput::set_lags(const settings::Values& values) {
  for (int a = 0; a < max_axes; ++a) {
    const std::int32_t lag_ns =
        a < values.whole(settings::Id::axes) ? values.milli(settings::Id::drive_lag_x, a) : 0;
    lag_clocks_[index(a)] = static_cast<std::uint32_t>(lag_ns) / 1000 * clocks_per_us +
                            static_cast<std::uint32_t>(lag_ns) % 1000 * clocks_per_us / 1000;
  }
}

// What a tick takes may have changed since the last start.
void MotionOutput::set_leads(lamp::BeatClock& clock) {
  PerAxis<std::uint32_t> leads{};
  for (int a = 0; a < max_axes; ++a) leads[index(a)] = clock.ticks_in(lag_clocks_[index(a)]);
  generator_.set_leads(leads);
  clock.set_lead(generator_.lead());
}

}  // namespace lamplock::machine
