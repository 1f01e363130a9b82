// Everything outside the controller: lamp, laser, drives and the switches of the machine.
//
// In:  the wires that a board drives; a schedule of changes that people and limits make to
//      switches.
// Out: the wires that the world drives, each change at its exact time; motion and shots. Switches
//      that the machine itself works change with the step that took its load there.
// Who: a board's loop. It calls next_event(), runs itself no further than that, and calls
//      advance(), a million times per simulated minute: two comparisons when nothing is due.
//
// Order: when advance(to) is called, the board has delivered all its changes up to the `to` of the
// advance() before; within such a slice its pins may come in any order between axes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <queue>
#include <vector>

#include "sim/world/beam.hpp"
#include "sim/world/drives.hpp"
#include "sim/world/feeder.hpp"
#include "sim/world/heat_sensor.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/laser.hpp"
#include "sim/world/photosensors.hpp"
#include "sim/world/pins.hpp"
#include "sim/world/servo.hpp"
#include "sim/world/shutters.hpp"
#include "sim/world/switches.hpp"

namespace lamplock::sim {

struct WorldConfig {
  LampConfig lamp{};
  DriveConfig drives{};
  ShutterConfig shutters{};
  PhotosensorConfig photosensors{};
  std::optional<FeederConfig> feeder{};          ///< without it AUX IN is open
  std::optional<HeatConfig> heat{};              ///< without it SENSOR is at 0 V
  std::vector<WireConfig> switches{};            ///< limits, probe; none: inputs at rest
  PerAxis<std::optional<ServoConfig>> servos{};  ///< axes with an encoder on the load
};

/// The world on one bus; must live as long as the bus is driven.
class World {
 public:
  /// Throws std::invalid_argument if the numbers do not describe a lamp, switch or servo.
  World(const WorldConfig& config, PinBus& bus);
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Time of the next change by the world; `never` if none is known.
  Picoseconds next_event() const {
    const Picoseconds event = std::min(
        {lamp_.next_event(), next_scheduled_, photosensors_.next_event(), switches_.next_event()});
    const Picoseconds fed = feeder_ ? std::min(event, feeder_->next_event()) : event;
    return heat_ ? std::min(fed, heat_->next_event()) : fed;
  }

  /// Latest end of the board's next slice of steps, so that no step follows one that has worked a
  /// switch before the board has seen the switch.
  Picoseconds next_look(Picoseconds now) const {
    return has_switches_ ? switches_.next_look(now) : never;
  }

  /// Makes all changes up to and including `to`, in order of time.
  void advance(Picoseconds to) {
    laser_.settle(now_);
    if (next_event() <= to) make_changes(to);
    now_ = std::max(now_, to);
  }

  /// Sets a switch (e-stop, door, limit or any other input) at a time; a time that has passed means
  /// the next advance(). Changes at the same time keep the order of the calls. Pins of
  /// `WorldConfig::switches` are changed by switches() instead.
  void schedule(Pin pin, bool level, Picoseconds at);

  const Lamp& lamp() const { return lamp_; }
  const Drives& drives() const { return drives_; }
  const Laser& laser() const { return laser_; }
  /// The continuous laser.
  const Beam& beam() const { return beam_; }
  const Photosensors& photosensors() const { return photosensors_; }
  /// Null if there is none.
  const Feeder* feeder() const { return feeder_ ? &*feeder_ : nullptr; }
  /// Null if there is none.
  const HeatSensor* heat() const { return heat_ ? &*heat_ : nullptr; }
  const Switches& switches() const { return switches_; }
  /// Switches, to press one by hand or to break a wire.
  Switches& switches() { return switches_; }
  /// Servo of an axis; null if it has none.
  const Servo* servo(int axis) const {
    const std::optional<Servo>& servo = servos_[index(axis)];
    return servo ? &*servo : nullptr;
  }

 private:
  /// One scheduled change of a switch.
  struct Change {
    Picoseconds at;
    std::uint64_t order;
    Pin pin;
    bool level;
    friend bool operator>(const Change& a, const Change& b) {
      return a.at != b.at ? a.at > b.at : a.order > b.order;
    }
  };
  void make_changes(Picoseconds to);
  void make_scheduled();

  PinBus& bus_;
  Lamp lamp_;
  Drives drives_;
  Switches switches_;
  bool has_switches_;
  PerAxis<std::optional<Servo>> servos_;
  Shutters shutters_;
  Laser laser_;
  Beam beam_;
  Photosensors photosensors_;
  std::optional<Feeder> feeder_;
  std::optional<HeatSensor> heat_;
  Picoseconds now_ = 0;
  Picoseconds next_scheduled_ = never;
  std::uint64_t calls_ = 0;
  std::priority_queue<Change, std::vector<Change>, std::greater<>> scheduled_;
};

}  // namespace lamplock::sim
