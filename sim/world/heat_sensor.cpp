#include "sim/world/heat_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lamplock::sim {
namespace {

constexpr double full_power = 65'535;
/// Time over which steps are a speed.
constexpr double speed_filter_s = 0.001;
constexpr double max_speed_factor = 4;

}  // namespace

HeatSensor::HeatSensor(const HeatConfig& config, PinBus& bus, Drives& drives)
    : config_(config), bus_(bus) {
  const bool is_right = config.gain_k > 0 && config.time_constant_s > 0 &&
                        config.kelvin_per_volt != 0 && config.steps_per_mm > 0 &&
                        config.reference_mm_s >= 0;
  if (!is_right) throw std::invalid_argument("heat sensor: gain, time or scale is not above 0");
  bus.listen(Pin::laser_gate, *this);
  bus.listen_to_power(*this);
  const StepPosition start = drives.position();
  for (int axis = 0; axis < 2; ++axis) {
    place_[index(axis)] = start[index(axis)];
    if (config.reference_mm_s > 0) drives.listen(axis, *this);
  }
}

void HeatSensor::pin_changed(Pin /*pin*/, bool level, Picoseconds at) {
  heat_until(at);
  gate_ = level;
  was_lit_ = was_lit_ || level;
}

void HeatSensor::power_changed(std::uint16_t power, Picoseconds at) {
  heat_until(at);
  power_ = power;
}

void HeatSensor::load_moves(int axis, std::int32_t place, Picoseconds /*at*/) {
  moved_[index(axis)] += std::abs(place - place_[index(axis)]);
  place_[index(axis)] = place;
}

/// The exact solution for constant light. A duty of PWM is known after its time: then the light
/// changes late, by a period at most.
void HeatSensor::heat_until(Picoseconds to) {
  if (to <= heated_) return;
  const double light = gate_ ? power_ / full_power : 0;
  const double end = config_.gain_k * change_.absorption * light * factor_;
  rise_k_ = end + (rise_k_ - end) * std::exp(-seconds(to - heated_) / config_.time_constant_s);
  heated_ = to;
}

double HeatSensor::speed_factor() {
  if (config_.reference_mm_s == 0) return 1;
  const double period_s = seconds(period);
  const double mm = std::hypot(moved_[0], moved_[1]) / config_.steps_per_mm;
  moved_ = {};
  mm_s_ += (mm / period_s - mm_s_) * period_s / speed_filter_s;
  const double slowest = config_.reference_mm_s / (max_speed_factor * max_speed_factor);
  return std::sqrt(config_.reference_mm_s / std::max(mm_s_, slowest));
}

void HeatSensor::advance(Picoseconds to) {
  for (; next_ <= to; next_ += period) {
    heat_until(next_);
    factor_ = speed_factor();
    while (changes_made_ < config_.changes.size() && config_.changes[changes_made_].at <= next_)
      change_ = config_.changes[changes_made_++];
    if (was_lit_) samples_.push_back({next_, rise_k_});
    const double volts = config_.volts_at_rest + rise_k_ / config_.kelvin_per_volt;
    bus_.set_sensor(std::clamp(change_.broken_volts.value_or(volts), 0.0, reference_volts), next_);
  }
}

}  // namespace lamplock::sim
