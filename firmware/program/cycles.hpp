// Canned cycles: drilling, with a dwell, in pecks, breaking chips (G81, G82, G83, G73), boring
// (G85, G86, G89).
//
// In:  a hole, its repetitions and their distance, the levels along the axis of the tool.
// Out: the moves, one at a time.
// Who: the interpreter, main loop; a move costs some hundred cycles.
//
// The moves are those of "The NIST RS274/NGC Interpreter - Version 3", section 3.5.16: up to the
// retract level if below it, then for each hole: across, down to the retract level, the cut, and
// back to the retract level (G99) or to where the series began (G98). G83 and G73 are LinuxCNC's:
// after each peck G83 leaves the hole and returns to a clearance above the last depth, G73 only
// rises by the clearance. G85 leaves the hole at the feed up to the retract level, G89 up to the
// end, G86 as a rapid while the spindle rests. Moves of no length are left out, but a hole is
// always cut.
#pragma once

#include <cstdint>

#include "firmware/program/modal.hpp"
#include "firmware/program/value.hpp"

namespace lamplock::program {

/// Places are programmed ones, 10^-7 mm; levels are places along the axis `normal`.
struct CycleRequest {
  Place start;                        ///< where the tool is
  Place first;                        ///< over the first hole; its level is ignored
  Place step;                         ///< from hole to hole; zero along the normal
  std::int64_t retract_e7, depth_e7;  ///< retract_e7 >= depth_e7
  std::int64_t end_e7;                ///< level after each hole
  std::int64_t peck_e7;               ///< above 0 in G83 and G73
  std::int64_t clearance_e7;          ///< above the last peck
  std::uint32_t holes;                ///< at least 1
  Motion kind;
  std::uint8_t normal;
};

/// One move of a cycle.
struct CycleMove {
  enum class Kind : std::uint8_t { rapid, cut, dwell, spindle_off, spindle_on };
  Kind kind;
  bool bottom;  ///< the end of a cut is the bottom of the hole
  Place to;
};

class DrillCycle {
 public:
  void begin(const CycleRequest& request);
  /// The cycle that has begun last.
  const CycleRequest& request() const { return request_; }
  /// The next move; false when there is none left.
  bool next(CycleMove& move);

 private:
  enum class Phase : std::uint8_t {
    rise,
    cross,
    approach,
    cut,
    clear,
    enter,
    dwell,
    stop,
    bore_out,
    leave,
    start,
    done
  };

  /// Advances by one phase; returns whether it makes a move.
  bool advance(CycleMove& move);
  bool cross(CycleMove& move);
  bool cut(CycleMove& move);
  bool clear(CycleMove& move);
  Phase after_dwell() const;
  void next_hole();
  bool to_level(CycleMove& move, std::int64_t level_e7, CycleMove::Kind kind);
  std::int64_t above_last_peck() const;

  CycleRequest request_{};
  Place here_{};
  std::int64_t last_depth_e7_ = 0;
  Phase phase_ = Phase::done;
};

}  // namespace lamplock::program
