// Beam search: finds the number of beats to each point of a window.
//
// In:  a window (window.hpp).
// Out: beats of every way, such that every axis can continue and, at the end of the window, has an
//      allowed position and speed.
// Who: the planner (main loop, or the core that plans), point by point, so that a main loop that
//      plans can do other work in between; budget: a few label steps (window.hpp, step()) per
//      candidate.
//
// A label is a number of beats so far and the box of speeds the machine can have at the point; axes
// couple only through the common beats, so propagating boxes is exact. A label that another one
// with no more beats contains is dropped. The others are ranked by beats and the fewest beats of
// the next way; the best ones are kept, and always one that can rest at the point: from it the rest
// costs no more than stopping at every point, so an early choice cannot make the window infeasible.
//
// Candidates of a way are one beat apart at first and then so far that a few dozen cover all from
// the fewest possible to those from rest to rest; beat_reduction.hpp closes the gaps.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/motion/free/search_effort.hpp"
#include "firmware/motion/profile/window.hpp"

namespace lamplock::motion {

/// Searches one window at a time.
class Beam {
 public:
  void begin(const Window& window, const Effort& effort);
  /// Extends every label to point `i`; in order from 0. False: the point cannot be reached.
  bool extend(const Window& window, std::uint32_t i);
  /// Bit i: at the end of way i even the quickest label was much later than the previous best label
  /// had predicted: every label that quick was a dead end.
  std::uint64_t disappointed() const { return disappointed_; }
  /// Beats of all ways of the best label, after the last point has been reached.
  void trace(const Window& window, std::array<std::int32_t, window_points>& beats) const;

 private:
  struct Label {
    std::int32_t total = 0;  ///< beats from the start of the window
    std::int32_t next = 0;   ///< fewest beats of the next way, for ranking
    std::uint16_t beats = 0;
    std::uint8_t parent = 0;
    bool may_rest = false;
    Box box{};
    Box next_box{};  ///< at the next point, with `next` beats

    std::int32_t rank() const { return total + next; }
  };
  struct Trace {
    std::uint16_t beats = 0;
    std::uint8_t parent = 0;
  };

  [[gnu::cold]] bool disappoints() const;
  void extend_label(const Window& window, std::uint32_t i, std::uint8_t parent);
  bool too_late(std::int32_t total, const Leg* next) const;
  void keep(const Window& window, Label& label, const Leg* next);
  bool dominated(const Window& window, const Label& label) const;
  void drop_dominated_by(const Window& window, const Label& label);
  void insert(const Label& label);
  std::uint32_t place_to_lose() const;

  Effort effort_;
  std::uint64_t disappointed_ = 0;
  std::uint32_t from_count_ = 0, to_count_ = 0;
  std::array<Label, max_labels> from_{}, to_{};  ///< to_ is sorted, best first
  std::array<std::array<Trace, max_labels>, window_points> traces_{};
};

/// Fewest beats of a way from some speed of a box, and the speeds at its end; 0 if there are none.
std::int32_t fewest_beats(const Window& window, const Leg& way, const Box& from, Box& to);

}  // namespace lamplock::motion
