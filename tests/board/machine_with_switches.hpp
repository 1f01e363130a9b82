// A machine whose motion operates its limit switches and probe, and a host that can home it.
#pragma once

#include <memory>

#include "tests/board/program_host.hpp"

namespace lamplock::test {

/// Places of switches, in steps of the loads, and their behaviour.
struct SwitchPlan {
  StepPosition start{};  ///< position of the loads at power-up
  StepPosition switches{12'000, 12'000, 12'000, 12'000};
  unsigned lower_ends = 0;  ///< one bit per axis: its switch is at the lower end
  std::int32_t hysteresis_steps = 20;
  sim::BounceConfig bounce{};
};

inline sim::WireConfig limit_switch(int axis, const SwitchPlan& plan) {
  const std::int32_t place = plan.switches[index(axis)];
  sim::ContactConfig contact = (plan.lower_ends >> axis & 1u) != 0
                                   ? sim::ContactConfig::below(axis, place, plan.hysteresis_steps)
                                   : sim::ContactConfig::above(axis, place, plan.hysteresis_steps);
  contact.bounce = plan.bounce;
  return {.pin = sim::limit_pin(axis), .contacts = {contact}};
}

/// No lamp; homing is on, fast enough for tests; travel of 100 mm around the origin, 200 steps/mm.
inline job::Profile homing_profile() {
  job::Profile profile = lamp_profile(100, settings::LampMode::free_beat);
  settings::Values& s = profile.settings;
  s.set_milli(Id::homing, 1000);
  s.set_milli(Id::homing_seek, 6'000'000);
  s.set_milli(Id::homing_feed, 300'000);
  s.set_milli(Id::homing_debounce, 25'000);
  return profile;
}

class MachineWithSwitches {
 public:
  MachineWithSwitches(const job::Profile& profile, const SwitchPlan& plan,
                      std::vector<sim::WireConfig> more = {})
      : rig(profile.settings, world_with(profile, plan, std::move(more))), host(rig) {}

  /// All lines in answer to "$H", until it is answered or the time is over.
  std::vector<std::string> home(std::string_view command = "$H\n", double seconds = 60) {
    return host.ask(command, seconds);
  }
  StepPosition loads() const { return rig.board.world().drives().position(); }
  sim::Switches& switches() { return rig.board.world().switches(); }
  /// Runs until `is()` is true, at most for a minute; returns whether it is.
  template <class Is>
  bool wait_for(Is&& is) {
    for (int i = 0; i < 240'000 && !is(); ++i) host.run(ps_per_ms / 4);
    return is();
  }
  bool wait_for_motion() {
    const StepPosition at = loads();
    return wait_for([&] { return loads() != at; });
  }

  Rig rig;
  ProgramHost host;

 private:
  static sim::WorldConfig world_with(const job::Profile& profile, const SwitchPlan& plan,
                                     std::vector<sim::WireConfig> more) {
    sim::WorldConfig world = world_for(profile);
    world.drives.start = plan.start;
    const int axes = profile.settings.whole(Id::axes);
    for (int axis = 0; axis < axes; ++axis) {
      const auto has_pin = [axis](const sim::WireConfig& w) {
        return w.pin == sim::limit_pin(axis);
      };
      if (std::none_of(more.begin(), more.end(), has_pin))
        world.switches.push_back(limit_switch(axis, plan));
    }
    world.switches.insert(world.switches.end(), more.begin(), more.end());
    return world;
  }
};

}  // namespace lamplock::test
