#include "host/report/motion_series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/units.hpp"
#include "shared/beat.hpp"
#include "shared/units.hpp"

namespace lamplock::report {
namespace {

using settings::Id;
using sim::MotionPiece;
using sim::MotionTrace;
using sim::Picoseconds;

constexpr double mm_per_m = 1000;
/// Number of pieces of a parabola as long as the window.
constexpr double max_parts = 600;

/// Converts ticks and times to beats.
class Beats {
 public:
  Beats(const MotionTrace& trace, double beat_ticks)
      : beats_(trace.beats()),
        zero_(static_cast<double>(trace.zero().value_or(0))),
        beat_ticks_(beat_ticks) {}

  /// Beat of a tick; ticks before the first beat and after the last have the nominal length.
  double of_tick(std::uint64_t tick) const {
    const std::size_t i = before(tick);
    const double ahead = static_cast<double>(static_cast<std::int64_t>(tick - beats_[i].tick));
    const bool inside = i + 1 < beats_.size() && tick >= beats_[i].tick;
    const double ticks =
        inside ? static_cast<double>(beats_[i + 1].tick - beats_[i].tick) : beat_ticks_;
    return static_cast<double>(i) - zero_ + ahead / ticks;
  }
  double of_index(std::size_t i) const { return static_cast<double>(i) - zero_; }
  /// Mean length of a tick in the beat that the tick lies in, s.
  double tick_s(std::uint64_t tick) const { return tick_s_of(before(tick)); }
  double tick_s_of(std::size_t i) const {
    if (i + 1 >= beats_.size()) return tick_ns * 1e-9;
    return sim::seconds(beats_[i + 1].at - beats_[i].at) /
           static_cast<double>(beats_[i + 1].tick - beats_[i].tick);
  }

 private:
  std::size_t before(std::uint64_t tick) const {
    const auto after = std::upper_bound(
        beats_.begin(), beats_.end(), tick,
        [](std::uint64_t t, const sim::TracedBeat& beat) { return t < beat.tick; });
    return after == beats_.begin() ? 0 : static_cast<std::size_t>(after - beats_.begin()) - 1;
  }

  const std::vector<sim::TracedBeat>& beats_;
  double zero_;
  double beat_ticks_;
};

double steps_of(const Int128& position_q64) {
  return static_cast<double>(position_q64.hi()) +
         std::ldexp(static_cast<double>(position_q64.lo()), -64);
}

/// Writes the curves of one axis.
class AxisWriter {
 public:
  AxisWriter(const Beats& beats, const settings::Values& values, int axis, double part_beats)
      : beats_(beats), part_beats_(part_beats), axis_(index(axis)) {
    steps_per_mm_ = in_units(values, Id::steps_per_mm_x, axis);
    series_.number = axis;
    series_.name = std::string(1, axis_letters[axis_]);
    series_.max_speed_m_s = in_units(values, Id::max_rate_x, axis) / mm_min_per_m_s;
    series_.max_accel_m_s2 = in_units(values, Id::acceleration_x, axis) / mm_s2_per_m_s2;
  }

  void add(const MotionPiece& piece) {
    const stepper::AxisRun& run = piece.axis[axis_];
    const std::uint64_t end = piece.end_tick();
    const double from = beats_.of_tick(piece.first_tick), to = beats_.of_tick(end);
    // The rate that a tick adds is the speed in the middle of the tick.
    const double rate = std::ldexp(static_cast<double>(run.rate_q62), -62);
    const double accel = std::ldexp(static_cast<double>(run.accel_q62), -62);
    const double v0 = rate - accel / 2, v1 = v0 + accel * piece.ticks;
    const double first_s = beats_.tick_s(piece.first_tick), last_s = beats_.tick_s(end - 1);
    const double to_m = 1 / (steps_per_mm_ * mm_per_m);
    series_.speed_m_s.push_back({from, v0 * to_m / first_s});
    series_.speed_m_s.push_back({to, v1 * to_m / last_s});
    series_.accel_m_s2.push_back({from, accel * to_m / (first_s * first_s)});
    series_.accel_m_s2.push_back({to, accel * to_m / (last_s * last_s)});
    // The reported position of an axis is the middle of a step.
    const double start = steps_of(run.position_q64) - 0.5;
    const int parts = static_cast<int>(std::max(1.0, std::ceil((to - from) / part_beats_)));
    for (int i = 0; i <= parts; ++i) {
      const double part = static_cast<double>(i) / parts, n = part * piece.ticks;
      series_.position_mm.push_back(
          {from + part * (to - from), (start + (v0 + accel * n / 2) * n) / steps_per_mm_});
    }
  }
  AxisSeries take() { return std::move(series_); }

 private:
  const Beats& beats_;
  double part_beats_;
  std::size_t axis_;
  double steps_per_mm_;
  AxisSeries series_;
};

/// Position of a piece at a tick, mm.
PerAxis<double> position_at(const MotionPiece& piece, std::uint64_t tick,
                            const settings::Values& values) {
  PerAxis<double> position{};
  for (int a = 0; a < max_axes; ++a)
    position[index(a)] = (steps_of(piece.axis[index(a)].position_after(
                              static_cast<std::uint32_t>(tick - piece.first_tick))) -
                          0.5) /
                         in_units(values, Id::steps_per_mm_x, a);
  return position;
}

std::string name_of(wire::MachineState state) {
  switch (state) {
    case wire::MachineState::hold:
      return "hold";
    case wire::MachineState::door:
      return "door open";
    case wire::MachineState::alarm:
      return "alarm";
    case wire::MachineState::estop:
      return "e-stop";
    default:
      return "";
  }
}

/// At rest in the middle of a job.
bool waits(wire::MachineState state) {
  return state == wire::MachineState::hold || state == wire::MachineState::door;
}

void add_band(MotionSeries& series, const std::string& name, double from, double to) {
  if (name.empty()) return;
  if (!series.bands.empty() && series.bands.back().name == name && series.bands.back().to >= from)
    series.bands.back().to = to;
  else
    series.bands.push_back({from, to, name});
}

void add_beats(MotionSeries& series, const MotionTrace& trace, const Beats& beats) {
  std::vector<bool> flashed(trace.beats().size()), fired(trace.beats().size());
  for (const Picoseconds at : trace.flashes()) flashed[trace.nearest_beat(at)] = true;
  for (const Picoseconds at : trace.shots()) fired[trace.nearest_beat(at)] = true;
  const std::size_t last_flash = series.lamp ? trace.nearest_beat(trace.flashes().back()) : 0;
  for (std::size_t i = 0; i < trace.beats().size(); ++i) {
    const double beat = beats.of_index(i);
    if (beat < series.from || beat > series.to) continue;
    // The lattice is made ahead of time: these beats are after the end of the run.
    if (series.lamp && i > last_flash) break;
    series.beats.push_back({beat, flashed[i], fired[i], 1e6 * beats.tick_s_of(i)});
  }
}

/// Shots are drawn at the lattice tick of their beat.
void add_shots(MotionSeries& series, const MotionTrace& trace,
               const std::vector<MotionPiece>& pieces, const Beats& beats,
               const settings::Values& values) {
  std::size_t piece = 0;
  for (const Picoseconds at : trace.shots()) {
    const std::size_t beat = trace.nearest_beat(at);
    const double place = beats.of_index(beat);
    if (place < series.from || place > series.to) continue;
    const std::uint64_t tick = trace.beats()[beat].tick;
    while (piece < pieces.size() && pieces[piece].end_tick() < tick) ++piece;
    if (piece == pieces.size() || pieces[piece].first_tick > tick) continue;
    series.shots.push_back({place, position_at(pieces[piece], tick, values)});
  }
}

}  // namespace

double MotionSeries::tick_spread() const {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const BeatMark& beat : beats) {
    least = std::min(least, beat.tick_us);
    most = std::max(most, beat.tick_us);
  }
  return beats.empty() ? 0 : most / least - 1;
}

MotionSeries motion_series(const MotionTrace& trace, const settings::Values& values,
                           const sim::BeatWindow& window, Fit fit) {
  const double beat_ticks = lamplock::beat_ticks(values);
  const Beats beats(trace, beat_ticks);
  std::vector<MotionPiece> pieces;
  if (trace.zero()) {
    const auto from = static_cast<double>(window.from), to = static_cast<double>(window.to);
    for (const MotionPiece& piece : trace.pieces())
      if (beats.of_tick(piece.end_tick()) > from && beats.of_tick(piece.first_tick) < to)
        pieces.push_back(piece);
  }
  // A rest after the last motion is not drawn, unless the motion was to continue.
  const auto over = [](const MotionPiece& p) { return !p.moves() && !waits(p.state); };
  while (!pieces.empty() && over(pieces.back())) pieces.pop_back();
  MotionSeries series;
  series.from = static_cast<double>(window.from);
  series.to = static_cast<double>(window.to);
  if (fit == Fit::motion && pieces.empty()) {
    series.from = 0, series.to = 1;
  } else if (fit == Fit::motion) {
    series.from = std::max(series.from, std::floor(beats.of_tick(pieces.front().first_tick)));
    series.to = std::min(series.to, std::ceil(beats.of_tick(pieces.back().end_tick())));
  }
  series.beat_ms = beat_ticks * tick_ns * 1e-6;
  series.lamp = !trace.flashes().empty();
  if (trace.beats().empty()) return series;
  for (int axis = 0; axis < max_axes; ++axis) {
    const auto moves = [axis](const MotionPiece& piece) {
      const stepper::AxisRun& run = piece.axis[index(axis)];
      return run.rate_q62 != 0 || run.accel_q62 != 0;
    };
    if (std::none_of(pieces.begin(), pieces.end(), moves)) continue;
    AxisWriter writer(beats, values, axis, (series.to - series.from) / max_parts);
    for (const MotionPiece& piece : pieces) writer.add(piece);
    series.axes.push_back(writer.take());
  }
  for (const MotionPiece& piece : pieces)
    add_band(series, name_of(piece.state), beats.of_tick(piece.first_tick),
             beats.of_tick(piece.end_tick()));
  add_beats(series, trace, beats);
  add_shots(series, trace, pieces, beats, values);
  return series;
}

}  // namespace lamplock::report
