// A spot that a continuous laser heats, and the sensor that sees its temperature.
//
// In:  LASER GATE, LASER PWM after its low-pass, steps of X and Y; a schedule of changes (the part
//      of the light that is absorbed, a wire that breaks).
// Out: the voltage at SENSOR, on the bus every 50 us.
// Who: World calls next_event() and advance(); the bus reports light, the drives steps.
//
// The spot is a process of first order, as the one that `lamplock heat --tune` measures:
//
//   tau dT/dt = gain * absorption * light * (reference speed / speed)^(1/2) - T
//
// T is the rise above the air, light the part of full power. The last factor, which is that of a
// fast beam (docs/thermal.md, 6), is 1 without a reference speed and at most 4. T changes exactly
// between changes of the light.
#pragma once

#include <optional>
#include <vector>

#include "sim/world/drives.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// From this time on.
struct HeatChange {
  Picoseconds at = 0;
  double absorption = 1;                 ///< of that in the material as tuned
  std::optional<double> broken_volts{};  ///< at the pad, whatever the temperature
};

struct HeatConfig {
  double gain_k = 500;            ///< rise in the steady state at full power
  double time_constant_s = 0.05;  ///< tau
  double volts_at_rest = 0.5;     ///< of the sensor, T = 0
  double kelvin_per_volt = 200;
  double reference_mm_s = 0;          ///< 0: the speed has no effect
  double steps_per_mm = 200;          ///< of X and Y
  std::vector<HeatChange> changes{};  ///< in order of time
};

/// Must live as long as the bus is driven.
class HeatSensor final : private PinListener, private PowerListener, private LoadListener {
 public:
  static constexpr Picoseconds period = 50 * ps_per_us;
  static constexpr double reference_volts = 3.3;  ///< of the ADC

  /// Throws std::invalid_argument if a number has no meaning.
  HeatSensor(const HeatConfig& config, PinBus& bus, Drives& drives);
  HeatSensor(const HeatSensor&) = delete;
  HeatSensor& operator=(const HeatSensor&) = delete;

  Picoseconds next_event() const { return next_; }
  void advance(Picoseconds to);

  struct Sample {
    Picoseconds at;
    double rise_k;
  };
  /// The temperature at every period from the first light on.
  const std::vector<Sample>& samples() const { return samples_; }

 private:
  void pin_changed(Pin pin, bool level, Picoseconds at) override;
  void power_changed(std::uint16_t power, Picoseconds at) override;
  void load_moves(int axis, std::int32_t place, Picoseconds at) override;
  void heat_until(Picoseconds to);
  double speed_factor();

  const HeatConfig config_;
  PinBus& bus_;
  bool gate_ = false;
  std::uint16_t power_ = 0;
  HeatChange change_{};
  std::size_t changes_made_ = 0;
  double rise_k_ = 0, factor_ = 1, mm_s_ = 0;
  std::array<std::int32_t, 2> moved_{};  ///< steps of X and Y in this period
  std::array<std::int32_t, 2> place_{};
  Picoseconds heated_ = 0, next_ = 0;
  bool was_lit_ = false;
  std::vector<Sample> samples_;
};

}  // namespace lamplock::sim
