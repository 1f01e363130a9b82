// Everything outside the controller: lamp, laser, drives and the switches of the machine.
//
// In:  the wires that a board drives; a schedule of what people and limits do to the switches.
// Out: the wires that the world drives, each change at its exact time; what was moved and fired.
// Who: a board's loop. It asks next_event(), runs itself no further than that, and calls
//      advance(), a million times per simulated minute: two comparisons when nothing is due.
//
// Order: advance(to) means that the board has delivered all its changes up to the `to` of the
// advance() before; within such a slice its pins may come in any order between axes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <queue>
#include <vector>

#include "sim/world/beam.hpp"
#include "sim/world/drives.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/laser.hpp"
#include "sim/world/photosensors.hpp"
#include "sim/world/pins.hpp"
#include "sim/world/shutters.hpp"

namespace lamplock::sim {

struct WorldConfig {
  LampConfig lamp{};
  DriveConfig drives{};
  ShutterConfig shutters{};
  PhotosensorConfig photosensors{};
};

/// The world on one bus; must live as long as the bus is driven.
class World {
 public:
  /// Throws std::invalid_argument if the lamp's numbers make no lamp.
  World(const WorldConfig& config, PinBus& bus);
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  /// Time of the next change the world will make; `never` if none is known.
  Picoseconds next_event() const {
    return std::min({lamp_.next_event(), next_switch_, photosensors_.next_event()});
  }

  /// Makes all changes up to and including `to`, in order of time.
  void advance(Picoseconds to) {
    laser_.settle(now_);
    if (next_event() <= to) make_changes(to);
    now_ = std::max(now_, to);
  }

  /// Sets a switch (e-stop, door, limit or any other input) at a time; one that has passed already
  /// is made at the next advance(). Changes at the same time keep the order of the calls.
  void schedule(Pin pin, bool level, Picoseconds at);

  const Lamp& lamp() const { return lamp_; }
  const Drives& drives() const { return drives_; }
  const Laser& laser() const { return laser_; }
  /// The continuous laser.
  const Beam& beam() const { return beam_; }
  const Photosensors& photosensors() const { return photosensors_; }

 private:
  struct Switch {
    Picoseconds at;
    std::uint64_t order;
    Pin pin;
    bool level;
    friend bool operator>(const Switch& a, const Switch& b) {
      return a.at != b.at ? a.at > b.at : a.order > b.order;
    }
  };
  void make_changes(Picoseconds to);
  void make_switch();

  PinBus& bus_;
  Lamp lamp_;
  Drives drives_;
  Shutters shutters_;
  Laser laser_;
  Beam beam_;
  Photosensors photosensors_;
  Picoseconds now_ = 0;
  Picoseconds next_switch_ = never;
  std::uint64_t scheduled_ = 0;
  std::priority_queue<Switch, std::vector<Switch>, std::greater<>> switches_;
};

}  // namespace lamplock::sim
