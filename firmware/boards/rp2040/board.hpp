// The board: owns the core and every driver, runs the main loop, passes interrupts on.
//
// In:  interrupts, by the handlers in board.cpp. Out: all outputs of the machine.
// Who: main() constructs it in static memory and calls run().
//
// One pass of the main loop reads received bytes, writes changes to flash, runs the core, sends
// answers, reads the switches, enters the boot loader if requested and signs for the watchdog. Then
// it sleeps: every event that it waits for is an interrupt, at the latest the beat's every 100 us,
// or the event of core 1 when a plan is complete. Beat and fill interrupts are masked while the
// main loop uses the core's shared data, for a short time each.
//
// Core 1 only plans: no interrupts, no outputs, no flash. It sleeps until core 0 hands it a plan;
// machine/runners/job_runner.hpp lists the ownership of data meanwhile. If it does not start
// (another simulator, a debugger) the main loop plans, slice by slice, with all interrupts enabled.
// An e-stop never waits for planning; a fault on core 1 ends in the same handler; a slice that does
// not end does not sign, and the watchdog restarts both cores.
#pragma once

#include <cstdint>
#include <string_view>

#include "firmware/boards/rp2040/base/interrupts.hpp"
#include "firmware/boards/rp2040/base/watchdog.hpp"
#include "firmware/boards/rp2040/drives/drives.hpp"
#include "firmware/boards/rp2040/ports.hpp"
#include "firmware/boards/rp2040/real_time.hpp"
#include "firmware/boards/rp2040/storage/planner_loader.hpp"
#include "firmware/boards/rp2040/storage/restart_record.hpp"
#include "firmware/boards/rp2040/storage/storage.hpp"
#include "firmware/boards/rp2040/uart/uart_hardware.hpp"
#include "firmware/boards/rp2040/usb/usb_hardware.hpp"
#include "firmware/machine/controller.hpp"

namespace lamplock::rp2040 {

using Ports = BasicPorts<UsbSerial, UartSerial>;

class Board {
 public:
  [[gnu::cold]] explicit Board(const Rings& rings);
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;

  [[noreturn]] void run();
  /// Core 1; never returns.
  [[noreturn]] void plan_for_ever();

  // Interrupts.
  void estop_interrupt() {
    // The beat interrupt forces it too, to get the signature.
    if ((io_bank0().intr[Estop::word] & Estop::edge) != 0) real_time_.estop_interrupt();
    clear_bits(io_bank0().proc0_intf[Estop::word], Estop::edge);
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
    // The e-stop interrupt occurs only on a press: here it is forced, to sign. From the beat
    // interrupt, because from the main loop it would prevent sleeping.
    if (!watchdog_.has_signed(Signer::estop))
      set_bits(io_bank0().proc0_intf[Estop::word], Estop::edge);
  }
  void note_shots() {
    // A shot that was fired must not be fired again, however this run ends; a shot that was handed
    // out may still be fired by the hardware.
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
  void usb_interrupt() {
    const std::uint32_t begun_us = timer().timerawl;
    ports_.usb().interrupt();
    real_time_.usb_served(begun_us);
  }
  void uart_interrupt() { ports_.uart().interrupt(); }

 private:
  /// Bytes per piece: a packet of USB. The core masks interrupts itself.
  static constexpr std::size_t piece = 64;
  /// Pieces per pass: some 30 points. A completed plan must not wait for more of them.
  static constexpr int max_pieces = 4;

  [[gnu::cold]] void start();
  [[gnu::cold]] void start_ports();
  [[gnu::cold]] void report_rejected(std::string_view what, std::uint32_t records);
  [[gnu::cold]] void report_replaced();
  /// Restores the data that was kept over the power cut.
  [[gnu::cold]] void start_kept();
  /// One round of the main loop; true if there is more to do at once.
  bool pass();
  void receive();
  [[gnu::cold]] void receive_realtime();
  /// Copies a piece of the planner that is missing; true if one was.
  bool load_planner();
  /// Motion and state; true while this core plans, or if a plan was complete.
  bool work();
  /// Decides what to plan, or loads the planner for it; returns as work().
  bool prepare();
  /// Hands out all parts with room; true if there was one.
  bool hand_out();
  void sign();
  void transmit();
  void store_settings();
  /// Sets up and watches drives that are on the board.
  [[gnu::cold]] void serve_drives();
  void store_kept();
  /// Beat interrupt, or main loop with it masked.
  void note_job() {
    const machine::ResumePoint mark = core_.job_mark();
    note_progress(mark.session, mark.first_unfired, mark.shot_out);
  }
  [[noreturn, gnu::cold]] void enter_loader();

  Storage storage_;
  const boards::Pins map_;
  const machine::InterruptMask mask_ = core_mask();
  machine::Controller core_;
  Ports ports_;
  Watchdog watchdog_;
  PlannerLoader planners_;
  std::uint32_t noted_shots_ = 0;
  bool noted_shot_out_ = false;
  bool second_core_ = false;  ///< core 1 plans
  RealTime real_time_;
  [[no_unique_address]] Drives drives_;
};

}  // namespace lamplock::rp2040
