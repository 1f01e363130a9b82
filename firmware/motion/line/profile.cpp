#include "firmware/motion/line/profile.hpp"

namespace lamplock::motion {
namespace {

/// Maximum length of a phase; longer ones are run in slices anyway.
constexpr std::uint32_t max_phase = std::uint32_t{1} << 29;
/// Minimum length of a phase: 2^-4 tick.
constexpr int no_phase_bits = 4;
/// Minimum length of a way: 2^-25; the steps of the finest axis may be twenty times shorter.
constexpr int no_length_bits = 25;
/// Part of a distance that is rounding: 2^-26.
constexpr int way_noise_bits = 26;
/// Part of a squared speed that is rounding: 2^-12, within the room of line/geometry.cpp.
constexpr int rounding_bits = 12;

UFloat square(UFloat v) { return v * v; }
/// Distance of a steady change of speed, in units of half a tick.
UFloat way_2(UFloat v0, UFloat v1, std::uint32_t ticks) { return (v0 + v1) * UFloat(ticks); }

/// Speeds and times, not yet in whole ticks.
struct Phases {
  UFloat v0, vc, v1;
  UFloat lead, cruise, tail;
  bool brakes = false;  ///< from a speed that is above the limit now
};

/// One change over the whole length: it brakes and is still too fast at the end, or just not, or
/// there is no room for more.
Phases change_all(const LineTask& task, UFloat v1) {
  Phases p;
  p.v0 = task.start;
  p.vc = p.v1 = v1;
  p.lead = times_power(task.length, 1) / (p.v0 + v1);
  p.brakes = true;
  return p;
}

/// Changes of speed below this part of it are insignificant: 2^-10.
constexpr int hardly_bits = 10;
/// Number of halvings of the interval for the middle speed.
constexpr int search_steps = 18;

/// Highest speed for which both pulses fit, at least the higher end.
UFloat max_middle(const LineTask& task, const LineRamps& ramps, UFloat end) {
  const UFloat length_2 = times_power(task.length, 1);
  const auto fits = [&](UFloat v) {
    return !(length_2 < ramps.way_2(task.start, v) + ramps.way_2(v, end));
  };
  UFloat low = most(task.start, end), high = task.speed;
  if (fits(high)) return high;
  for (int i = 0; i < search_steps; ++i) {
    const UFloat middle = middle_of(low, high);
    (fits(middle) ? low : high) = middle;
  }
  return low;
}

/// Speed at which a line of pulses takes `ticks`, by bisection.
UFloat pulse_speed_for_time(const LineTask& task, UFloat ticks) {
  const LineRamps ramps{task.accel, *task.rise};
  const UFloat length_2 = times_power(task.length, 1);
  const auto is_slow = [&](UFloat v) {
    // A slow run ends slowly: there may be no room to reach the permitted end speed.
    const UFloat end = least(task.end, v);
    const UFloat lead = ramps.ticks(task.start, v), tail = ramps.ticks(v, end);
    const UFloat ramps_2 = (task.start + v) * lead + (v + end) * tail;
    if (length_2 < ramps_2) return false;
    const UFloat cruise = times_power(difference(length_2, ramps_2), -1) / v;
    return ticks < lead + cruise + tail;
  };
  UFloat low, high = task.speed;
  for (int i = 0; i < search_steps; ++i) {
    const UFloat middle = middle_of(low, high);
    (is_slow(middle) ? low : high) = middle;
  }
  return high;
}

/// Speeds and times where jerk is limited: all phases are pulses.
Phases make_pulse_speeds(const LineTask& task) {
  const LineRamps ramps{task.accel, *task.rise};
  const UFloat length_2 = times_power(task.length, 1);
  const UFloat all_2 = length_2 + times_power(length_2, -rounding_bits);
  UFloat end = least(task.end, task.speed);
  if (end < task.start && all_2 < ramps.way_2(task.start, end))
    return change_all(task, ramps.lowest(task.start, task.length));
  Phases p;
  p.v0 = task.start;
  p.brakes = task.speed + task.accel < p.v0;
  if (p.brakes) {
    const UFloat down_2 = ramps.way_2(p.v0, task.speed) + ramps.way_2(task.speed, end);
    if (length_2 < down_2) return change_all(task, end);
    p.vc = task.speed;
  } else {
    p.v0 = least(p.v0, task.speed);
    if (p.v0 < end) end = least(end, ramps.highest(p.v0, task.length));
    p.vc = max_middle(task, ramps, end);
    // A tail left by rounding is not worth a pulse.
    const bool hardly = difference(p.vc, p.v0) < times_power(p.v0, -hardly_bits);
    if (hardly && !(p.v0 < end)) p.vc = p.v0;
  }
  p.v1 = end;
  p.lead = ramps.ticks(p.v0, p.vc);
  p.tail = ramps.ticks(p.vc, p.v1);
  const UFloat ramps_2 = (p.v0 + p.vc) * p.lead + (p.vc + p.v1) * p.tail;
  p.cruise = times_power(difference(length_2, ramps_2), -1) / p.vc;
  return p;
}

/// Speeds, and the times of lead and tail.
Phases make_speeds(const LineTask& task) {
  if (!task.rise->none()) return make_pulse_speeds(task);
  const UFloat change_2 = times_power(task.accel * task.length, 1);
  const UFloat v0_2 = square(task.start);
  UFloat end = least(task.end, task.speed);
  const UFloat too_fast_2 = difference(v0_2, square(end) + change_2);
  if (times_power(v0_2, -rounding_bits) < too_fast_2)
    return change_all(task, square_root(difference(v0_2, change_2)));
  const UFloat speed_2 = square(task.speed);
  Phases p;
  p.v0 = task.start;
  // A speed excess below one tick of acceleration is no braking.
  p.brakes = task.speed + task.accel < p.v0;
  if (!p.brakes) p.v0 = least(p.v0, task.speed);
  if (p.brakes) {
    const UFloat after_2 = difference(v0_2, change_2);
    if (!(after_2 < speed_2)) return change_all(task, square_root(after_2));
    p.vc = task.speed;
  } else {
    end = least(end, square_root(v0_2 + change_2));
    const UFloat peak = square_root(times_power(v0_2 + square(end) + change_2, -1));
    p.vc = most(most(p.v0, end), least(peak, task.speed));
  }
  p.v1 = end;
  p.lead = most(difference(p.vc, p.v0), difference(p.v0, p.vc)) / task.accel;
  p.tail = difference(p.vc, p.v1) / task.accel;
  const UFloat ramps_2 = (p.v0 + p.vc) * p.lead + (p.vc + p.v1) * p.tail;
  p.cruise = times_power(difference(times_power(task.length, 1), ramps_2), -1) / p.vc;
  return p;
}

std::uint32_t phase_ticks(UFloat time, bool needed) {
  if (!needed && time < UFloat(1u, -no_phase_bits)) return 0;
  const std::uint32_t ticks = whole_up(time, max_phase);
  return ticks == 0 ? 1 : ticks;
}

/// Rounds the phases up to whole ticks, at the planned speeds.
LineRun round_up(const LineTask& task, const Phases& p) {
  LineRun run;
  run.start = p.v0;
  run.cruise = p.vc;
  run.end = run.next = p.v1;
  // A change from or to rest needs a phase, however short.
  run.lead_ticks = phase_ticks(p.lead, is_zero(p.v0));
  run.tail_ticks = phase_ticks(p.tail, is_zero(p.v1) && !is_zero(p.vc));
  const UFloat ramps_2 = way_2(p.v0, p.vc, run.lead_ticks) + way_2(p.vc, p.v1, run.tail_ticks);
  const UFloat left_2 = difference(times_power(task.length, 1), ramps_2);
  // More than the remainder of rounding, which would disturb a short phase.
  if (times_power(times_power(task.length, 1), -way_noise_bits) < left_2 || run.ticks() == 0)
    run.cruise_ticks = phase_ticks(times_power(left_2, -1) / p.vc, true);
  return run;
}

/// Fits the end of the line to whole ticks: see the header.
void fit(const LineTask& task, bool brakes, LineRun& run) {
  const UFloat length_2 = times_power(task.length, 1);
  const UFloat ends_2 = (run.lead_ticks == 0 ? UFloat() : run.start * UFloat(run.lead_ticks)) +
                        run.end * UFloat(run.tail_ticks);
  const UFloat cruise =
      difference(length_2, ends_2) /
      UFloat(run.lead_ticks + 2 * std::uint64_t{run.cruise_ticks} + run.tail_ticks);
  const bool low =
      (run.lead_ticks != 0 && cruise < run.start) || (run.tail_ticks != 0 && cruise < run.end);
  if (!brakes && !low) {
    run.cruise = cruise;
    if (run.lead_ticks == 0) run.start = cruise;
    if (run.tail_ticks == 0) run.end = cruise;
    return;
  }
  const UFloat way = way_2(run.start, run.cruise, run.lead_ticks) +
                     times_power(run.cruise * UFloat(run.cruise_ticks), 1) +
                     way_2(run.cruise, run.end, run.tail_ticks);
  const UFloat factor = least(length_2 / way, UFloat(1u));
  run.start = run.start * factor;
  run.cruise = run.cruise * factor;
  run.end = run.end * factor;
}

/// Ticks in which a slice reaches its speed. A change that takes less than a tick needs one if it
/// matters: a very slow line would crawl at the speed of its start, or rest there for ever.
std::uint32_t lead_of_slice(const Phases& p, std::uint32_t ticks) {
  const std::uint32_t lead = whole_down(p.lead, ticks);
  const bool hardly = difference(p.vc, p.v0) < times_power(p.vc, -hardly_bits);
  return lead == 0 && !p.brakes && !hardly ? 1 : lead;
}

/// The first `ticks` of a run; phases end a part of a tick early.
LineRun cut(const LineTask& task, const Phases& p, std::uint32_t ticks) {
  LineRun run;
  run.start = p.v0;
  run.lead_ticks = lead_of_slice(p, ticks);
  const UFloat change = task.accel * UFloat(run.lead_ticks);
  run.cruise = p.brakes ? difference(p.v0, change) : least(p.v0 + change, p.vc);
  run.cruise_ticks = whole_down(p.cruise, ticks - run.lead_ticks);
  run.tail_ticks = ticks - run.lead_ticks - run.cruise_ticks;
  run.end = difference(run.cruise, task.accel * UFloat(run.tail_ticks));
  run.next = run.end;
  return run;
}

/// Minimum rest after a cut: rounded to a few ticks, a shorter one would have a very different
/// speed.
std::uint32_t min_rest(std::uint32_t slice) { return slice / 16; }

/// Ticks of the next slice of a run too long for one: the last two are equally long.
std::uint32_t part_of(std::uint32_t ticks, std::uint32_t slice) {
  return ticks > 2 * slice ? slice : ticks / 2;
}

/// The first part of a run of pulses: whole pulses, or parts of at least half a slice. They are
/// planned with ticks to spare, so that a part of one less does no harm.
LineRun cut_pulses(const LineTask& task, const Phases& p) {
  const std::uint32_t slice = task.slice_ticks;
  LineRun run;
  run.start = run.cruise = p.v0;
  const std::uint32_t lead = whole_down(p.lead, max_phase);
  if (lead > slice) {
    run.lead_ticks = part_of(lead, slice);
    const UFloat change =
        most(difference(p.vc, p.v0), difference(p.v0, p.vc)) / p.lead * UFloat(run.lead_ticks);
    run.cruise = p.vc < p.v0 ? difference(p.v0, change) : p.v0 + change;
  } else {
    run.lead_ticks = lead;
    run.cruise = p.vc;
    const std::uint32_t left = whole_down(p.cruise + p.tail, max_phase);
    const std::uint32_t most = left > min_rest(slice) ? left - min_rest(slice) : 0;
    run.cruise_ticks = whole_down(p.cruise, slice - lead < most ? slice - lead : most);
    if (lead == 0) run.start = run.cruise;
  }
  run.end = run.cruise;
  if (run.ticks() == 0) {
    run.tail_ticks = part_of(whole_down(p.tail, max_phase), slice);
    run.end = difference(p.vc, difference(p.vc, p.v1) / p.tail * UFloat(run.tail_ticks));
  }
  run.next = run.end;
  return run;
}

/// Brakes to rest inside the line; false if it is too long for that.
bool make_stop(const LineTask& task, LineRun& run) {
  const LineRamps ramps{task.accel, *task.rise};
  const std::uint32_t ticks = whole_up(ramps.ticks(task.start, UFloat()), max_phase);
  if (times_power(task.length, 1) < task.start * UFloat(ticks)) return false;
  run = {};
  run.start = task.start;
  if (ticks > task.slice_ticks) {
    run.lead_ticks = part_of(ticks, task.slice_ticks);
    run.cruise = difference(task.start, task.start / UFloat(ticks) * UFloat(run.lead_ticks));
    run.end = run.next = run.cruise;
  } else {
    run.lead_ticks = ticks;
  }
  return true;
}

/// A run for a line that is over already.
LineRun run_of_rest() {
  LineRun run;
  run.cruise_ticks = 1;
  run.whole = true;
  return run;
}

/// A run up to a speed, along, and down.
LineRun make_changing(const LineTask& task) {
  Phases p = make_speeds(task);
  LineRun run = round_up(task, p);
  const std::uint32_t slice = task.slice_ticks;
  if (task.rise->none()) {
    if (run.ticks() > slice) return cut(task, p, part_of(run.ticks(), slice));
  } else if (run.ticks() > slice) {
    // A pulse cannot be cut anywhere: extended a little, it includes the rest.
    if (run.lead_ticks <= slice && run.ticks() - run.lead_ticks <= min_rest(slice)) {
      p = change_all(task, p.v1);
      run = round_up(task, p);
    }
    if (run.ticks() > slice) return cut_pulses(task, p);
  }
  run.whole = true;
  fit(task, p.brakes, run);
  return run;
}

/// The fast case without a change: constant speed, if both ends have it within what takes less than
/// a phase. False if they do not.
bool make_steady(const LineTask& task, LineRun& run) {
  if (!task.rise->none()) return false;
  const UFloat v = task.speed, little = times_power(task.accel, -no_phase_bits);
  if (!(difference(v, task.start) < little) || !(difference(task.start, v) < little)) return false;
  if (!(difference(v, task.end) < little)) return false;
  if (is_zero(task.start) || is_zero(task.end) || task.length < v) return false;
  const std::uint32_t ticks = whole_up(task.length / v, max_phase);
  run.whole = ticks <= task.slice_ticks;
  run.cruise_ticks = run.whole ? ticks : part_of(ticks, task.slice_ticks);
  run.start = run.cruise = run.end = run.whole ? task.length / UFloat(ticks) : v;
  run.next = run.whole ? least(task.end, v) : v;
  return true;
}

}  // namespace

LineRun make_run(const LineTask& task) {
  LineRun run;
  if (!task.stop && make_steady(task, run)) return run;
  const bool too_short = task.length < UFloat::power(-no_length_bits);
  if (!task.stop && !too_short) return make_changing(task);
  if (task.stop && (is_zero(task.start) || make_stop(task, run))) return run;
  if (too_short && is_zero(task.start)) return run_of_rest();
  LineTask other = task;
  if (task.stop) {
    other.end = {};
    other.speed = task.start;
  }
  if (too_short) other.length = most(task.length, times_power(task.start, -no_phase_bits));
  return make_changing(other);
}

UFloat speed_for_time(const LineTask& task, UFloat ticks) {
  if (!task.rise->none()) return pulse_speed_for_time(task, ticks);
  // v^2 - (a T + v0 + v1) v + (a l + (v0^2 + v1^2)/2) = 0, the lower root.
  const UFloat half = times_power(task.accel * ticks + task.start + task.end, -1);
  const UFloat last =
      task.accel * task.length + times_power(square(task.start) + square(task.end), -1);
  if (square(half) < last) return task.speed;
  const UFloat root = square_root(difference(square(half), last));
  return least(task.speed, last / (half + root));
}

}  // namespace lamplock::motion
