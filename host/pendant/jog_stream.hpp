// Increments of a jog, as many as the machine needs and no more, and their end.
//
// In:  a direction with a feed that holds until a moment; single steps; the wish to stop.
// Out: lines `$J=` and jog cancels (0x85) to the board.
// Who: the jogger. poll() is one round of a loop that comes round every few ms.
//
// What moves by hand must stop with the hand. So nothing is ever asked for that lasts: a jog at a
// speed is a row of increments of 10 ms, and those sent are never more than 60 ms ahead of what the
// machine has been given time for. It brakes by itself when no more come: whatever becomes of this
// program or of the cable, it stops behind 60 ms and its way of braking. Speed needs no more: a
// machine that accelerates falls back by v2/2a, which is the way it must see ahead to brake.
// A cancel goes out before all lines; lines that have not begun to go do not go; it is repeated
// until a report says that the machine stands. Nothing new begins before.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "host/link/board_settings.hpp"
#include "host/pendant/board_talk.hpp"
#include "shared/units.hpp"

namespace lamplock::pendant {

/// What a machine can do, of its settings.
struct JogLimits {
  int axes = 3;
  PerAxis<double> rate_mm_min{}, acceleration_mm_s2{};
};
JogLimits jog_limits(const settings::Values& values);

/// -1, 0 or 1 by axis.
using Direction = PerAxis<int>;

/// How much has happened, for reports.
struct JogCounts {
  std::uint32_t lines = 0, cancels = 0, refused = 0;
};

class JogStream {
 public:
  /// `talk` must outlive it; whoever polls the talk passes answers to take().
  JogStream(BoardTalk& talk, const JogLimits& limits) : talk_(talk), limits_(limits) {}

  /// Moves on in this direction until then; to be said again to go on. Another direction than the
  /// present one: stops first.
  void run(const Direction& direction, double feed_mm_min, Time until);
  /// So many steps along an axis; those for which there is no time within 250 ms are left out.
  /// How many are on their way: 0 while it stops.
  int step(int axis, double step_mm, int count, double feed_mm_min);
  /// One jog to somewhere, "G90X0Y0"; false while something else moves.
  bool go(const std::string& words, double feed_mm_min);
  /// All of it ends now. May be called at any time, as often as one likes.
  void stop();
  /// The board was reset: it stops by itself.
  void forget();

  void take(const Answered& answer);
  void poll();

  /// Something may move because of us.
  bool moves() const { return moves_; }
  bool stopping() const { return stopping_; }
  /// At a speed, not by steps.
  bool runs() const { return wanted_.has_value(); }
  const JogCounts& counts() const { return counts_; }
  const JogLimits& limits() const { return limits_; }

 private:
  struct Run {
    Direction direction{};
    double speed_mm_s = 0;
    Time until{};
  };
  using Way = PerAxis<double>;

  double highest_feed(const Direction& direction, double feed_mm_min) const;
  void feed();
  bool too_far_ahead() const;
  void send(const Way& way, double feed_mm_min, Time duration);
  void send_cancel();
  void keep_stopping();
  void look_whether_it_stands();

  BoardTalk& talk_;
  JogLimits limits_;
  std::optional<Run> wanted_;
  Direction under_way_{};            ///< that the increments sent last have
  Way rest_{};                       ///< of the way, less than can be written
  Way sent_mm_{};                    ///< since the machine stood last
  std::vector<double> stood_at_mm_;  ///< as reported then, machine or work
  std::deque<Way> unanswered_;       ///< ways of the increments
  Time busy_until_{};                ///< the machine has been given time for what was sent
  Time cancelled_at_{};
  std::size_t reports_then_ = 0;  ///< when the last line, answer or cancel went or came
  bool moves_ = false, stopping_ = false, cancel_again_ = false;
  bool goes_ = false;  ///< to a place: for how long nobody knows
  JogCounts counts_;
};

}  // namespace lamplock::pendant
