// Timing of a board as its pins show it, to the cycle: shots, steps, every pin's edges.
//
// In:  edges of the pads, calls of both cores, the memory of their stacks.
// Out: the numbers of the timing table. Listens from construction on; costs some ns an edge.
//
// Shot phase: Q-SWITCH rise less LAMP SYNC rise less the set delay. Step error: deviation of a step
// edge (of STEP; of CW or CCW; of A or B) from the position, after the tick line's rise, of the
// first such edge; on a board that keeps to its lattice it is always 0.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/chip/profile/profile.hpp"
#include "sim/chip/profile/shadow_stack.hpp"
#include "sim/chip_board/chip_board.hpp"

namespace lamplock::sim {

/// Edges of one pin.
struct PinEdges {
  std::string name;
  unsigned gpio = 0;
  std::uint64_t rises = 0;
  Picoseconds min_high = never;
  Picoseconds min_low = never;
};

/// Results of the measurement.
struct TimingTable {
  std::uint64_t shots = 0;
  double phase_mean_ns = 0, phase_p999_ns = 0,
         phase_worst_ns = 0;  ///< of the magnitude, except the mean
  std::uint64_t steps = 0;
  double step_error_worst_ns = 0;
  double cycle_ns = 8;
  struct Interrupt {
    std::string name;
    std::uint64_t count = 0;
    double mean_us = 0, max_us = 0, load = 0;  ///< load: share of all cycles
  };
  std::vector<Interrupt> interrupts;
  double interrupt_load = 0;  ///< of all interrupts, nested ones once
  double max_masked_us = 0;
  double planner_load = 0;  ///< time core 1 is awake; 0 if core 0 plans
  struct Stack {
    std::uint32_t used = 0, size = 0;
  };
  std::array<Stack, 2> stacks;  ///< of each core
  std::uint32_t ram_used = 0, ram_size = 0;
  std::uint32_t flash_used = 0, flash_size = 0;
  std::vector<PinEdges> pins;
};

/// Measures one board; must live as long as the board runs.
class BoardTiming final : private chip::PadListener {
 public:
  BoardTiming(ChipBoard& board, const chip::Image& image);
  BoardTiming(const BoardTiming&) = delete;
  BoardTiming& operator=(const BoardTiming&) = delete;

  /// Computes the table for the set delay from LAMP SYNC to Q-SWITCH.
  TimingTable table(Picoseconds delay) const;
  /// Profile of core 0.
  const chip::Profile& profile() const { return profile_; }
  /// The same of both cores.
  std::string profile_text() const { return profile_.text() + "\n" + profile1_.text(); }

 private:
  struct Pad {
    std::uint64_t rises = 0;
    chip::Cycle rose = 0, fell = 0;
    chip::Cycle min_high = chip::never_cycle, min_low = chip::never_cycle;
  };
  void pad_changed(unsigned gpio, bool level, chip::Cycle at) override;
  void find_step_edges();
  void measure_steps(chip::Cycle at);

  ChipBoard& board_;
  const chip::Image& image_;
  chip::ShadowStack calls_, calls1_;
  const unsigned sync_gpio_, q_switch_gpio_, tick_gpio_;
  const bool sync_inverted_;  ///< between the lamp and the pad is an inverter
  chip::Profile profile_{calls_}, profile1_{calls1_};
  std::array<Pad, chip::gpio_count> pads_{};
  std::vector<std::int64_t> phases_;  ///< cycles from LAMP SYNC to Q-SWITCH
  /// Which edges of a pin are steps: falling, rising.
  std::array<std::array<bool, 2>, chip::gpio_count> step_edges_{};
  bool first_step_ = true;
  std::int64_t step_latency_ = 0;
  std::uint64_t steps_ = 0;
  std::int64_t step_error_worst_ = 0;  ///< cycles
};

/// The table as text.
std::string timing_text(const TimingTable& table);

}  // namespace lamplock::sim
