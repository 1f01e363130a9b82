// SENSOR, the voltage of a temperature sensor ($1061), on boards whose row has such a pin.
//
// In:  a pad of the ADC. Out: its voltage, of the last conversion. Who: main loop.
//
// The converter runs freely at 500 kHz (96 cycles of 48 MHz, datasheet 4.9.1), so a reading is at
// most 4 us old and nothing waits for it. The pull-down of the pad, some 50 kOhm, takes an open
// wire to 0 V, which is below the range of a sensor that works ($1068).
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/registers/adc.hpp"
#include "firmware/boards/rp2040/registers/clocks.hpp"
#include "firmware/boards/rp2040/registers/pads_bank0.hpp"
#include "firmware/boards/rp2040/registers/resets.hpp"
#include "shared/boards/this_board.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::rp2040 {

class Sensor {
 public:
  static constexpr bool exists = boards::has(boards::Role::sensor);
  static_assert(!exists || LAMPLOCK_SENSOR_SETTINGS, "this core has no settings of a sensor");

  /// Starts the conversions. Before it the pad is an input of the map, with pull-down.
  [[gnu::cold]] static void start() {
    if constexpr (exists) {
      clocks().adc.ctrl = clock_field::adc_aux_pll_usb | clock_field::enable;
      release_reset(reset_bit::adc);
      // Not digital: its buffer would draw current at voltages in between.
      pads_bank0().gpio[gpio] = pad::output_disable | pad::pull_down;
      adc().cs = adc_cs::enable | adc_cs::input(gpio - boards::first_analog_gpio);
      while ((adc().cs & adc_cs::ready) == 0) {
      }
      adc().div = 0;
      adc().cs = adc().cs | adc_cs::start_many;
    }
  }
  /// 65536 = the reference, 3.3 V.
  static std::uint16_t level() { return static_cast<std::uint16_t>(adc().result << 4); }

 private:
  static constexpr unsigned gpio = boards::optional_gpio(boards::Role::sensor);
};

}  // namespace lamplock::rp2040
