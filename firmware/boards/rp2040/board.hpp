// The board: owns the core and every driver, runs the main loop, hands interrupts on.
//
// In:  interrupts, by the handlers in board.cpp. Out: everything a machine does.
// Who: main() makes one, in memory of its own, and calls run().
//
// One pass of the main loop takes bytes in, writes what has changed to flash, lets the core work,
// hands answers out, looks at the switches, enters the boot loader if that was asked for and signs
// for the watchdog. Then it sleeps: whatever it waits for comes with an interrupt, and the beat's
// comes 100 us after the one before at the latest, or is a plan that core 1 has completed. Beat and
// fill interrupts are masked while the core's shared data is touched, a piece at a time.
//
// Core 1 plans and does nothing else: no interrupts, no outputs, no flash. It sleeps until core 0
// hands it a plan; what belongs to whom meanwhile is in machine/job_runner.hpp. If it does not
// start (another simulator, a debugger) the main loop plans, slice by slice, with all interrupts
// open. An e-stop waits for nothing of this; a fault on core 1 ends in the same handler; a slice of
// it that does not end is not signed, and the watchdog restarts both.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/boards/rp2040/interrupts.hpp"
#include "firmware/boards/rp2040/last_run.hpp"
#include "firmware/boards/rp2040/ports.hpp"
#include "firmware/boards/rp2040/real_time.hpp"
#include "firmware/boards/rp2040/storage.hpp"
#include "firmware/boards/rp2040/uart/uart_hardware.hpp"
#include "firmware/boards/rp2040/usb/usb_hardware.hpp"
#include "firmware/boards/rp2040/watchdog.hpp"
#include "firmware/machine/controller.hpp"

namespace lamplock::rp2040 {

using Ports = BasicPorts<UsbSerial, UartSerial>;

class Board {
 public:
  [[gnu::cold]] explicit Board(const Rings& rings);
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  [[noreturn]] void run();
  /// Core 1, for good.
  [[noreturn]] void plan_for_ever();

  // Interrupts.
  void estop_interrupt() {
    // The beat's interrupt forces it too, to get the signature.
    if ((io_bank0().intr[estop_word] & estop_edge) != 0) real_time_.estop_interrupt();
    clear_bits(io_bank0().proc0_intf[estop_word], estop_edge);
    watchdog_.sign(Signer::estop);
  }
  void edge_interrupt() {
    real_time_.edge_interrupt(core_);
    note_shots();
  }
  void beat_interrupt() {
    real_time_.beat_interrupt(core_);
    note_shots();
    watchdog_.sign(Signer::beat);
    // The e-stop's interrupt comes when it is pressed only: it is called up to sign. From here, for
    // from the main loop it would keep that from sleeping.
    if (!watchdog_.has_signed(Signer::estop))
      set_bits(io_bank0().proc0_intf[estop_word], estop_edge);
  }
  void note_shots() {
    // A shot that was fired must not be fired again, however this run ends; one that is given out
    // the hardware fires by itself.
    const std::uint32_t shots = core_.shots().ledger().shots();
    const bool shot_out = core_.shots().token_out();
    if (shots != noted_shots_ || shot_out != noted_shot_out_) {
      noted_shots_ = shots;
      noted_shot_out_ = shot_out;
      note_job();
    }
  }
  void fill_interrupt() {
    real_time_.fill_interrupt(core_);
    watchdog_.sign(Signer::fill);
  }
  void usb_interrupt() { ports_.usb().interrupt(); }
  void uart_interrupt() { ports_.uart().interrupt(); }

 private:
  /// Bytes handed over in one piece: a packet of USB. The core masks interrupts itself.
  static constexpr std::size_t piece = 64;
  /// Taken in one pass: some 30 points. A plan that is ready must not wait for more of them.
  static constexpr int most_pieces = 4;
  static constexpr unsigned estop_word = io_interrupt::word(boards::gpio(boards::Role::estop));
  static constexpr std::uint32_t estop_edge =
      io_interrupt::edge_high(boards::gpio(boards::Role::estop));

  [[gnu::cold]] void start();
  [[gnu::cold]] void start_ports();
  [[gnu::cold]] void say_rejected(std::string_view what, std::uint32_t records);
  /// Hands over what was kept when the power went.
  [[gnu::cold]] void start_kept();
  /// One round of the main loop; true if there is more to do at once.
  bool pass();
  void receive();
  [[gnu::cold]] void receive_realtime();
  /// Motion and state; true while a plan is being made here, or if one was complete.
  bool work();
  /// Looks what is to be planned; true as work().
  bool prepare();
  /// Hands out what there is room for; true if there was something.
  bool hand_out();
  void sign();
  void transmit();
  void store_settings();
  void store_kept();
  /// Beat interrupt, or main loop with it masked.
  void note_job() {
    const machine::JobMark mark = core_.job_mark();
    note_progress(mark.session, mark.first_unfired, mark.shot_out);
  }
  [[noreturn, gnu::cold]] void enter_loader();

  Storage storage_;
  const boards::PinMap map_;
  const machine::InterruptMask mask_ = core_mask();
  machine::Controller core_;
  Ports ports_;
  Watchdog watchdog_;
  std::uint32_t noted_shots_ = 0;
  bool noted_shot_out_ = false;
  bool second_core_ = false;  ///< it plans
  RealTime real_time_;
};

}  // namespace lamplock::rp2040
