// All time-critical parts of the board: lattice, fire stage, e-stop, switches.
//
// In:  the core (the caller's), interrupts, the main loop.
// Out: steps, shots, edges for the core.
//
//   function           called from                              budget
//   start              main loop, once, interrupts masked       3 ms
//   estop_interrupt    IO_IRQ_BANK0, priority 0                 1.25 us, off after 0.5 us
//   edge_interrupt     PIO0_IRQ_0, priority 1                   45 us
//   beat_interrupt     TIMER_IRQ_1, priority 1                  40 us
//   fill_interrupt     interrupt 26, priority 3                 25 % of the time in motion, a third
//                                                               with what interrupts it
//   poll               main loop, every 1 ms, beat and fill masked at the NVIC; 3 ms when it
//                      starts the lattice again (e-stop, limit, ticks that ran out)
//
// Time: the core counts system clocks; clock 0 is start(). The microsecond timer runs from the same
// crystal and gives the present clock within 1 us; edges and ticks are exact by TICK and STAMP,
// which start with one store. After a stop (e-stop) the lattice starts again at real time, within 1
// us.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/base/program_pins.hpp"
#include "firmware/boards/rp2040/fire/beam_output.hpp"
#include "firmware/boards/rp2040/fire/fire_unit.hpp"
#include "firmware/boards/rp2040/lattice/lattice_output.hpp"
#include "firmware/boards/rp2040/lattice/step_expander.hpp"
#include "firmware/boards/rp2040/lattice/tick_feed.hpp"
#include "firmware/boards/rp2040/registers/timer.hpp"
#include "firmware/boards/rp2040/safety/estop.hpp"
#include "firmware/boards/rp2040/safety/inputs.hpp"
#include "firmware/machine/controller.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

/// Ring buffers of DMA; each needs an address aligned to its size. All zero at first.
struct Rings {
  TickRing& ticks;
  LatticeRings& lattice;
  PowerRing& power;
  StampRing& stamps;
};

/// One per board.
class RealTime {
 public:
  RealTime(boards::Pins map, const Rings& rings)
      : tick_ring_(rings.ticks),
        map_(map),
        expander_(rings.lattice, rings.power),
        feed_(rings.ticks),
        stamps_(rings.stamps),
        lattice_(rings.lattice, rings.power, rings.ticks, rings.stamps),
        fire_(lattice_, feed_, stamps_),
        beam_(map),
        programs_(map),
        estop_(fire_),
        inputs_(map) {}
  RealTime(const RealTime&) = delete;
  RealTime& operator=(const RealTime&) = delete;

  /// Starts pins, state machines, DMA, in the order that keeps every energy output low; then the
  /// lattice runs. The board sets the NVIC's enables and priorities, before or after. False: this
  /// image is not for this board, and no pin is driven.
  [[gnu::cold]] bool start(machine::Controller& core);

  void estop_interrupt() { estop_.interrupt(); }
  void edge_interrupt(machine::Controller& core);
  void beat_interrupt(machine::Controller& core);
  void fill_interrupt(machine::Controller& core);
  /// Called after the interrupt of USB, which is above that which fills ticks, and which preempts
  /// masked code: a host that sends packets faster than they can be examined must stop neither, nor
  /// the main loop. After a long one the next waits three times as long, and until enough ticks are
  /// filled.
  void usb_served(std::uint32_t begun_us) {
    constexpr std::uint32_t max_short_us = 50;
    const std::uint32_t now_us = timer().timerawl, took_us = now_us - begun_us;
    if (took_us < max_short_us) return;
    usb_after_us_ = now_us + 3 * took_us;
    usb_waits_ = true;
    nvic().icer = irq_bit(Irq::usbctrl);
  }
  /// Main loop with beat and fill masked, before a long masked section: feeds the full lead of
  /// ticks.
  void top_up(machine::Controller& core);
  void poll(machine::Controller& core);
  /// Main loop with beat and fill masked: whether drives on the board may be enabled. A failure
  /// holds the e-stop until they are permitted again.
  [[gnu::cold]] void permit_drives(bool permitted, bool failed);
  /// Main loop, unmasked, at rest: settings have changed. Waits until the last steps are put out,
  /// less than 3 ms.
  [[gnu::cold]] void change_pulses(machine::Controller& core, const machine::InterruptMask& mask);

  /// Present clock of the core, at most 1 us late. Beat and fill masked, or at their level; at
  /// least every 34 s.
  std::uint64_t now() {
    const std::uint32_t us = timer().timerawl;
    now_ += (us - now_us_) * clocks_per_us;
    now_us_ = us;
    return now_;
  }

 private:
  [[gnu::cold]] void start_pads() const;
  [[gnu::cold]] void start_inputs() const;
  [[gnu::cold]] bool check_board(machine::Controller& core, const stepper::PulseOutput& output);
  void set_drives(bool enabled) const;
  /// False if `most` spans were not enough.
  bool feed_spans(machine::Controller& core, std::uint32_t most);
  [[gnu::cold]] void begin(machine::Controller& core, const StepPosition& steps,
                           std::uint64_t filled);
  /// Fills the next ticks into the rings.
  [[gnu::noinline]] std::uint32_t fill(machine::Controller& core, std::uint32_t ticks);
  /// Starts the lattice, whose first tick begins this many clocks later, and with it a period of
  /// LASER PWM.
  void go(std::uint64_t at_us, std::uint32_t first_tick_clocks);
  [[gnu::cold]] void stop_dead(machine::Controller& core);
  [[gnu::cold]] void input_changed(machine::Controller& core, machine::Input input, bool active,
                                   std::size_t i);
  [[gnu::cold]] StepPosition steps_at_us(machine::Controller& core, std::uint32_t us);
  void apply_outputs(const machine::Controller& core);
  [[gnu::noinline]] void apply_pins(const machine::Controller& core) {
    const auto is_cut = [this] { return estop_.is_cut(); };
    beam_.apply(core.outputs(), is_cut);
    if (programs_.any()) programs_.apply(core.switched_outputs(), is_cut);
  }
  void catch_answers() { answered_ = static_cast<std::uint8_t>(answered_ | beam_.answered()); }
  void report_answers(machine::Controller& core);
  void admit_usb();
  void set_alarm(std::uint32_t wait_us);
  void call_for_token();
  void call_at(std::uint64_t clock);
  bool next_change(const machine::Controller& core, std::uint64_t& clock) const;
  void play_changes(machine::Controller& core);

  TickRing& tick_ring_;
  boards::Pins map_;
  StepExpander expander_;
  TickFeed feed_;
  StampReader stamps_;
  LatticeOutput lattice_;
  FireUnit fire_;
  BeamOutput beam_;
  ProgramPins programs_;
  Estop estop_;
  Inputs inputs_;
  std::array<StepPosition, Inputs::max_inputs> places_{};  ///< position when each began to change
  std::uint8_t placed_ = 0;                                ///< a bit for each known position
  std::uint64_t start_us_ = 0;
  std::uint64_t now_ = 0;       ///< present clock at the last call of now()
  std::uint32_t now_us_ = 0;    ///< lower half of the timer at that call
  std::uint32_t alarm_us_ = 0;  ///< time of the alarm, in the same format
  // Data between the two levels, single words: the lower halves of two tick numbers.
  volatile std::uint32_t filled_end_ = 0;    ///< written by fill, read by beat
  volatile std::uint32_t timed_end_ = 0;     ///< written by beat, read by fill
  volatile bool usb_waits_ = false;          ///< its interrupt is off ...
  volatile std::uint32_t usb_after_us_ = 0;  ///< ... until then at least
  volatile std::uint32_t played_ = 0;        ///< written by beat, read by fill
  bool pads_released_ = false;
  bool drives_active_high_ = false;
  bool drives_permitted_ = !boards::this_board.drives;  ///< set up, if they are on the board
  bool is_held_ = false;                                ///< the e-stop, because drives failed
  bool ask_ = false;                                    ///< request a token this time
  std::uint8_t answered_ = 0;  ///< photosensors not yet reported to the core
};

}  // namespace lamplock::rp2040
