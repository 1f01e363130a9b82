// Powers of the cells of rows: the power of a continuous laser, cell by cell.
//
// In:  runs of cells of one power, list by list; a line of a program has one list.
// Out: the same, for the code that runs that line. A list is identified by the place of its header.
// Who: the main loop writes (begin_list() to end_list(), forget()); the planner, maybe another
//      core, calls cells() before any motion of the line is handed out; the fill interrupt reads
//      and releases. Every index has one writer, except in forget(), which needs the machine at
//      rest.
//
//   released | list that is run | lists that wait | list being written
//            begin_             ^ header, runs    end_              written_
//
// A run is coded as on the wire (shared/wire/runs.hpp). 2048 runs are 51 mm of grey pixels of 0.025
// mm; to stop from 750 mm/s at 10 m/s2 takes 28 mm.
#pragma once

#include <array>
#include <cstdint>

#include "shared/wire/run_pace.hpp"
#include "shared/wire/runs.hpp"

namespace lamplock::stepper {

class PowerTable {
 public:
  static constexpr std::uint32_t capacity = 2048;

  // Main loop.
  /// Appends this many cells of one power, 65535 = full, to the list being written, or begins a
  /// list; false if there is no room now.
  bool add(std::uint16_t power, std::uint32_t cells) {
    if (header() + wire::runs_of(cells) > free()) return false;
    while (cells != 0) {
      const std::uint16_t run = wire::max_run(power, cells);
      put(run);
      cells -= wire::run_cells(run);
    }
    return true;
  }
  /// As add() for a run as it was received; there must be room for it, and for a header.
  void put(std::uint16_t run) {
    if (header() != 0) {
      cells_ = 0;
      pace_.begin_list();
      ++written_;
    }
    const std::uint32_t cells = wire::run_cells(run);
    cells_ += cells;
    pace_.add(cells);
    at(written_++) = run;
  }
  /// Places for runs, and for the header of each list.
  std::uint32_t free() const { return capacity - (written_ - load(begin_)); }
  /// Completes the list; returns where it begins.
  std::uint16_t end_list() {
    const std::uint32_t header = end_;
    at(header) = static_cast<std::uint16_t>(cells_);
    end_ = written_;
    return static_cast<std::uint16_t>(header);
  }
  /// Minimum time of a line with the list that was completed last.
  std::uint32_t min_us() const { return pace_.min_us(); }
  /// Drops the list being written.
  void drop_list() { written_ = end_; }
  /// Drops the complete lists; nothing must run them, now or later.
  void forget() { store(begin_, end_); }

  // The planner, and the fill interrupt.
  /// Cells of a list.
  std::uint32_t cells(std::uint16_t list) const { return slots_[list % capacity]; }

  // The fill interrupt.
  std::uint16_t run(std::uint16_t place) const { return slots_[place % capacity]; }
  /// Runs before this place are no longer read.
  void release(std::uint16_t before) {
    const auto ahead = static_cast<std::uint16_t>(before - static_cast<std::uint16_t>(begin_));
    if (ahead <= capacity) store(begin_, begin_ + ahead);
  }

 private:
  /// Additional places that the next run needs.
  std::uint32_t header() const { return written_ == end_ ? 1 : 0; }

  static void store(std::uint32_t& word, std::uint32_t value) {
    __atomic_store_n(&word, value, __ATOMIC_SEQ_CST);
  }
  static std::uint32_t load(const std::uint32_t& word) {
    return __atomic_load_n(&word, __ATOMIC_SEQ_CST);
  }
  std::uint16_t& at(std::uint32_t i) { return slots_[i % capacity]; }

  std::array<std::uint16_t, capacity> slots_{};
  std::uint32_t begin_ = 0;
  std::uint32_t end_ = 0;
  std::uint32_t written_ = 0;
  std::uint32_t cells_ = 0;  ///< of the list being written
  wire::RunPace pace_;       ///< of the same
};

}  // namespace lamplock::stepper
