#include "firmware/machine/next_window.hpp"

namespace lamplock::machine {
namespace {

/// Between two flashes of a point the machine may swing there and back, which saves beats on the
/// way to the first ones and from the last ones: so many of each. In between it stands.
constexpr std::uint32_t swings = 2;

/// No way of a program is made to last longer: well below what the planners can do.
constexpr std::uint32_t most_beats_at_feed = 4096;

}  // namespace

void NextWindow::flash_fired(std::uint32_t point) {
  if (point != place_.point) return;
  // Of a flash that a brake has put back the next window must not hear again.
  if (place_.committed == 0)
    forget();
  else
    --place_.committed;
}

void NextWindow::look(const Departure& departure) {
  if (looked_) return;
  ready_ = find(departure);
  looked_ = true;
}

/// True if all of it is known.
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
  const bool full = request_.count == motion::window_points;
  request_.rest_at_end =
      !full || other_beam || place_after(0, request_.count).point == options_.points_total;
  const bool rows = rows_known();
  return all_known || (full && rows);
}

/// True if all points are known that a plan of the window may look at.
bool NextWindow::rows_known() {
  const std::uint32_t behind = request_.points[request_.count - 1] + 1;
  const std::uint32_t ahead = options_.points_total - behind;
  const std::uint32_t wanted = ahead < motion::run_horizon ? ahead : motion::run_horizon;
  const std::uint32_t known = queue_.end() - behind;
  request_.known_end = behind + (known < wanted ? known : wanted);
  return known >= wanted || options_.mode != motion::JoinMode::free;
}

/// True if the machine has to stand before this target, for its beam to be made ready. `last` is
/// the beam of the target before it with a shot.
bool NextWindow::needs_another_beam(const motion::Target& target, bool from_rest,
                                    lamp::Beam& last) {
  if (target.shots == 0 || options_.dry) return false;
  const lamp::Beam beam{target.channel, target.energy};
  // Of the first shot: from rest the beam is made ready for it, on the way it is as it is.
  if (has_shot_ ? beam_.needs_rest(last, beam)
                : !from_rest && request_.count != 0 && !beam_.stands_for(beam))
    return true;
  if (!has_shot_) first_beam_ = beam;
  has_shot_ = true;
  last = {beam.channel, beam.energy != 0 ? beam.energy : last.energy};
  return false;
}

/// False if the window is full.
bool NextWindow::add_target(std::uint32_t point, std::uint32_t flashes,
                            const Departure& departure) {
  const motion::Target& target = queue_.at(point);
  const bool first = request_.count == 0;
  if (target.dwell) {
    // It begins where the way before it ends: at rest.
    if (!first) request_.rest[request_.count - 1] = true;
    gone_to_ = first && departure.astray;
    return (!gone_to_ || add_way(point, true, 1)) && add_way(point, true, 0);
  }
  // Further flashes come as soon as they may.
  const std::uint32_t least = least_beats(target, first && departure.astray, departure.slower);
  const std::uint32_t fired = target.shots == 0 ? 0 : target.shots - flashes;
  bool room = true;
  for (std::uint32_t i = 0; room && i < flashes; ++i) {
    const bool there = fired + i != 0;
    const bool stand = fired + i >= swings && i + swings < flashes;
    room = add_way(point, stand || target.stop, there ? 1 : least);
  }
  return room;
}

/// The beats of a target are those of the way from the one before, at full job speed; a slower
/// machine uses more. Of a program they are the fewest, and follow its overrides: from elsewhere it
/// goes no faster either. 0: as the target says.
std::uint32_t NextWindow::least_beats(const motion::Target& target, bool gone_astray,
                                      bool slower) const {
  if (!options_.of_program) return gone_astray ? 1 : slower ? target.beats : 0;
  const std::uint32_t percent = target.rapid ? options_.rapid_percent : options_.feed_percent;
  const std::uint32_t full = target.beats == 0 ? 1 : target.beats;
  const std::uint32_t beats = (full * 100 + percent - 1) / percent;
  const std::uint32_t least = beats < most_beats_at_feed ? beats : most_beats_at_feed;
  return target.beats == 0 && least == 1 && !gone_astray ? 0 : least;
}

/// False if the window was full.
bool NextWindow::add_way(std::uint32_t point, bool rest, std::uint32_t at_least) {
  if (request_.count == motion::window_points) return false;
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
