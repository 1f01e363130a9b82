#include "firmware/motion/profile/reach.hpp"

namespace lamplock::motion {
namespace {

/// A speed and its distance in the time.
struct Start {
  std::int64_t v_q32;
  std::int64_t way_q32;
};

/// A way in one direction: displacement, time, limit, and values derived from them.
class Leg {
 public:
  /// `max_q32` = limit * beats >= |q|.
  Leg(std::int64_t q, std::int32_t beats, std::int64_t limit, std::int64_t max_q32)
      : q_(q),
        beats_(beats),
        limit_(limit),
        max_q32_(max_q32),
        square_(std::int64_t{beats * beats} << 32),
        numerator_(q - square_ / 2),
        slack_(numerator_ >= 0 ? 1 : beats),
        free_(suffices(max_q32 - square_)) {}

  std::int64_t way_q32(std::int64_t v) const {
    return times_short(v, static_cast<std::uint32_t>(beats_));
  }
  /// True only if a start speed with this distance in the time is too slow.
  bool too_slow(std::int64_t way) const { return free_ && !suffices(way); }
  void raise(Start& start) const;
  std::int64_t max_end_q32(const Start& start) const;

 private:
  /// The least start speed, ignoring the limit, is numerator / beats, truncated, plus one unit,
  /// which is inside in both directions. Comparing a speed with it needs no division.
  bool suffices(std::int64_t way) const { return way - slack_ >= numerator_; }

  std::int64_t q_;
  std::int32_t beats_;
  std::int64_t limit_;
  std::int64_t max_q32_;
  std::int64_t square_;  ///< beats^2
  std::int64_t numerator_;
  std::int64_t slack_;
  bool free_;  ///< the limit is not reached from the least start speed
};

/// Raises `start` to the least start speed from which the distance can be covered, if it is below:
/// accelerate all the way, at most to the limit.
void Leg::raise(Start& start) const {
  if (free_) {
    if (suffices(start.way_q32)) return;
    start.v_q32 = numerator_ / beats_ + 1;
  } else {
    const std::int64_t least = limit_ - sqrt_down_q32(2 * (max_q32_ - q_));
    if (start.v_q32 >= least) return;
    start.v_q32 = least;
  }
  start.way_q32 = way_q32(start.v_q32);
}

/// Largest end speed from a start speed: brake first, then accelerate; limited.
std::int64_t Leg::max_end_q32(const Start& start) const {
  const std::int64_t v = start.v_q32, t_q32 = std::int64_t{beats_} << 32;
  const std::int64_t u = sqrt_down_q32(2 * square_ + 4 * (q_ - start.way_q32)) - t_q32;
  const std::int64_t dip = v - (t_q32 - u + 1) / 2;
  std::int64_t end = v + u;
  if (dip < -limit_)
    end = sqrt_down_q32(2 * (q_ + max_q32_) - mul_q32(v + limit_, v + limit_) - 1) - limit_;
  return end < limit_ ? end : limit_;
}

}  // namespace

bool reach(const SpeedInterval& from, std::int64_t q, std::int32_t t, std::int64_t limit,
           SpeedInterval& to) {
  const std::int64_t most = times_short(limit, static_cast<std::uint32_t>(t));
  if (abs64(q) > most) return false;
  const Leg forth(q, t, limit, most);
  const std::int64_t fastest = forth.way_q32(from.hi_q32);
  if (forth.too_slow(fastest)) return false;
  const Leg back(-q, t, limit, most);  // mirrored
  const std::int64_t slowest = forth.way_q32(from.lo_q32);
  if (back.too_slow(-slowest)) return false;
  Start lo{from.lo_q32, slowest}, hi{-from.hi_q32, -fastest};
  forth.raise(lo);
  back.raise(hi);
  if (lo.v_q32 > -hi.v_q32) return false;
  // Both bounds fall with the start speed, hence the crossed arguments.
  to.hi_q32 = forth.max_end_q32(lo);
  to.lo_q32 = -back.max_end_q32(hi);
  return to.lo_q32 <= to.hi_q32;
}

}  // namespace lamplock::motion
