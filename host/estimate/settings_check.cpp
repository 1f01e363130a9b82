#include "host/estimate/settings_check.hpp"

#include <fmt/format.h>

#include <string>

#include "firmware/lamp/protection.hpp"
#include "firmware/motion/profile/limits.hpp"
#include "host/error.hpp"
#include "host/job/rate_excess.hpp"
#include "host/job/setting_range.hpp"
#include "host/units.hpp"
#include "shared/beat.hpp"
#include "shared/kinematics.hpp"

namespace lamplock::estimate {
namespace {

using settings::Id;

/// Number of a setting that contradicts others; 0 if there is none. Throws the error of the job
/// room where no motion is possible.
std::uint16_t contradicting(const settings::Values& values) {
  if (const auto excess = job::rate_excess_words(values))
    throw job::no_motion(values, settings::number(excess->id));
  motion::Limits limits;
  std::uint16_t setting = broken_kinematics(values);
  if (setting != 0) return setting;
  if (motion::make_limits(values, beat_ticks(values), full_tick_q16, limits, setting) == Result::ok)
    return lamp::broken_protection(values);
  if (setting != settings::number(Id::q_switch_width)) throw job::no_motion(values, setting);
  return setting;
}

struct Explanation {
  std::string why, remedy;
};

Explanation explain(Id id, const settings::Values& values) {
  const auto value = [&values](Id of) {
    return fmt::format("{:.10g}{}", in_units(values, of), job::unit_suffix(settings::row(of)));
  };
  switch (id) {
    case Id::q_switch_width:
      return {fmt::format("with q_switch_delay = {} a shot does not end within a beat at {}",
                          value(Id::q_switch_delay), value(Id::lamp_frequency)),
              "give a shorter q_switch_width in the profile of the machine, or a lower --lamp"};
    case Id::lamp_frequency:
      return {fmt::format("a lamp that the machine triggers may flash at {} (max_lamp_frequency)",
                          value(Id::max_lamp_frequency)),
              "give a lower --lamp, or the lamp's own max_lamp_frequency in the profile of the "
              "machine"};
    case Id::lamp_energy:
      if (values.milli(Id::lamp_energy) == 0)
        return {"a machine that triggers its lamp must know the energy of a flash",
                "give lamp_energy in the profile of the machine (--machine)"};
      return {fmt::format("max_lamp_energy is {}, lamp_power {} at {}", value(Id::max_lamp_energy),
                          value(Id::lamp_power), value(Id::lamp_frequency)),
              "give a lower lamp_energy in the profile of the machine, or a lower --lamp"};
    case Id::sensor_time:
      return {fmt::format("the photosensor does not answer within a beat at {}",
                          value(Id::lamp_frequency)),
              "give a shorter sensor_time in the profile of the machine, or a lower --lamp"};
    default:
      return {"it contradicts the other settings of the job",
              "change it in the profile of the machine (--machine)"};
  }
}

}  // namespace

void check_settings(const settings::Values& values) {
  const std::uint16_t number = contradicting(values);
  if (number == 0) return;
  const Id id = settings::find_number(number);
  const settings::Row& row = settings::row(id);
  const auto [why, remedy] = explain(id, values);
  throw Error(Exit::bad_input,
              fmt::format("{} = {:.10g}{}", row.name, in_units(values, id), job::unit_suffix(row)),
              why, remedy);
}

}  // namespace lamplock::estimate
