// A feeder: a conveyor that brings and removes sheets, and a sensor that detects one.
//
// In:  AUX OUT: high = the conveyor runs.
// Out: AUX IN: closed to ground (low) while a sheet covers the sensor; open, as a broken wire,
//      high.
// Sheets lie in a row: when the conveyor has run over a gap the next one covers the sensor, and
// after a further sheet length it leaves the sensor.
// Who: World calls next_event() and advance(); a comparison when nothing is due.
#pragma once

#include <algorithm>

#include "sim/world/pins.hpp"

namespace lamplock::sim {

struct FeederConfig {
  Picoseconds gap = 200 * ps_per_ms;    ///< conveyor's run until a sheet covers the sensor
  Picoseconds sheet = 150 * ps_per_ms;  ///< and until the sheet leaves it
  Picoseconds broken_from = never;      ///< the sensor's wire, permanently
};

/// Must live as long as the bus is driven.
class Feeder final : public PinListener {
 public:
  Feeder(const FeederConfig& config, PinBus& bus) : config_(config), bus_(bus) {
    bus.listen(Pin::aux_out, *this);
    bus.set(Pin::aux_in, true, 0);
  }
  Feeder(const Feeder&) = delete;
  Feeder& operator=(const Feeder&) = delete;

  /// `never` if nothing is due.
  Picoseconds next_event() const {
    const Picoseconds breaks = broken_ ? never : config_.broken_from;
    return runs_ ? std::min(breaks, since_ + left()) : breaks;
  }
  void advance(Picoseconds to) {
    broken_ = broken_ || config_.broken_from <= to;
    run_until(to);
    bus_.set(Pin::aux_in, broken_ || !covered(), to);
  }
  void pin_changed(Pin /*pin*/, bool level, Picoseconds at) override {
    run_until(at);
    runs_ = level;
    since_ = at;
  }

  /// Sheets that have reached the sensor.
  int sheets() const { return sheets_; }
  bool runs() const { return runs_; }

 private:
  bool covered() const { return place_ >= config_.gap; }
  /// Run to the next edge of a sheet, in time.
  Picoseconds left() const {
    return (covered() ? config_.gap + config_.sheet : config_.gap) - place_;
  }
  void run_until(Picoseconds to) {
    while (runs_ && to - since_ >= left()) {
      since_ += left();
      sheets_ += covered() ? 0 : 1;
      place_ = covered() ? 0 : config_.gap;
    }
    if (!runs_) return;
    place_ += std::max<Picoseconds>(to - since_, 0);
    since_ = std::max(since_, to);
  }

  FeederConfig config_;
  PinBus& bus_;
  bool runs_ = false, broken_ = false;
  Picoseconds since_ = 0;
  Picoseconds place_ = 0;  ///< of the row of sheets, since the last one left the sensor
  int sheets_ = 0;
};

}  // namespace lamplock::sim
