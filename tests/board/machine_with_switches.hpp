// A machine whose motion operates its limit switches and probe, and a host that can home it.
#pragma once

#include <memory>
#include <random>

#include "tests/board/program_host.hpp"

namespace lamplock::test {

/// Ends of the work space of homing_profile(), and the way back from a switch.
inline constexpr std::int32_t end_steps = 50 * 200, pull_off_steps = 200;

/// Places of switches, in steps of the loads, and their behaviour.
struct SwitchPlan {
  StepPosition start{};  ///< position of the loads at power-up
  StepPosition switches{12'000, 12'000, 12'000, 12'000};
  unsigned lower_ends = 0;  ///< one bit per axis: its switch is at the lower end
  std::int32_t hysteresis_steps = 20;
  sim::BounceConfig bounce{};

  bool is_below(int axis) const { return (lower_ends >> axis & 1u) != 0; }
  /// Difference of machine and load coordinates after homing.
  std::int32_t offset(int axis) const {
    return (is_below(axis) ? -end_steps : end_steps) - switches[index(axis)];
  }
  /// Machine coordinate after homing.
  std::int32_t homed(int axis) const {
    return is_below(axis) ? -end_steps + pull_off_steps : end_steps - pull_off_steps;
  }
};

/// Switches at either end of X, Y and Z that bounce, with a hysteresis of up to `beyond` steps;
/// loads anywhere up to `beyond` steps past them.
inline SwitchPlan random_switches(std::mt19937_64& random, int beyond) {
  const Pick<int> pick(random);
  SwitchPlan plan;
  plan.lower_ends = static_cast<unsigned>(pick(0, 7));
  plan.hysteresis_steps = pick(0, beyond);
  plan.bounce = {.make_us = pick(0, 8000) * 1.0, .break_us = pick(0, 8000) * 1.0, .seed = random()};
  for (int a = 0; a < 3; ++a) {
    const int way = plan.is_below(a) ? -1 : 1;
    plan.switches[index(a)] = way * pick(3000, 19'000);
    plan.start[index(a)] = plan.switches[index(a)] - way * pick(-beyond, 10'000);
  }
  return plan;
}

inline sim::WireConfig limit_switch(int axis, const SwitchPlan& plan) {
  const std::int32_t place = plan.switches[index(axis)];
  sim::ContactConfig contact = plan.is_below(axis)
                                   ? sim::ContactConfig::below(axis, place, plan.hysteresis_steps)
                                   : sim::ContactConfig::above(axis, place, plan.hysteresis_steps);
  contact.bounce = plan.bounce;
  return {.pin = sim::limit_pin(axis), .contacts = {contact}};
}

/// No lamp; homing is on, fast enough for tests; travel of 100 mm around the origin, 200 steps/mm.
inline job::Profile homing_profile(unsigned lower_ends = 0) {
  job::Profile profile = program_profile();
  settings::Values& s = profile.settings;
  s.set_milli(Id::homing, 1000);
  s.set_milli(Id::homing_seek, 6'000'000);
  s.set_milli(Id::homing_feed, 300'000);
  s.set_milli(Id::homing_debounce, 25'000);
  s.set_milli(Id::homing_direction, static_cast<int>(lower_ends) * 1000);
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

/// These axes are at their switches, and the machine reports that to a step.
inline void expect_homed(const MachineWithSwitches& m, const SwitchPlan& plan, unsigned axes = 7) {
  const StepPosition at = m.host.position(), loads = m.loads();
  for (int axis = 0; axis < 3; ++axis) {
    if ((axes >> axis & 1u) == 0) continue;
    EXPECT_LE(std::abs(at[index(axis)] - loads[index(axis)] - plan.offset(axis)), 1)
        << "axis " << axis;
    EXPECT_EQ(at[index(axis)], plan.homed(axis));
  }
}

/// A door, a reset or an e-stop (0, 1, 2) ends homing with its alarm; the machine comes to rest.
inline void expect_homing_ends(MachineWithSwitches& m, int what) {
  if (what == 1)
    m.host.send(std::uint8_t{0x18});
  else
    m.rig.set(what == 0 ? sim::Pin::door : sim::Pin::estop, true);
  m.host.run_ms(300);
  const char* alarms[] = {"ALARM:7", "ALARM:6", "ALARM:10"};
  EXPECT_THAT(m.host.said(), Contains(alarms[what]));
  if (what == 1)
    EXPECT_THAT(m.host.answers(), IsEmpty());  // the answer to a reset is its banner
  else
    EXPECT_THAT(m.host.answers(), ElementsAre("error:9"));
  const StepPosition stood = m.loads();
  m.host.run_ms(300);
  EXPECT_EQ(m.loads(), stood);
  EXPECT_THAT(m.host.status(), StartsWith("<Alarm|"));
}

}  // namespace lamplock::test
