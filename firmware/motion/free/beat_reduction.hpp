// Improves the beats of a window, and finds the speeds they allow at every point.
//
// In:  a window and feasible beats (beam_search.hpp).
// Out: beats, no more in total; per point the box of speeds that the start can reach and from which
//      the end can be reached.
// Who: the planner (main loop, or the core that plans), point by point; budget: some tens of label
//      steps.
//
// With the beats of all other ways fixed, a change of a few neighbouring ones is possible exactly
// if the forward box at its start, propagated with the new beats, meets the backward box at its
// end. Moves take beats from one way, or take more from one than they give to its neighbour; coarse
// ones first, where ways take tens of beats, then finer ones.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/free/search_effort.hpp"
#include "firmware/motion/profile/window.hpp"

namespace lamplock::motion {

/// Tolerance for rounding at a bound, in addition to a unit for each beat.
inline constexpr std::int32_t rounding_tolerance_qs = 4;

/// Improves one window at a time.
class Improver {
 public:
  /// Begins with feasible beats; false if their boxes cannot be made.
  bool begin(const Window& window, const Effort& effort,
             std::array<std::int32_t, window_points>& beats);
  /// Tries moves at one way; false when there is nothing left to do.
  bool advance(const Window& window, std::array<std::int32_t, window_points>& beats);
  /// Speeds at the end of a way that the start can reach.
  const Box& forwards(std::uint32_t i) const { return forwards_[i]; }
  /// Speeds at the end of a way from which the end of the window can be reached.
  const Box& backwards(std::uint32_t i) const { return backwards_[i]; }

 private:
  using Beats = std::array<std::int32_t, window_points>;

  const Box& before(const Window& window, std::uint32_t i) const {
    return i == 0 ? window.start : forwards_[i - 1];
  }
  bool make_forwards(const Window& window, const Beats& beats, std::uint32_t i);
  bool make_backwards(const Window& window, const Beats& beats, std::uint32_t i);
  bool make_all_backwards(const Window& window, const Beats& beats);
  bool make_all(const Window& window, const Beats& beats);
  void end_pass(const Window& window, Beats& beats);
  bool possible(const Window& window, const Beats& beats, std::uint32_t i,
                std::uint32_t ways) const;
  bool try_move(const Window& window, Beats& beats, std::uint32_t i, std::int32_t first,
                std::int32_t second);
  bool try_moves(const Window& window, Beats& beats, std::uint32_t i);

  std::array<Box, window_points> forwards_{}, backwards_{};
  std::uint32_t at_ = 0;   ///< next way to try
  std::int32_t size_ = 1;  ///< of a move, beats
  bool pairs_ = false;     ///< moves between two ways are tried
  bool improved_ = false;  ///< in this pass: the forward boxes after this way change
  bool lost_ = false;      ///< and could not be made
  Beats kept_{};           ///< the last beats with all boxes
};

}  // namespace lamplock::motion
