#include "host/program/servo_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"
#include "host/job/profile.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/units.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/drive_settings.hpp"
#include "sim/world/lamp_settings.hpp"

namespace lamplock::program_run {
namespace {

using settings::Id;
using sim::Picoseconds;

/// The pulse mode between board and drives, as in the paper.
constexpr auto pulse_mode = settings::PulseMode::cw_ccw;
constexpr double ps_per_second = 1e12;
/// Maximum pulse rate of a drive, independent of its motor.
constexpr double max_pulses_per_s = 500'000;

/// Position of an axis of the tick generator at a tick, steps; a step appears half a step ahead.
double planned_steps(const stepper::TickBlock& block, std::size_t axis, double ticks) {
  const auto whole = static_cast<std::uint32_t>(ticks);
  const Int128 at =
      block.moving ? block.axis[axis].position_after(whole) : block.axis[axis].position_q64;
  return static_cast<double>(at.hi()) + std::ldexp(static_cast<double>(at.lo()), -64) - 0.5;
}

/// Samples the program's position at equal times from the first motion on.
class PlanSampler final : public sim::TickListener {
 public:
  explicit PlanSampler(const ServoMachine& machine)
      : every_(static_cast<Picoseconds>(machine.sample_s * ps_per_second)),
        mm_per_step_(1 / in_units(machine.settings(), Id::steps_per_mm_x)) {}

  struct Sample {
    Picoseconds at;
    std::array<double, servo_axes> mm;
  };
  const std::vector<Sample>& samples() const { return samples_; }
  Picoseconds last_motion() const { return last_motion_; }

 private:
  void ticks_played(const sim::PlayedTicks& played) override {
    const bool moves = played.block.moving;
    if (moves) last_motion_ = played.end;
    if (samples_.empty()) {
      if (!moves) return;
      next_ = played.start;
    }
    const double tick = static_cast<double>(played.end - played.start) /
                        static_cast<double>(played.to - played.from);
    for (; next_ < played.end; next_ += every_) {
      const double ticks = static_cast<double>(played.from - played.block.first_tick) +
                           static_cast<double>(next_ - played.start) / tick;
      Sample sample{next_, {}};
      for (std::size_t a = 0; a < servo_axes; ++a)
        sample.mm[a] = planned_steps(played.block, a, ticks) * mm_per_step_;
      samples_.push_back(sample);
    }
  }
  void beat_begins(std::uint64_t, Picoseconds) override {}

  Picoseconds every_, next_ = 0, last_motion_ = 0;
  double mm_per_step_;
  std::vector<Sample> samples_;
};

/// Sends the program and waits for its end.
void run_program_on(sim::VirtualBoard& board, std::string_view text, const std::string& name) {
  link::SimulatedTransport transport(board);
  link::LinePort port(transport);
  link::LineSender sender(port, link::program_lines(text, name));
  while (sender.step())
    if (sender.waits()) sender.resume();
  const link::LineResult result = sender.result();
  if (!result.errors.empty())
    throw Error(Exit::bad_input, fmt::format("{}:{}", name, result.errors[0].line),
                fmt::format("the board answers error:{}", result.errors[0].error),
                "run `lamplock check` on the program, which explains the error");
  if (result.end != link::LineEnd::done)
    throw Error(Exit::job_failed, name, "does not reach its end on the simulated board",
                "run it with `lamplock send --board virtual` to find the cause");
}

void state_limits(job::Profile& profile, int axis, const ServoLimits& limits, double max_mm_min,
                  const std::string& where) {
  constexpr double mm_per_m = 1000, s_per_min = 60;
  const auto state = [&](Id id, double value) {
    job::state_setting(profile, settings::for_axis(id, axis), value, where);
  };
  state(Id::max_rate_x, std::min(max_mm_min, limits.speed_mm_s * s_per_min));
  state(Id::acceleration_x, limits.accel_mm_s2);
  state(Id::jerk_x, limits.jerk_mm_s3 / mm_per_m);
}

}  // namespace

settings::Values ServoMachine::settings() const {
  job::Profile profile;
  const std::string where = "servo drives";
  // Z, with a stepper motor, follows its plan: programs move it between the cuts that are measured.
  constexpr int z = static_cast<int>(servo_axes);
  job::state_setting(profile, Id::axes, servo_axes + 1, where);
  job::state_setting(profile, settings::for_axis(Id::acceleration_x, z), accel_mm_s2, where);
  job::state_setting(profile, Id::lamp_mode, 0, where);
  job::state_setting(profile, Id::soft_limits, 0, where);
  const double max_mm_min =
      std::min(in_units(profile.settings, Id::max_rate_x), max_pulses_per_s / pulses_per_mm() * 60);
  for (int a = 0; a < static_cast<int>(servo_axes); ++a) {
    job::state_setting(profile, settings::for_axis(Id::steps_per_mm_x, a), pulses_per_mm(), where);
    job::state_setting(profile, settings::for_axis(Id::max_rate_x, a), max_mm_min, where);
    job::state_setting(profile, settings::for_axis(Id::acceleration_x, a), accel_mm_s2, where);
    job::state_setting(profile, settings::for_axis(Id::pulse_mode_x, a),
                       static_cast<int>(pulse_mode), where);
  }
  if (limits)
    for (int a = 0; a < static_cast<int>(servo_axes); ++a)
      state_limits(profile, a, (*limits)[static_cast<std::size_t>(a)], max_mm_min, where);
  return profile.settings;
}

ServoRun run_on_servos(std::string_view text, const ServoMachine& machine,
                       const std::string& name) {
  const settings::Values values = machine.settings();
  sim::WorldConfig world{.lamp = sim::lamp_of(values), .drives = sim::drives_of(values)};
  for (std::size_t a = 0; a < servo_axes; ++a) world.servos[a] = machine.drive;
  if (machine.time_constant_y_ms) world.servos[1]->time_constant_ms = *machine.time_constant_y_ms;
  sim::VirtualBoard board(values, world);
  PlanSampler sampler(machine);
  board.listen(sampler);
  run_program_on(board, text, name);
  board.run_until(board.now() + static_cast<Picoseconds>(machine.settle_s * ps_per_second));
  const auto moves = [&](const PlanSampler::Sample& sample) {
    return sample.mm != sampler.samples().front().mm;
  };
  if (std::ranges::none_of(sampler.samples(), moves))
    throw Error(Exit::bad_input, name, "does not move X or Y", "give it a G1, G2 or G3");

  ServoRun run;
  run.steps_per_mm = in_units(values, Id::steps_per_mm_x);
  const Picoseconds start = sampler.samples().front().at;
  run.moving_s = sim::seconds(sampler.last_motion() - start);
  run.samples.reserve(sampler.samples().size());
  for (const PlanSampler::Sample& plan : sampler.samples()) {
    ServoSample sample{sim::seconds(plan.at - start), {}};
    for (std::size_t a = 0; a < servo_axes; ++a) {
      const sim::Servo& servo = *board.world().servo(static_cast<int>(a));
      sample.axis[a] = {plan.mm[a], servo.command_at(plan.at) * servo.mm_per_step(),
                        servo.encoder_mm_at(plan.at)};
    }
    run.samples.push_back(sample);
  }
  for (std::size_t a = 0; a < servo_axes; ++a) run.pulses[a] = board.world().drives().position()[a];
  return run;
}

PlanePoint centre_of(const PlanePoint& from, const PlanePoint& to, double radius) {
  const double x = to[0] - from[0], y = to[1] - from[1], chord = std::hypot(x, y);
  if (chord == 0 || chord > 2 * radius)
    throw Error(Exit::bad_input, fmt::format("radius {:g}", radius), "is too small for these ends",
                "use at least half the distance between the ends");
  const double beside = std::sqrt(radius * radius - chord * chord / 4);
  return {(from[0] + to[0]) / 2 + beside * y / chord, (from[1] + to[1]) / 2 - beside * x / chord};
}

const char* arc_code(const PlanePoint& from, const PlanePoint& to, const PlanePoint& centre) {
  const double cross =
      (from[0] - centre[0]) * (to[1] - centre[1]) - (from[1] - centre[1]) * (to[0] - centre[0]);
  return cross > 0 ? "G3" : "G2";
}

}  // namespace lamplock::program_run
