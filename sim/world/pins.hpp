// The wires between a simulated board and the simulated world.
//
// The world knows pins and times but not the firmware: the same lamp, drives and switches serve the
// virtual board and the chip simulator, and traces listen to the same wires.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/world/time.hpp"

namespace lamplock::sim {

/// Every wire. Steps and directions first, axis by axis (X Y Z A).
enum class Pin : std::uint8_t {
  step_x,
  dir_x,
  step_y,
  dir_y,
  step_z,
  dir_z,
  step_a,
  dir_a,
  lamp_sync,     ///< in: the lamp flashes
  lamp_trigger,  ///< out: the controller triggers the lamp (master)
  q_switch,      ///< out: releases the pulse
  laser_gate,    ///< out: continuous laser permitted
  arm,           ///< out: machine is in position, a shot may be fired
  enable,        ///< out: drives enabled, all or all but those of enable_z
  estop,         ///< in: high = pressed
  door,          ///< in: high = open
  limit_x,
  limit_y,
  limit_z,
  limit_a,  ///< in: high = engaged
  shutter_1,
  shutter_2,
  shutter_3,
  shutter_4,  ///< out: high = open
  photosensor_1,
  photosensor_2,
  photosensor_3,
  photosensor_4,  ///< in: a pulse when a shot has made its defect
  probe,          ///< in: low = touches; an open circuit, as without a probe, is high
  enable_z,       ///< out: drives of Z and A enabled, where they have a wire of their own
  air,            ///< out
  aux_out,        ///< out: of programs
  aux_in,         ///< in, of programs: low = on; an open circuit is high
  count
};
inline constexpr std::size_t pin_count = static_cast<std::size_t>(Pin::count);

constexpr Pin step_pin(int axis) { return static_cast<Pin>(2 * axis); }
constexpr Pin dir_pin(int axis) { return static_cast<Pin>(2 * axis + 1); }
constexpr Pin limit_pin(int axis) {
  return static_cast<Pin>(static_cast<int>(Pin::limit_x) + axis);
}
inline constexpr int beam_channels = 4;
constexpr Pin shutter_pin(int channel) {
  return static_cast<Pin>(static_cast<int>(Pin::shutter_1) + channel);
}
constexpr Pin photosensor_pin(int channel) {
  return static_cast<Pin>(static_cast<int>(Pin::photosensor_1) + channel);
}

/// Receives changes of wires.
class PinListener {
 public:
  virtual ~PinListener() = default;
  /// Called once per change, in order of time for each pin.
  virtual void pin_changed(Pin pin, bool level, Picoseconds at) = 0;
};

/// Receives changes of LASER PWM after its low-pass.
class PowerListener {
 public:
  virtual ~PowerListener() = default;
  /// Called once per change, in order of time; 65535 = full.
  virtual void power_changed(std::uint16_t power, Picoseconds at) = 0;
};

/// Receives changes of the voltage at SENSOR.
class VoltageListener {
 public:
  virtual ~VoltageListener() = default;
  virtual void voltage_changed(double volts, Picoseconds at) = 0;
};

/// Levels and listeners of all wires. Two wires are analogue: LASER PWM, the attenuator of a pulsed
/// laser or the power of a continuous one, and SENSOR.
class PinBus {
 public:
  bool level(Pin pin) const { return levels_[index(pin)]; }

  /// Connects a listener to one pin; it must live as long as the bus is driven.
  void listen(Pin pin, PinListener& listener) { listeners_[index(pin)].push_back(&listener); }

  /// Drives a wire; no call when the level does not change.
  void set(Pin pin, bool level, Picoseconds at) {
    if (levels_[index(pin)] == level) return;
    levels_[index(pin)] = level;
    for (PinListener* listener : listeners_[index(pin)]) listener->pin_changed(pin, level, at);
  }

  /// Value at the attenuator, 65535 = full.
  std::uint16_t attenuator() const { return attenuator_; }
  void set_attenuator(std::uint16_t value) { attenuator_ = value; }

  /// Value of AUX OUT as an analogue wire, 65535 = full; as a digital one it is high if that is not
  /// 0.
  std::uint16_t aux() const { return aux_; }
  void set_aux(std::uint16_t value, Picoseconds at) {
    aux_ = value;
    set(Pin::aux_out, value != 0, at);
  }

  /// LASER PWM as a continuous laser sees it: its changes carry their time, which may be slightly
  /// before that of the pins, since a duty is known when its period is over.
  void listen_to_power(PowerListener& listener) { power_listeners_.push_back(&listener); }
  void set_power(std::uint16_t power, Picoseconds at) {
    if (power == power_) return;
    power_ = power;
    for (PowerListener* listener : power_listeners_) listener->power_changed(power, at);
  }

  /// SENSOR, an input: 0 without a sensor.
  double sensor_volts() const { return sensor_volts_; }
  void set_sensor(double volts, Picoseconds at) {
    if (volts == sensor_volts_) return;
    sensor_volts_ = volts;
    if (sensor_listener_ != nullptr) sensor_listener_->voltage_changed(volts, at);
  }
  void listen_to_sensor(VoltageListener& listener) { sensor_listener_ = &listener; }

 private:
  static constexpr std::size_t index(Pin pin) { return static_cast<std::size_t>(pin); }
  std::array<bool, pin_count> levels_{};
  std::array<std::vector<PinListener*>, pin_count> listeners_{};
  std::uint16_t attenuator_ = 0;
  std::uint16_t power_ = 0;
  std::uint16_t aux_ = 0;
  std::vector<PowerListener*> power_listeners_;
  double sensor_volts_ = 0;
  VoltageListener* sensor_listener_ = nullptr;
};

}  // namespace lamplock::sim
