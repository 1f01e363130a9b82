#include "sim/world/lamp.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lamplock::sim {
namespace {

// A runt is shorter than the 2 us that make a LAMP SYNC (controller signals of the glass machine).
constexpr double runt_min_us = 0.2;
constexpr double runt_max_us = 1.9;
constexpr double echo_min_us = 3;
constexpr double echo_max_us = 200;
/// Minimum low time between two pulses, so that each remains a pulse of its own: a first pulse cut
/// short by its echo is still at least 2.5 us wide, a valid LAMP SYNC.
constexpr Picoseconds min_gap = 500 * ps_per_ns;

Picoseconds from_us(double us) {
  return static_cast<Picoseconds>(std::llround(us * static_cast<double>(ps_per_us)));
}

bool is_probability(double p) { return p >= 0 && p <= 1; }

void check(const LampConfig& c) {
  const double period_us = 1e6 / c.frequency_hz;
  // A lamp with more than an hour or less than 10 us between flashes is not a flash lamp.
  if (!(period_us >= 10 && period_us <= 3.6e9))
    throw std::invalid_argument("lamp frequency out of range");
  if (!(c.pulse_us > 2 && c.pulse_us <= period_us / 4))
    throw std::invalid_argument("width of LAMP SYNC out of range");
  if (!(c.jitter_us >= 0 && c.jitter_us <= period_us / 8))
    throw std::invalid_argument("lamp jitter out of range");
  if (!(c.wander >= 0 && c.wander <= 0.5 && c.wander_period_s > 0 && c.wander_period_s < 1e6))
    throw std::invalid_argument("lamp wander out of range");
  if (!is_probability(c.dropout) || !is_probability(c.runt) || !is_probability(c.doubled))
    throw std::invalid_argument("lamp fault probability outside 0..1");
  if (!(c.phase_us >= 0 && c.phase_us < 1e12 && c.on_after_s >= 0 && c.on_after_s < 1e6))
    throw std::invalid_argument("start of the lamp out of range");
}

}  // namespace

Lamp::Lamp(const LampConfig& config, PinBus& bus)
    : config_(config), bus_(&bus), random_(config.seed) {
  check(config);
  jitter_ = from_us(config.jitter_us);
  pulse_ = from_us(config.pulse_us);
  on_after_ = from_us(config.on_after_s * 1e6);
  wander_period_ = from_us(config.wander_period_s * 1e6);
  period_ = static_cast<double>(ps_per_s) / config.frequency_hz;
  if (config.triggered) {
    bus.listen(Pin::lamp_trigger, *this);
  } else {
    ideal_ = on_after_ + from_us(config.phase_us);
    make_next_period();
  }
}

void Lamp::add_pulse(Picoseconds rise, Picoseconds fall, Kind kind) {
  add(rise, kind);
  add(fall, Kind::fall);
}

/// Fills edges_ with one period whose flash has the given ideal phase; everything ends before the
/// earliest edge of the next period.
void Lamp::make_period(Picoseconds ideal, Picoseconds next_ideal) {
  const double jitter_draw = random_.uniform(), dropout_draw = random_.uniform(),
               doubled_draw = random_.uniform(), echo_draw = random_.uniform(),
               runt_draw = random_.uniform(), runt_width_draw = random_.uniform(),
               runt_phase_draw = random_.uniform();
  next_ = count_ = 0;
  const Picoseconds jitter =
      config_.triggered ? 0
                        : static_cast<Picoseconds>(
                              std::llround((2 * jitter_draw - 1) * static_cast<double>(jitter_)));
  const Picoseconds edge = std::max<Picoseconds>(0, ideal + jitter);
  const Picoseconds period_end = next_ideal - (config_.triggered ? 0 : jitter_);
  const double echo_room_us = static_cast<double>(period_end - edge - pulse_ - min_gap) / ps_per_us;
  Picoseconds quiet_from = edge;
  if (dropout_draw < config_.dropout) {
    add(edge, Kind::dropped);
  } else if (doubled_draw < config_.doubled && echo_room_us >= echo_min_us) {
    const double max_us = std::min(echo_max_us, echo_room_us);
    const Picoseconds echo = edge + from_us(echo_min_us + echo_draw * (max_us - echo_min_us));
    add_pulse(edge, std::min(edge + pulse_, echo - min_gap), Kind::flash);
    add_pulse(echo, echo + pulse_, Kind::rise);
    quiet_from = echo + pulse_;
  } else {
    add_pulse(edge, edge + pulse_, Kind::flash);
    quiet_from = edge + pulse_;
  }
  if (runt_draw >= config_.runt) return;
  const Picoseconds width = from_us(runt_min_us + runt_width_draw * (runt_max_us - runt_min_us));
  const Picoseconds first = quiet_from + min_gap;
  const Picoseconds last = period_end - min_gap - width;
  if (last < first) return;
  const Picoseconds rise =
      first + static_cast<Picoseconds>(runt_phase_draw * static_cast<double>(last - first));
  add_pulse(rise, rise + width, Kind::rise);
}

void Lamp::make_next_period() {
  const Picoseconds ideal = ideal_;
  const double phase = static_cast<double>((ideal - on_after_) % wander_period_) /
                       static_cast<double>(wander_period_);
  const double period = period_ * (1 + config_.wander / 2 * std::sin(2 * std::numbers::pi * phase));
  ideal_remainder_ += period;
  const double whole = std::floor(ideal_remainder_);
  ideal_remainder_ -= whole;
  ideal_ += static_cast<Picoseconds>(whole);
  make_period(ideal, ideal_);
}

void Lamp::apply_next(PinBus& bus) {
  const Edge edge = edges_[next_++];
  // Before the pin changes: a listener may ask for, or cause, the next event.
  if (next_ == count_ && !config_.triggered) make_next_period();
  if (edge.kind == Kind::flash || edge.kind == Kind::dropped) ++periods_;
  if (edge.kind == Kind::flash) {
    ++flashes_;
    recent_[static_cast<std::size_t>(flashes_) % remembered_flashes] = {flashes_, edge.at};
  }
  if (edge.kind != Kind::dropped) bus.set(Pin::lamp_sync, edge.kind != Kind::fall, edge.at);
}

Lamp::Flash Lamp::flash_before(Picoseconds at) const {
  const auto remembered = static_cast<std::int64_t>(remembered_flashes);
  for (std::int64_t n = flashes_; n > 0 && n > flashes_ - remembered; --n) {
    const Flash& flash = recent_[static_cast<std::size_t>(n) % remembered_flashes];
    if (flash.at <= at) return flash;
  }
  return {};
}

void Lamp::pin_changed(Pin /*pin*/, bool level, Picoseconds at) {
  if (!level || at < on_after_) return;
  // While LAMP SYNC is high the lamp cannot flash again.
  advance(*bus_, at);
  if (bus_->level(Pin::lamp_sync)) return;
  make_period(at, at + static_cast<Picoseconds>(period_));
  advance(*bus_, at);
}

}  // namespace lamplock::sim
