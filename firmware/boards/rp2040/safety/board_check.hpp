// Whether this image is on the board that it is for, as far as levels of undriven pins show it.
//
// In:  the row of the board, levels of all pads. Out: a pin that contradicts the row, if there is
// one. Who: RealTime::start(), before any pin is driven; pads are as after a reset, inputs pulled
// down.
//
// An image of another board may drive what a buffer or a switch of this board drives, or switch
// energy on where its own row has an enable. Contradictions are
//   - an output that is high: a pull-up, or another driver. Except enables, which have a pull-up,
//   the
//     UART, and active-low pins of drives, which have one too;
//   - LAMP SYNC active for longer than a pulse of a lamp lasts;
//   - an input behind a buffer of the board that follows the pull of its own pad;
//   - an e-stop at a pin of the ADC that is neither closed nor open: a sensor, or its pull-down.
// A wire that is low for another reason is not found. Where a contradiction is found, no pad is
// driven until the next start.
#pragma once

#include <bit>
#include <cstdint>

#include "firmware/boards/rp2040/registers/adc.hpp"
#include "firmware/boards/rp2040/registers/clocks.hpp"
#include "firmware/boards/rp2040/registers/pads_bank0.hpp"
#include "firmware/boards/rp2040/registers/resets.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"
#include "firmware/boards/rp2040/registers/timer.hpp"
#include "firmware/stepper/pulse_output.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

class BoardCheck {
 public:
  static constexpr int none = -1;

  /// First pin that contradicts the row; `none` if this may be the board.
  [[gnu::cold]] static int wrong_pin(boards::Pins map, const stepper::PulseOutput& pulses) {
    if (const std::uint32_t high = sio().gpio_in & low_outputs(map, pulses); high != 0)
      return std::countr_zero(high);
    if (sync_stays_active()) return boards::gpio(boards::Role::lamp_sync);
    if (const std::uint32_t loose = undriven(); loose != 0) return std::countr_zero(loose);
    if (estop_is_a_sensor()) return boards::gpio(boards::Role::estop);
    return none;
  }
  /// Overrides all peripherals: no pad is driven (PADS_BANK0, OD).
  [[gnu::cold]] static void disable_outputs() {
    for (Register& gpio : pads_bank0().gpio) gpio = gpio | pad::output_disable;
  }

 private:
  /// A flash of a lamp is shorter.
  static constexpr std::uint32_t max_sync_us = 20'000;
  /// For pulls of some 50 kOhm to charge a wire.
  static constexpr std::uint32_t settling_us = 100;

  /// Outputs that are low while nothing drives them.
  [[gnu::cold]] static std::uint32_t low_outputs(boards::Pins map,
                                                 const stepper::PulseOutput& pulses) {
    using boards::Role;
    std::uint32_t pins = 0;
    for (const boards::PinUse& use : map) {
      const bool has_pull_up = boards::is_enable(use.role) || use.role == Role::z_enable ||
                               use.role == Role::uart_tx || use.role == Role::uart_direction;
      if (use.direction == boards::Direction::output && !has_pull_up) pins |= 1u << use.gpio;
    }
    for (int a = 0; a < boards::axes(map); ++a) {
      const stepper::AxisPulses& axis = pulses.axis[index(a)];
      if (axis.first_inverted) pins &= ~boards::pin_of(map, boards::step_role(a));
      if (axis.second_inverted) pins &= ~boards::pin_of(map, boards::dir_role(a));
    }
    return pins;
  }
  static bool sync_stays_active() {
    const std::uint32_t pin = 1u << boards::gpio(boards::Role::lamp_sync);
    const std::uint32_t active = boards::is_inverted(boards::Role::lamp_sync) ? 0 : pin;
    const std::uint32_t begun_us = timer().timerawl;
    while ((sio().gpio_in & pin) == active)
      if (timer().timerawl - begun_us > max_sync_us) return true;
    return false;
  }
  /// A contact pulled up by the pad, at 50 to 80 kOhm (datasheet, 5.5.3.4), is at 0 or 3.3 V. The
  /// pull-down of a sensor, 10 kOhm, makes 0.36 to 0.55 V of it, and a sensor drives what it has.
  [[gnu::cold]] static bool estop_is_a_sensor() {
    constexpr unsigned gpio = boards::gpio(boards::Role::estop);
    if constexpr (gpio >= boards::first_analog_gpio) {
      constexpr std::uint32_t full_scale_mv = 3300, max_closed_mv = 150, min_open_mv = 2500;
      clocks().adc.ctrl = clock_field::adc_aux_pll_usb | clock_field::enable;
      release_reset(reset_bit::adc);
      pull(1u << gpio, pad::pull_up);
      adc().cs = adc_cs::enable | adc_cs::input(gpio - boards::first_analog_gpio);
      wait_for_adc();
      adc().cs = adc().cs | adc_cs::start_once;
      wait_for_adc();
      const std::uint32_t mv = adc().result * full_scale_mv >> 12;
      adc().cs = 0;
      pull(1u << gpio, pad::pull_down);
      return mv > max_closed_mv && mv < min_open_mv;
    }
    return false;
  }
  static void wait_for_adc() {
    while ((adc().cs & adc_cs::ready) == 0) {
    }
  }
  static void pull(std::uint32_t pins, std::uint32_t how) {
    for (; pins != 0; pins &= pins - 1)
      pads_bank0().gpio[std::countr_zero(pins)] =
          pad::input_enable | pad::schmitt | pad::drive_4ma | how;
    const std::uint32_t begun_us = timer().timerawl;
    while (timer().timerawl - begun_us < settling_us) {
    }
  }
  /// Pads that a buffer of the board should drive, but that follow both pulls.
  static std::uint32_t undriven() {
    constexpr std::uint32_t driven = boards::this_board.driven;
    if constexpr (driven == 0) return 0;
    pull(driven, pad::pull_up);
    const std::uint32_t up = sio().gpio_in;
    pull(driven, pad::pull_down);
    return driven & up & ~sio().gpio_in;
  }
};

}  // namespace lamplock::rp2040
