#include "firmware/machine/runners/next_window.hpp"

namespace lamplock::machine {
namespace {

/// Between two flashes of a point the machine may swing away and back, which saves beats on the way
/// to the first flashes and from the last ones: this many of each. In between it is at rest.
constexpr std::uint32_t swings = 2;

/// Maximum beats of a move of a program: well below the capacity of the planners.
constexpr std::uint32_t max_beats_at_feed = 4096;

}  // namespace

void NextWindow::flash_fired(std::uint32_t point) {
  if (point != place_.point) return;
  // The next window must not count a flash that a brake has taken back.
  if (place_.committed == 0)
    forget();
  else
    --place_.committed;
}

void NextWindow::fill_request(const Departure& departure) {
  if (filled_) return;
  ready_ = find(departure);
  filled_ = true;
}

/// Fills the request; true if all its targets are known.
bool NextWindow::find(const Departure& departure) {
  request_.count = 0;
  gone_to_ = has_shot_ = false;
  bool room = true, other_beam = false;
  lamp::Beam last;
  for (std::uint32_t i = place_.point; room && i != queue_.end(); ++i) {
    other_beam = needs_another_beam(queue_.at(i), departure.from_rest, last);
    if (other_beam) break;
    room = add_target(i, queue_.left(i) - (i == place_.point ? place_.committed : 0), departure);
  }
  if (request_.count == 0) return false;
  const bool all_known = other_beam || queue_.end() == options_.points_total;
  const bool full = request_.count == window_points;
  request_.rest_at_end =
      !full || other_beam || place_after(0, request_.count).point == options_.points_total;
  const bool rows = rows_known();
  return all_known || (full && rows);
}

/// True if all points are known that a plan of the window may use.
bool NextWindow::rows_known() {
  const std::uint32_t after = request_.points[request_.count - 1] + 1;
  const std::uint32_t ahead = options_.points_total - after;
  const std::uint32_t wanted = ahead < run_horizon ? ahead : run_horizon;
  const std::uint32_t known = queue_.end() - after;
  request_.known_end = after + (known < wanted ? known : wanted);
  return known >= wanted || options_.mode != wire::JoinMode::free;
}

/// True if the machine must rest before this target so that its beam can be made ready. `last` is
/// the beam of the previous target with a shot.
bool NextWindow::needs_another_beam(const wire::Target& target, bool from_rest, lamp::Beam& last) {
  if (target.shots == 0 || options_.dry) return false;
  const lamp::Beam beam{target.channel, target.energy};
  // For the first shot from rest the beam is made ready; in motion it must be right already.
  if (has_shot_ ? beam_.needs_rest(last, beam)
                : !from_rest && request_.count != 0 && !beam_.is_ready_for(beam))
    return true;
  if (!has_shot_) first_beam_ = beam;
  has_shot_ = true;
  last = {beam.channel, beam.energy != 0 ? beam.energy : last.energy};
  return false;
}

/// False if the window is full.
bool NextWindow::add_target(std::uint32_t point, std::uint32_t flashes,
                            const Departure& departure) {
  const wire::Target& target = queue_.at(point);
  const bool first = request_.count == 0;
  if (target.dwell) {
    // A dwell begins where the previous move ends: at rest.
    if (!first) request_.rest[request_.count - 1] = true;
    gone_to_ = first && departure.off_target;
    return (!gone_to_ || add_way(point, true, 1)) && add_way(point, true, 0);
  }
  // Further flashes follow as soon as possible.
  const std::uint32_t least = min_beats(target, first && departure.off_target, departure.slower);
  const std::uint32_t fired = target.shots == 0 ? 0 : target.shots - flashes;
  bool room = true;
  for (std::uint32_t i = 0; room && i < flashes; ++i) {
    const bool there = fired + i != 0;
    const bool rest = fired + i >= swings && i + swings < flashes;
    room = add_way(point, rest || target.stop, there ? 1 : least);
  }
  return room;
}

/// The beats of a target are those of its move from the previous target, at full job speed; a
/// slower machine uses more. In a program they are the minimum, changed by its overrides, also when
/// the machine starts elsewhere. 0: as the target says.
std::uint32_t NextWindow::min_beats(const wire::Target& target, bool off_target,
                                    bool slower) const {
  if (!options_.of_program) return off_target ? 1 : slower ? target.beats : 0;
  const std::uint32_t percent = target.rapid ? options_.rapid_percent : options_.feed_percent;
  const std::uint32_t full = target.beats == 0 ? 1 : target.beats;
  const std::uint32_t beats = (full * 100 + percent - 1) / percent;
  const std::uint32_t least = beats < max_beats_at_feed ? beats : max_beats_at_feed;
  return target.beats == 0 && least == 1 && !off_target ? 0 : least;
}

/// False if the window was full.
bool NextWindow::add_way(std::uint32_t point, bool rest, std::uint32_t at_least) {
  if (request_.count == window_points) return false;
  request_.points[request_.count] = point;
  request_.rest[request_.count] = rest;
  request_.at_least[request_.count] = static_cast<std::uint16_t>(at_least);
  ++request_.count;
  return true;
}

Place NextWindow::place_after(std::uint32_t handed, std::uint32_t count) const {
  const std::uint32_t point = request_.points[count - 1];
  std::uint32_t committed = point == place_.point ? place_.committed : 0;
  for (std::uint32_t i = handed == 0 && gone_to_ ? 1 : handed; i < count; ++i)
    if (request_.points[i] == point) ++committed;
  return committed < queue_.left(point) ? Place{point, committed} : Place{point + 1, 0};
}

}  // namespace lamplock::machine
