#include "host/job/rate_excess.hpp"

#include <fmt/format.h>

#include "host/units.hpp"
#include "shared/pulse_times.hpp"

namespace lamplock::job {

std::optional<RateExcessWords> rate_excess_words(const settings::Values& values) {
  using settings::Id;
  const settings::RateExcess excess = settings::rate_excess(values);
  if (excess.axis < 0) return std::nullopt;
  const Id id = settings::for_axis(Id::max_rate_x, excess.axis);
  const std::string what =
      excess.is_shared ? "max_rate_x and max_rate_y together" : std::string(settings::row(id).name);
  return RateExcessWords{id,
                         fmt::format("{} may be at most {:.10g} mm/min with the present pulses",
                                     what, static_cast<double>(excess.max_milli) / milli_per_unit),
                         "lower it, or shorten step_pulse or step_low"};
}

Error no_motion(const settings::Values& values, std::uint16_t setting) {
  const auto excess = rate_excess_words(values);
  if (excess && settings::row(excess->id).number == setting)
    return {Exit::bad_input, fmt::format("${}", setting), excess->limit, excess->remedy};
  return {Exit::bad_input, fmt::format("${}", setting), "no motion is possible with its value",
          "change it in the machine profile"};
}

}  // namespace lamplock::job
