// Copies the planner that the next plan needs from flash to SRAM.
//
// In:  the kind of planner (Controller::missing_planner()). Out: the kind that may run now.
// Who: the main loop, unmasked, in pieces of 0.4 ms, so that it answers the host in between.
//
// Only one planner is used at a time, so all three are linked to the same memory
// (toolchain/arm/rp2040.ld, OVERLAY). This saves 34 KB. Four rules make it safe:
//
//   * Core 1 runs nothing in that memory while it is written: a planner is missing only while no
//     plan is handed out, and none is handed out before its planner is loaded
//     (machine/runners/planning.hpp).
//   * Interrupts never run anything in it, and the main program enters it only through the
//     functions that toolchain/arm/rp2040_entries.txt lists (toolchain/gate_image).
//   * A copy runs only if its CRC is right. After some wrong copies in a row the board makes its
//     outputs safe and restarts; the loader then checks the flash.
//   * The rest of the memory, and all of it until a copy is complete, holds undefined instructions:
//     a fault, whatever a wrong branch reaches.
#pragma once

#include <cstdint>

#include "firmware/machine/runners/planner_kind.hpp"

namespace lamplock::rp2040 {

class PlannerLoader {
 public:
  [[gnu::cold]] PlannerLoader() { clear(); }
  PlannerLoader(const PlannerLoader&) = delete;
  PlannerLoader& operator=(const PlannerLoader&) = delete;

  /// Copies a piece, and checks all of it after the last one. Returns `kind` if it is complete,
  /// else none: no planner may run.
  machine::PlannerKind load(machine::PlannerKind kind);

 private:
  void clear();
  bool copy_is_right(std::uint32_t bytes);

  machine::PlannerKind kind_ = machine::PlannerKind::none;  ///< copied, perhaps in part
  std::uint32_t copied_bytes_ = 0;
  std::uint32_t wrong_copies_ = 0;  ///< in a row
  std::uint32_t sink_ = 0;          ///< DMA writes here the words that only the checksum needs
};

}  // namespace lamplock::rp2040
