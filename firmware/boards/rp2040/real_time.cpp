#include "firmware/boards/rp2040/real_time.hpp"

#include "firmware/boards/rp2040/base/allocation.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"

namespace lamplock::rp2040 {
namespace {

using boards::Role;

constexpr std::uint32_t fill_lead_ticks = 2000;
/// Small portions cost every axis a cut, large ones delay brakes; whole words.
constexpr std::uint32_t filled_at_once = 512;
/// Ticks filled beyond those with a length, below which USB waits. The latter run out 0.8 ms after
/// the former.
constexpr std::int32_t min_filled_ticks = 1000;
/// Minimum time between two alarms: retries must not use all the time.
constexpr std::uint32_t min_wait_us = 5;
constexpr std::uint32_t beat_period_us = 100;
/// Spans fed in one beat interrupt, to limit its time; while more are missing the next interrupt
/// follows at once.
constexpr std::uint32_t max_spans = 1;
constexpr std::uint32_t all_spans = ~0u;
/// From the decision to start the lattice to its first tick: mostly the time to fill the rings.
constexpr std::uint64_t start_margin_clocks = 2000 * clocks_per_us;
/// A tick is not shorter than three quarters of its nominal length; AXIS needs the rest of the
/// time with the line low.
static_assert(pio::tick_high_clocks <= clocks_per_tick * 3 / 4 - pio::tick_low_overhead - 2);
/// Ticks that are filled are put out within this time, or have run out.
constexpr std::uint32_t max_put_out_us = 5000;
/// The timer's edge seen by a waiting loop to the store that starts TICK: 6 to 14 clocks.
constexpr std::uint64_t go_latency_clocks = 12;

/// The 64-bit number nearest to `near` whose lower half is `low`.
std::uint64_t widen(std::uint32_t low, std::uint64_t near) {
  return near + static_cast<std::uint64_t>(std::int64_t{
                    static_cast<std::int32_t>(low - static_cast<std::uint32_t>(near))});
}

}  // namespace

void RealTime::set_drives(bool enabled) const {
  if constexpr (!boards::has(Role::drives_enable)) return;
  constexpr std::uint32_t pins = boards::enable_pins(boards::this_board);
  if (enabled == drives_active_high_)
    sio().gpio_out_set = pins;
  else
    sio().gpio_out_clr = pins;
}

void RealTime::permit_drives([[maybe_unused]] bool permitted, [[maybe_unused]] bool failed) {
  if constexpr (boards::this_board.drives.has_value()) {
    drives_permitted_ = permitted;
    if (!permitted) set_drives(false);
    if (failed && !is_held_) estop_interrupt();
    if (failed == is_held_ || (!failed && !permitted)) return;
    is_held_ = failed;
    inputs_.hold_estop(failed);
  }
}

void RealTime::change_pulses(machine::Controller& core, const machine::InterruptMask& mask) {
  const stepper::PulseOutput output = stepper::pulse_output(core.stored());
  if (expander_.has_times(output)) return;
  // The steps in the rings are before this tick.
  const std::uint32_t end = filled_end_, begun_us = timer().timerawl;
  while (static_cast<std::int32_t>(played_ - end) < 0 &&
         timer().timerawl - begun_us < max_put_out_us) {
  }
  const machine::Masked masked(mask);
  expander_.set_times(output);
  lattice_.set_times(output.pulses);
}

void RealTime::begin(machine::Controller& core, const StepPosition& steps, std::uint64_t filled) {
  const std::uint64_t earliest = now() + start_margin_clocks;
  std::uint64_t tick = 0, clock = 0;
  do {
    const lamp::TickSpan span = core.next_span(feed_span_ticks);
    tick = span.first_tick + span.ticks;
    clock = span.first_clock + span.clocks;
  } while (clock < earliest);
  // Ticks before the first one to be put out are dropped: the rings begin again.
  while (filled < tick) {
    const std::uint64_t ticks = tick - filled;
    filled +=
        fill(core, ticks < filled_at_once ? static_cast<std::uint32_t>(ticks) : filled_at_once);
  }
  PerAxis<std::uint8_t> levels{};
  for (int a = 0; a < boards::axes(map_); ++a) levels[index(a)] = LatticeOutput::levels(a);
  expander_.begin(tick, filled, steps, levels);
  filled_end_ = static_cast<std::uint32_t>(expander_.end_tick());
  timed_end_ = static_cast<std::uint32_t>(tick);
  played_ = static_cast<std::uint32_t>(tick);
  // The low time of the first tick sets its rise: from here to there.
  feed_.begin(tick, clock, 1, pio::tick_high_clocks);
  fill_interrupt(core);
  feed_.feed(static_cast<std::uint32_t>(clock), filled_end_,
             [&core](std::uint32_t n) { return core.next_span(n); });
  timed_end_ = static_cast<std::uint32_t>(feed_.end_tick());
  fill_interrupt(core);
  // First tick: STEP changes step_latency after the tick line.
  const std::uint64_t begin_us = clock / clocks_per_us - 100;
  const std::uint64_t go_clock = begin_us * clocks_per_us + go_latency_clocks;
  const std::uint64_t low = clock - go_clock - pio::tick_start_clocks - pio::step_latency_clocks;
  tick_ring_.words[0] = tick_word(1, static_cast<std::uint32_t>(low));
  stamps_.begin(go_clock);
  lattice_.prepare();
  Estop::release_trigger();
  go(start_us_ + begin_us, static_cast<std::uint32_t>(clock - go_clock));
  fire_.restart();
  set_bits(pio0().irq0_inte, pio_intr::rx_not_empty(fire_machine.number));
  set_bits(timer().inte, 1u << beat_alarm);
  beam_.forget();  // an e-stop has closed it
  programs_.forget();
  set_alarm(min_wait_us);
}

void RealTime::go(std::uint64_t at_us, std::uint32_t first_tick_clocks) {
  const std::uint32_t count =
      (laser_pwm_counts - first_tick_clocks % laser_pwm_counts) % laser_pwm_counts;
  while (microseconds() + 1 < at_us) {
  }
  // Half of the last microsecond passes unmasked: 15 turns of some 4 cycles.
  for (int i = 0; i < 15; ++i) asm volatile("" ::: "memory");
  const AllMasked masked;
  const auto at = static_cast<std::uint32_t>(at_us);
  while (static_cast<std::int32_t>(timer().timerawl - at) < 0) {
  }
  lattice_.go();
  BeamOutput::set_count(count);
}

void RealTime::admit_usb() {
  if (!usb_waits_) return;
  if (static_cast<std::int32_t>(filled_end_ - timed_end_) < min_filled_ticks) return;
  if (static_cast<std::int32_t>(timer().timerawl - usb_after_us_) < 0) return;
  usb_waits_ = false;
  nvic().iser = irq_bit(Irq::usbctrl);
}

/// Relative to now: other levels get that time.
void RealTime::set_alarm(std::uint32_t wait_us) {
  alarm_us_ = timer().timerawl + wait_us;
  timer().alarm[beat_alarm] = alarm_us_;
  // The alarm matches on equality: if the time has passed meanwhile, pend the interrupt.
  if (static_cast<std::int32_t>(timer().timerawl - alarm_us_) >= 0)
    nvic().ispr = irq_bit(Irq::timer_1);
}

/// Sets the alarm earlier if the token is due before it.
void RealTime::call_for_token() {
  std::uint64_t clock = 0;
  if (fire_.next_clock(clock)) call_at(clock);
}

void RealTime::call_at(std::uint64_t clock) {
  std::uint32_t wait_us = min_wait_us;
  if (clock > now_) {
    if (clock - now_ >= beat_period_us * clocks_per_us) return;
    // This interrupt does not divide: 8389 / 2^20 = 1 / 124.99.
    wait_us += static_cast<std::uint32_t>(clock - now_) * 8389 >> 20;
  }
  if (static_cast<std::int32_t>(alarm_us_ - now_us_ - wait_us) > 0) set_alarm(wait_us);
}

/// When the next change of an output is due; false if its tick has no length yet.
bool RealTime::next_change(const machine::Controller& core, std::uint64_t& clock) const {
  std::uint32_t tick = 0;
  return core.next_change(tick) && feed_.clock_of(widen(tick, feed_.end_tick()), clock);
}

void RealTime::play_changes(machine::Controller& core) {
  std::uint32_t tick = 0;
  for (std::uint64_t clock = 0; next_change(core, clock) && clock <= now_;) {
    core.next_change(tick);
    core.play_changes(tick);
  }
}

bool RealTime::feed_spans(machine::Controller& core, std::uint32_t most) {
  const bool enough = feed_.feed(
      static_cast<std::uint32_t>(now()), filled_end_,
      [&core](std::uint32_t n) { return core.next_span(n); }, most);
  timed_end_ = static_cast<std::uint32_t>(feed_.end_tick());
  return enough;
}

void RealTime::top_up(machine::Controller& core) {
  if (!estop_.is_cut()) feed_spans(core, all_spans);
}

void RealTime::report_answers(machine::Controller& core) {
  if (core.shots().wants_answer()) core.photosensors(answered_, now());
  answered_ = 0;
}

void RealTime::edge_interrupt(machine::Controller& core) {
  if (estop_.is_cut()) {
    // An unread result would repeat this interrupt for ever; begin() enables it again.
    clear_bits(pio0().irq0_inte, pio_intr::rx_not_empty(fire_machine.number));
    return;
  }
  // Before the results: a caught answer belongs to a shot that FIRE has reported.
  catch_answers();
  fire_.service(core, [this] { return now(); });
  report_answers(core);
  apply_pins(core);
  call_for_token();
}

void RealTime::beat_interrupt(machine::Controller& core) {
  timer().intr = 1u << beat_alarm;
  if (estop_.is_cut()) return;
  catch_answers();
  inputs_.watch(sio().gpio_in, timer().timerawl);
  // A result available now has its own interrupt next, which may also handle that answer and the
  // token.
  const bool result = FireUnit::has_result();
  if (!result) report_answers(core);
  const bool enough = feed_spans(core, max_spans);
  admit_usb();
  const std::uint64_t present = now();
  played_ = feed_.tick_before(static_cast<std::uint32_t>(present));
  nvic().ispr = irq_bit(Irq::spare_0);
  // Without a token in hand requesting one every second time is enough (250 us).
  ask_ = !ask_;
  if (!result && (ask_ || fire_.has_token())) fire_.handle_token(core, present);
  if (core.changes_wait()) play_changes(core);
  apply_pins(core);
  set_alarm(enough ? beat_period_us : min_wait_us);
  if (!result) call_for_token();
  if (!core.changes_wait()) return;
  if (std::uint64_t clock = 0; next_change(core, clock)) call_at(clock);
}

std::uint32_t RealTime::fill(machine::Controller& core, std::uint32_t ticks) {
  core.fill_axes(ticks, expander_);
  expander_.end_runs(ticks);
  return ticks;
}

void RealTime::fill_interrupt(machine::Controller& core) {
  for (;;) {
    const std::uint64_t end = expander_.end_tick();
    const std::uint64_t wanted = widen(timed_end_, end) + fill_lead_ticks;
    if (end >= wanted) return;
    const std::uint32_t room = expander_.room(widen(played_, end));
    if (room == 0) return;
    fill(core, room < filled_at_once ? room : filled_at_once);
    filled_end_ = static_cast<std::uint32_t>(expander_.end_tick());
  }
}

void RealTime::stop_dead(machine::Controller& core) {
  estop_.cut(programs_.of_drives());
  const std::uint64_t filled = expander_.end_tick();
  const StepPosition steps = expander_.steps_at(lattice_.ticks_begun(feed_));
  // Later edges belong to no shot.
  const std::uint64_t cut_us = widen(estop_.cut_us(), microseconds());
  fire_.stopped(core, (cut_us - start_us_) * clocks_per_us);
  core.stopped_at(steps);
  pads_released_ = false;
  estop_.in_order();  // before begin(): an e-stop during it must not be lost
  begin(core, steps, filled);
}

/// Position from the steps put out at that time, or a millisecond ago, which is the reach of the
/// rings.
StepPosition RealTime::steps_at_us(machine::Controller& core, std::uint32_t us) {
  const std::uint64_t present = now(), oldest = expander_.oldest_tick();
  std::uint64_t tick = feed_.tick_at(present - std::uint64_t{now_us_ - us} * clocks_per_us) + 1;
  if (tick < oldest) tick = oldest;
  StepPosition steps{};
  for (int a = 0; a < max_axes; ++a) {
    top_up(core);  // the lead in time is shorter than searching all axes may take
    steps[index(a)] = expander_.step_at(a, tick);
  }
  return steps;
}

void RealTime::input_changed(machine::Controller& core, machine::Input input, bool active,
                             std::size_t i) {
  StepPosition at{};
  if (core.wants_places() && i < places_.size())
    at = (placed_ >> i & 1) != 0 ? places_[i] : steps_at_us(core, timer().timerawl);
  const bool in_alarm = core.state() == wire::MachineState::alarm;
  core.input_changed(input, active, at);
  if (machine::is_limit(input) && active && !in_alarm && core.state() == wire::MachineState::alarm)
    stop_dead(core);
}

void RealTime::apply_outputs(const machine::Controller& core) {
  const machine::Outputs outputs = core.outputs();
  set_drives(outputs.drives_enable && (!boards::this_board.drives || drives_permitted_));
  constexpr std::uint32_t led = boards::any_of(Role::status_led);
  if (core.clock().locked())
    sio().gpio_out_set = led;
  else
    sio().gpio_out_clr = led;
  const bool may = core.state() != wire::MachineState::estop && !inputs_.estop();
  if (may == pads_released_) return;
  pads_released_ = may;
  const AllMasked masked;  // the e-stop interrupt must not occur in between
  if (may && !estop_.is_cut()) {
    estop_.release_pads();
  } else {
    estop_.hold_pads();
    beam_.forget();  // apply() controls the gate
  }
}

void RealTime::poll(machine::Controller& core) {
  const auto begins = [this, &core](std::size_t i, std::uint32_t began_us) {
    const bool wanted = core.wants_places();
    if (wanted) places_[i] = steps_at_us(core, began_us);
    placed_ = static_cast<std::uint8_t>((placed_ & ~(1u << i)) | (wanted ? 1u : 0u) << i);
  };
  const auto changed = [this, &core](machine::Input input, bool active, std::size_t i) {
    input_changed(core, input, active, i);
  };
  if (estop_.seen()) {
    estop_.reported();
    stop_dead(core);
    inputs_.estop_seen(changed);
  } else if (feed_.starved()) {
    estop_.cut(programs_.of_drives());
    core.lattice_stopped();
    stop_dead(core);
  }
  inputs_.set_active_low(core.stored());
  inputs_.poll(sio().gpio_in, timer().timerawl, begins, changed);
  fire_.service(core, [this] { return now(); });
  fire_.configure(core.fire_timing());
  apply_pins(core);
  apply_outputs(core);
}

}  // namespace lamplock::rp2040
