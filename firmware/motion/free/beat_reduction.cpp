#include "firmware/motion/free/beat_reduction.hpp"

namespace lamplock::motion {
namespace {

/// Change of two neighbouring ways, in units of the size of a move.
struct Move {
  std::int32_t first, second;
};
constexpr Move pair_moves[] = {{1, -2}, {-2, 1}};

/// Boxes are rounded inwards: a speed on a bound needs a small tolerance to be found again
/// backwards. It is far below the room that the planning limits leave (limits.cpp).
Box widened(const Box& box, std::int32_t beats, int axes) {
  Box wide = box;
  for (int a = 0; a < axes; ++a) {
    wide[index(a)].lo_qs -= rounding_tolerance_qs + beats;
    wide[index(a)].hi_qs += rounding_tolerance_qs + beats;
  }
  return wide;
}

}  // namespace

bool Improver::make_forwards(const Window& window, const Beats& beats, std::uint32_t i) {
  const Box from = i == 0 ? window.start : widened(forwards_[i - 1], beats[i], window.axes());
  return step(window, window.ways[i], from, beats[i], forwards_[i]);
}

/// Box at the end of way i - 1, from the one at the end of way i.
bool Improver::make_backwards(const Window& window, const Beats& beats, std::uint32_t i) {
  const Box to = widened(backwards_[i], beats[i], window.axes());
  return step_back(window, i, to, beats[i], backwards_[i - 1]);
}

bool Improver::make_all_backwards(const Window& window, const Beats& beats) {
  backwards_[window.count - 1] = window.ways[window.count - 1].allowed;
  for (std::uint32_t i = window.count; --i > 0;)
    if (!make_backwards(window, beats, i)) return false;
  return true;
}

bool Improver::make_all(const Window& window, const Beats& beats) {
  for (std::uint32_t i = 0; i < window.count; ++i)
    if (!make_forwards(window, beats, i)) return false;
  return make_all_backwards(window, beats);
}

/// Ends a pass. Boxes that met only within rounding may fail when made again: then the moves of the
/// pass are undone, because the speeds are chosen from the boxes.
void Improver::end_pass(const Window& window, Beats& beats) {
  if (improved_ && !make_all_backwards(window, beats)) lost_ = true;
  if (lost_) {
    beats = kept_;
    make_all(window, beats);
  }
  kept_ = beats;
  improved_ = lost_ = false;
}

bool Improver::begin(const Window& window, const Effort& effort, Beats& beats) {
  pairs_ = effort.pairs;
  std::int32_t most = 0;
  for (std::uint32_t i = 0; i < window.count; ++i)
    if (beats[i] > most) most = beats[i];
  size_ = 1;
  while (size_ * 4 <= most) size_ *= 2;
  at_ = 0;
  improved_ = lost_ = false;
  kept_ = beats;
  return make_all(window, beats);
}

bool Improver::possible(const Window& window, const Beats& beats, std::uint32_t i,
                        std::uint32_t ways) const {
  const std::uint32_t end = i + ways - 1;
  for (std::uint32_t k = i; k <= end; ++k) {
    const Leg& way = window.ways[k];
    const Box& from = k == i ? before(window, i) : window.ways[k - 1].allowed;
    if (beats[k] < way.first_beats) return false;
    if (!can_join(window, way, from, k == end ? backwards_[k] : way.allowed, beats[k]))
      return false;
  }
  Box box, between;
  const Box* from = &before(window, i);
  if (ways == 2) {
    if (!step(window, window.ways[i], *from, beats[i], between)) return false;
    from = &between;
  }
  return step(window, window.ways[end], *from, beats[end], box) &&
         overlap(box, backwards_[end], window.axes());
}

bool Improver::try_move(const Window& window, Beats& beats, std::uint32_t i, std::int32_t first,
                        std::int32_t second) {
  const std::uint32_t ways = second == 0 ? 1 : 2;
  if (i + ways > window.count || window.ways[i].fixed_beats != 0) return false;
  if (ways == 2 && window.ways[i + 1].fixed_beats != 0) return false;
  beats[i] += first;
  if (ways == 2) beats[i + 1] += second;
  if (possible(window, beats, i, ways)) {
    if (ways == 2) make_backwards(window, beats, i + 1);
    return true;
  }
  beats[i] -= first;
  if (ways == 2) beats[i + 1] -= second;
  return false;
}

bool Improver::try_moves(const Window& window, Beats& beats, std::uint32_t i) {
  if (try_move(window, beats, i, -size_, 0)) return true;
  if (!pairs_) return false;
  for (const Move& move : pair_moves)
    if (try_move(window, beats, i, move.first * size_, move.second * size_)) return true;
  return false;
}

bool Improver::advance(const Window& window, Beats& beats) {
  if (size_ == 0) return false;
  // While the boxes are unchanged, ways without beats to save are skipped.
  if (!pairs_ && !improved_)
    while (at_ + 1 < window.count && beats[at_] - size_ < window.ways[at_].first_beats) ++at_;
  while (try_moves(window, beats, at_)) improved_ = true;
  if (improved_ && !make_forwards(window, beats, at_)) lost_ = true;
  if (++at_ < window.count) return true;
  at_ = 0;
  end_pass(window, beats);
  size_ = size_ * 2 / 3;
  return size_ != 0;
}

}  // namespace lamplock::motion
