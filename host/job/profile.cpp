#include "host/job/profile.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "host/error.hpp"
#include "host/job/setting_range.hpp"
#include "host/units.hpp"
#include "shared/units.hpp"

namespace lamplock::job {
namespace {

using settings::Id;
using settings::Row;

}  // namespace

Profile default_profile() { return {}; }

void state_setting(Profile& profile, Id id, double value, const std::string& where) {
  const Row& row = settings::row(id);
  const double milli = std::round(value * milli_per_unit);
  const bool fits = milli >= static_cast<double>(std::numeric_limits<std::int32_t>::min()) &&
                    milli <= static_cast<double>(std::numeric_limits<std::int32_t>::max());
  if (!fits || !profile.settings.set_milli(id, static_cast<std::int32_t>(milli)))
    throw Error(Exit::bad_input, where, fmt::format("{} = {} is out of range", row.name, value),
                setting_range(row));
  // For many settings 0 means none, or no limit; a small number must not become 0.
  if (value != 0 && milli == 0)
    throw Error(Exit::bad_input, where,
                fmt::format("{} = {} would be rounded to 0", row.name, value),
                "settings have a resolution of 0.001; give 0 or at least that");
  profile.stated.set(static_cast<std::size_t>(id));
}

void set_lamp_hz(Profile& profile, double hz) {
  state_setting(profile, Id::lamp_frequency, hz, "--lamp");
}

void set_acceleration(Profile& profile, double m_s2) {
  for (int axis = 0; axis < max_axes; ++axis)
    state_setting(profile, settings::for_axis(Id::acceleration_x, axis), m_s2 * mm_s2_per_m_s2,
                  "--accel");
}

void set_speed(Profile& profile, double m_s) {
  for (int axis = 0; axis < max_axes; ++axis)
    state_setting(profile, settings::for_axis(Id::max_rate_x, axis), m_s * mm_min_per_m_s,
                  "--speed");
}

}  // namespace lamplock::job
