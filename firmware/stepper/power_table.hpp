// Powers of the cells of rows: what a continuous laser shines with, cell by cell.
//
// In:  runs of cells of one power, list by list; a line of a program has one list.
// Out: the same, for whoever runs that line. A list is known by the place of its header.
// Who: the main loop writes (begin_list() to end_list(), forget()); the planner, maybe another
// core,
//      asks for cells() before anything of the line is handed out; the fill interrupt reads and
//      releases. Every index has one writer, but for forget(), which is for when nothing runs.
//
//   released | list that is run | lists that wait | list being written
//            begin_             ^ header, runs    end_              written_
//
// A run has 16 bits: 11 for the power, a little more than the 2000 counts of a duty of LASER PWM,
// and 5 for how many cells: 1 to 16, or a power of two from 32 to 65536. Longer runs are several.
// 1024 runs are 100 mm of grey pixels of 0.1 mm, four times the way that 300 mm/s need to come to
// rest at 2 m/s2.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace lamplock::stepper {

class PowerTable {
 public:
  static constexpr std::uint32_t capacity = 1024;

  // Main loop.
  /// So many cells more of this power, 65535 = full, behind the list being written, which begins
  /// where there is none; false if there is no room now.
  bool add(std::uint16_t power, std::uint32_t cells) {
    const std::uint32_t header = written_ == end_ ? 1 : 0;
    if (header + runs_of(cells) > capacity - (written_ - load(begin_))) return false;
    if (header != 0) cells_ = 0, ++written_;
    cells_ += cells;
    while (cells != 0) {
      const std::uint32_t code = code_of(cells);
      at(written_++) = static_cast<std::uint16_t>(packed(power) << code_bits | code);
      cells -= cells_of(code);
    }
    return true;
  }
  /// The list is complete; where it begins.
  std::uint16_t end_list() {
    const std::uint32_t header = end_;
    at(header) = static_cast<std::uint16_t>(cells_);
    end_ = written_;
    return static_cast<std::uint16_t>(header);
  }
  /// The list being written will not be wanted.
  void drop_list() { written_ = end_; }
  /// Nothing is run nor will be: lists that are complete are not wanted.
  void forget() { store(begin_, end_); }

  // Whoever plans, and the fill interrupt.
  /// Cells of a list.
  std::uint32_t cells(std::uint16_t list) const { return slots_[list % capacity]; }

  // The fill interrupt.
  std::uint16_t run(std::uint16_t place) const { return slots_[place % capacity]; }
  static constexpr std::uint16_t power(std::uint16_t run) {
    const std::uint32_t power = run >> code_bits;
    return static_cast<std::uint16_t>(power << code_bits | power >> (power_bits - code_bits));
  }
  static constexpr std::uint32_t cells_in(std::uint16_t run) {
    return cells_of(run & ((1u << code_bits) - 1));
  }
  /// What lies before this place is not read any more.
  void release(std::uint16_t before) {
    const auto ahead = static_cast<std::uint16_t>(before - static_cast<std::uint16_t>(begin_));
    if (ahead <= capacity) store(begin_, begin_ + ahead);
  }

 private:
  static constexpr int power_bits = 11, code_bits = 5;
  static constexpr std::uint32_t short_codes = 16;

  static constexpr std::uint32_t cells_of(std::uint32_t code) {
    return code < short_codes ? code + 1 : 2 * short_codes << (code - short_codes);
  }
  /// The longest run that is no longer.
  static constexpr std::uint32_t code_of(std::uint32_t cells) {
    if (cells < 2 * short_codes) return (cells < short_codes ? cells : short_codes) - 1;
    return short_codes + static_cast<std::uint32_t>(std::bit_width(cells / (2 * short_codes))) - 1;
  }
  static constexpr std::uint32_t runs_of(std::uint32_t cells) {
    std::uint32_t runs = 0;
    for (; cells != 0; ++runs) cells -= cells_of(code_of(cells));
    return runs;
  }
  /// To the nearest of 2048.
  static constexpr std::uint32_t packed(std::uint32_t power) {
    return (power - (power >> power_bits) + short_codes) >> code_bits;
  }

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
};

}  // namespace lamplock::stepper
