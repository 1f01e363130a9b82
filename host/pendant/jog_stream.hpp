// Sends a jog as short increments, no more than the machine needs, and stops it.
//
// In:  a direction or a way with a feed until a deadline; single steps; a request to stop.
// Out: lines `$J=` and jog cancels (0x85) to the board.
// Who: the jogger. poll() is one round of a loop with a period of a few ms.
//
// Manual motion must stop when the user stops. So a jog at a speed is a row of increments of 10 ms,
// and those sent are never more than 60 ms ahead of the time the machine has had for them. It
// brakes by itself when no more increments arrive: if this program or the cable fails, it stops
// after 60 ms and its braking distance. Higher speeds need no longer lead: during acceleration the
// machine lags by v2/2a, which is the distance it must see ahead to brake.
// A cancel is sent before all lines; lines of which no byte was sent are dropped; the cancel is
// repeated until a report says that the machine is at rest. No new motion begins before.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "host/link/board_settings.hpp"
#include "host/pendant/board_dialog.hpp"
#include "shared/units.hpp"

namespace lamplock::pendant {

/// Limits of a machine, from its settings.
struct JogLimits {
  int axes = 3;
  PerAxis<double> rate_mm_min{}, acceleration_mm_s2{};
};
JogLimits jog_limits(const settings::Values& values);

/// -1, 0 or 1 by axis.
using Direction = PerAxis<int>;

/// Counts for reports.
struct JogCounts {
  std::uint32_t lines = 0, cancels = 0, refused = 0;
};

class JogStream {
 public:
  /// `talk` must outlive it; the caller of talk.poll() passes answers to take().
  JogStream(BoardDialog& talk, const JogLimits& limits) : talk_(talk), limits_(limits) {}

  /// Moves in this direction until the deadline, which a new call extends. Before a change of
  /// direction the machine stops.
  void run(const Direction& direction, double feed_mm_min, Time until);
  /// Moves by a way [mm] along a straight line, from rest, unless the deadline comes before its
  /// end. False while other motion is under way.
  bool travel(const PerAxis<double>& way_mm, double feed_mm_min, Time until);
  /// A later deadline of the way that is travelled now, if any.
  void extend(Time until);
  /// Moves `count` steps along an axis, less those that do not fit into 250 ms. Returns the number
  /// of steps sent: 0 during a stop.
  int step(int axis, double step_mm, int count, double feed_mm_min);
  /// One jog to a position, "G90X0Y0"; false while other motion is under way.
  bool go(const std::string& words, double feed_mm_min);
  /// Stops all jogs. May be called at any time, also repeatedly.
  void stop();
  /// After a reset of the board, which stops it.
  void forget();

  void take(const Answered& answer);
  void poll();

  /// A jog may move the machine.
  bool moves() const { return moves_; }
  bool stopping() const { return stopping_; }
  /// A jog at a speed is active, not steps.
  bool runs() const { return wanted_.has_value(); }
  const JogCounts& counts() const { return counts_; }
  const JogLimits& limits() const { return limits_; }

 private:
  using Way = PerAxis<double>;
  struct Run {
    Way direction{};  ///< of length 1
    double speed_mm_s = 0;
    Time until{};
    std::optional<double> left_mm{};  ///< of a way
  };

  double max_feed(const Way& direction, double feed_mm_min) const;
  void feed();
  int increments_of(double speed_mm_s, Time duration) const;
  void send_increment(const Run& run, Time duration);
  bool too_far_ahead() const;
  void send(const Way& way, double feed_mm_min, Time duration);
  void send_cancel();
  void keep_stopping();
  void check_at_rest();

  BoardDialog& talk_;
  JogLimits limits_;
  std::optional<Run> wanted_;
  std::optional<Time> ends_at_;  ///< deadline of increments that lead to the end of way or travel
  bool travels_ = false;         ///< a way, until the machine is at rest
  Way under_way_{};              ///< direction of the increments sent last
  Way rest_{};                   ///< of the distance, below the resolution of a line
  Way sent_mm_{};                ///< since the machine was last at rest
  std::vector<double> stood_at_mm_;  ///< position then, machine or work
  std::deque<Way> unanswered_;       ///< distances of the increments
  Time busy_until_{};                ///< when the machine has completed the increments sent
  Time cancelled_at_{};
  std::size_t reports_then_ = 0;  ///< count of reports at the last line, answer or cancel
  bool moves_ = false, stopping_ = false, cancel_again_ = false;
  bool goes_ = false;  ///< a jog to a position, of unknown duration
  JogCounts counts_;
};

}  // namespace lamplock::pendant
