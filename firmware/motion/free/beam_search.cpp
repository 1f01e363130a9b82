#include "firmware/motion/free/beam_search.hpp"

namespace lamplock::motion {
namespace {

/// From any start speed, 2 V/A beats more than at full speed are enough to brake and return; and
/// some more for short ways.
constexpr std::int32_t spare_beats = 64;
/// Label counts as much later: by an eighth of the beats so far.
constexpr std::int32_t late_share = 8;

bool covers(const Box& outer, const Box& inner, int axes) {
  for (int a = 0; a < axes; ++a)
    if (!outer[index(a)].contains(inner[index(a)])) return false;
  return true;
}

bool contains_rest(const Box& box, int axes) {
  for (int a = 0; a < axes; ++a)
    if (!box[index(a)].contains(0)) return false;
  return true;
}

std::int64_t width_qs(const Box& box) {
  std::int64_t sum = 0;
  for (const SpeedRange& side : box) sum += side.hi_qs - side.lo_qs;
  return sum;
}

}  // namespace

std::int32_t fewest_beats(const Window& window, const Leg& way, const Box& from, Box& to) {
  if (way.fixed_beats != 0)
    return step(window, way, from, way.fixed_beats, to) ? way.fixed_beats : 0;
  std::int64_t last = way.first_beats + spare_beats;
  for (int a = 0; a < window.axes(); ++a)
    last += 2 * (window.scale(a).limit_qs >> window.scale(a).bits);
  if (last > window.max_beats) last = window.max_beats;
  for (std::int32_t beats = way.first_beats; beats <= last; ++beats)
    if (can_join(window, way, from, way.allowed, beats) && step(window, way, from, beats, to))
      return beats;
  return 0;
}

void Beam::begin(const Window& window, const Effort& effort) {
  effort_ = effort;
  disappointed_ = 0;
  to_count_ = 1;
  to_[0] = Label{};
  to_[0].box = window.start;
  to_[0].next = fewest_beats(window, window.ways[0], window.start, to_[0].next_box);
}

bool Beam::extend(const Window& window, std::uint32_t i) {
  for (std::uint32_t l = 0; l < to_count_; ++l) from_[l] = to_[l];
  from_count_ = to_count_;
  to_count_ = 0;
  for (std::uint32_t p = 0; p < from_count_; ++p)
    if (from_[p].next != 0) extend_label(window, i, static_cast<std::uint8_t>(p));
  for (std::uint32_t l = 0; l < to_count_; ++l) traces_[i][l] = {to_[l].beats, to_[l].parent};
  if (to_count_ == 0) return false;
  if (disappoints()) disappointed_ |= std::uint64_t{1} << i;
  return true;
}

bool Beam::disappoints() const {
  std::int32_t least = to_[0].total;
  for (std::uint32_t l = 1; l < to_count_; ++l)
    if (to_[l].total < least) least = to_[l].total;
  return late_share * (least - from_[0].rank()) > least;
}

void Beam::extend_label(const Window& window, std::uint32_t i, std::uint8_t parent) {
  const Label& from = from_[parent];
  const Leg& way = window.ways[i];
  const Leg* next = i + 1 < window.count ? &window.ways[i + 1] : nullptr;
  const std::int32_t last = way.fixed_beats != 0 ? way.fixed_beats : way.last_beats;
  Label label;
  label.parent = parent;
  for (std::int32_t beats = from.next; beats == from.next || beats <= last;
       beats += 1 + beats / effort_.candidate_share) {
    if (beats > window.max_beats || too_late(from.total + beats, next)) return;
    if (beats == from.next) {
      label.box = from.next_box;
    } else if (!can_join(window, way, from.box, way.allowed, beats) ||
               !step(window, way, from.box, beats, label.box)) {
      continue;
    }
    label.total = from.total + beats;
    label.beats = static_cast<std::uint16_t>(beats);
    label.may_rest = contains_rest(label.box, window.axes());
    keep(window, label, next);
    // At the end only fewer beats count.
    if (next == nullptr) return;
  }
}

/// True if a label with this total, whatever its speeds, can neither replace nor outrank one of
/// those kept; then neither can one with more beats.
bool Beam::too_late(std::int32_t total, const Leg* next) const {
  if (to_count_ < effort_.labels) return false;
  bool rest_kept = effort_.labels == 1;
  for (std::uint32_t l = 0; l < to_count_; ++l) {
    if (total <= to_[l].total) return false;
    rest_kept = rest_kept || to_[l].may_rest;
  }
  if (!rest_kept) return false;
  const Label& worst = to_[place_to_lose()];
  return total + (next != nullptr ? next->first_beats : 0) > worst.rank();
}

bool Beam::dominated(const Window& window, const Label& label) const {
  for (std::uint32_t l = 0; l < to_count_; ++l)
    if (to_[l].total <= label.total && covers(to_[l].box, label.box, window.axes())) return true;
  return false;
}

void Beam::drop_dominated_by(const Window& window, const Label& label) {
  std::uint32_t kept = 0;
  for (std::uint32_t l = 0; l < to_count_; ++l) {
    if (label.total <= to_[l].total && covers(label.box, to_[l].box, window.axes())) continue;
    if (kept != l) to_[kept] = to_[l];
    ++kept;
  }
  to_count_ = kept;
}

void Beam::keep(const Window& window, Label& label, const Leg* next) {
  if (dominated(window, label)) return;
  label.next = next != nullptr ? fewest_beats(window, *next, label.box, label.next_box) : 0;
  if (next != nullptr && label.next == 0) return;
  drop_dominated_by(window, label);
  insert(label);
}

/// The worst label, except for the best of those that may rest.
std::uint32_t Beam::place_to_lose() const {
  const std::uint32_t last = to_count_ - 1;
  if (effort_.labels == 1 || !to_[last].may_rest) return last;
  for (std::uint32_t l = 0; l < last; ++l)
    if (to_[l].may_rest) return last;
  return last - 1;
}

void Beam::insert(const Label& label) {
  const auto better = [](const Label& a, const Label& b) {
    if (a.rank() != b.rank()) return a.rank() < b.rank();
    return width_qs(a.box) > width_qs(b.box);
  };
  if (to_count_ == effort_.labels) {
    const std::uint32_t out = place_to_lose();
    bool rest_kept = false;
    for (std::uint32_t l = 0; l < to_count_; ++l) rest_kept = rest_kept || to_[l].may_rest;
    const bool needed = effort_.labels != 1 && label.may_rest && !rest_kept;
    if (!needed && !better(label, to_[out])) return;
    for (std::uint32_t l = out; l + 1 < to_count_; ++l) to_[l] = to_[l + 1];
    --to_count_;
  }
  std::uint32_t place = to_count_;
  while (place > 0 && better(label, to_[place - 1])) --place;
  for (std::uint32_t l = to_count_; l > place; --l) to_[l] = to_[l - 1];
  to_[place] = label;
  ++to_count_;
}

void Beam::trace(const Window& window, std::array<std::int32_t, window_points>& beats) const {
  std::uint8_t label = 0;  // sorted: at the end the label with the fewest beats is first
  for (std::uint32_t i = window.count; i-- > 0;) {
    beats[i] = traces_[i][label].beats;
    label = traces_[i][label].parent;
  }
}

}  // namespace lamplock::motion
