// The loop that holds a temperature, while programs and jobs of rows run.
#include "firmware/machine/work.hpp"

#if LAMPLOCK_SENSOR_SETTINGS
namespace lamplock::machine {
namespace {

// A constant, because the compiler would count its characters at run time.
constexpr std::string_view sensor_failed =
    "SENSOR out of range, laser off: check it and $1068, $1069, then '~'";

}  // namespace

// Called with beat and fill interrupts masked, as all of prepare() is.
void MachineWork::follow_temperature() {
  const auto clock = static_cast<std::uint32_t>(now_);
  const bool runs = program_.begun() && machine_.running() && !machine_.jogs() && !machine_.homes();
  loop_.watch(values_, clock, runs);
  if (runs && loop_.failed()) {
    report_message(sensor_failed);
    handle(Event::hold, wire::HoldReason::sensor);
  }
  if (!loop_.take_period(clock)) return;
  const std::uint32_t before = loop_.percent();
  if (program_.begun())
    loop_.step(values_, motion_.generator().in_light());
  else
    loop_.rest(values_);
  if (loop_.mode(values_) == settings::LoopMode::power) {
    motion_.generator().set_power_scale(loop_.scale_q15());
    if (program_.shines_at_rest()) motion_.generator().limit_power_scale();
  } else if (loop_.percent() != before) {
    use_overrides();
  }
}

}  // namespace lamplock::machine
#endif
