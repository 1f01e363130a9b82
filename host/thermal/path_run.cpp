#include "host/thermal/path_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace lamplock::thermal {
namespace {

/// Time steps of a piece: by the way of the beam and the time of heat in the beam's radius, at rest
/// enough for the steep rise at the begin, without light two.
std::size_t steps_of(const MotionPiece& piece, const BeamMove& move, const PathSetup& setup) {
  const double radius = setup.beam.radius_mm();
  constexpr double dark_steps = 2;
  if (move.power_w <= 0) return static_cast<std::size_t>(dark_steps);
  const double way = std::hypot(piece.x1 - piece.x0, piece.y1 - piece.y0);
  const double heat_s = radius * radius / setup.body.diffusivity_mm2_s();
  const double in_step = setup.meshing.radii_per_step;
  constexpr double slow = 4, min_rest_steps = 10;
  const double steps =
      way > 0 ? std::max(way / (radius * in_step), piece.seconds / (heat_s * in_step * slow))
              : std::max(min_rest_steps, piece.seconds / (heat_s * in_step));
  return static_cast<std::size_t>(std::max(1.0, std::ceil(steps)));
}

/// The body: the lit path with a margin that the heat does not cross.
MovingSetup moving_setup(const std::vector<BeamMove>& moves, const PathSetup& setup,
                         double seconds) {
  MovingSetup moving{setup.body, setup.surface, setup.beam, setup.meshing};
  moving.low_x = moving.low_y = 1e300;
  moving.high_x = moving.high_y = -1e300;
  const double radius = setup.beam.radius_mm();
  double way = 0, time = 0, rest_mm_s = 0;
  for (const BeamMove& move : moves) {
    if (move.power_w <= 0) continue;
    moving.low_x = std::min({moving.low_x, move.x0, move.x1});
    moving.high_x = std::max({moving.high_x, move.x0, move.x1});
    moving.low_y = std::min({moving.low_y, move.y0, move.y1});
    moving.high_y = std::max({moving.high_y, move.y0, move.y1});
    const double length = std::hypot(move.x1 - move.x0, move.y1 - move.y0);
    way += length;
    if (length > 0) time += length / move.speed_mm_s;
    // A rest counts as a beam that passes its radius in the time of the rest: this gives the depth
    // that heat reaches.
    if (move.rest_s > 0) rest_mm_s = std::max(rest_mm_s, radius / move.rest_s);
  }
  const double margin = std::max(10 * std::max(setup.beam.half_x_mm, setup.beam.half_y_mm),
                                 2.5 * std::sqrt(4 * setup.body.diffusivity_mm2_s() * seconds));
  moving.low_x -= margin;
  moving.low_y -= margin;
  moving.high_x += margin;
  moving.high_y += margin;
  moving.depth_mm = setup.thickness_mm.value_or(margin);
  moving.speed_mm_s = std::max(time > 0 ? way / time : 0, rest_mm_s);
  return moving;
}

double power_at(const BeamMove& move, double speed_mm_s) {
  if (!move.is_proportional || move.speed_mm_s <= 0) return move.power_w;
  return move.power_w * std::min(1.0, speed_mm_s / move.speed_mm_s);
}

}  // namespace

std::size_t path_steps(const std::vector<BeamMove>& moves, const PathSetup& setup) {
  std::size_t steps = 0;
  for (const MotionPiece& piece : beam_motion(moves, setup.accel_mm_s2, setup.deviation_mm))
    steps += steps_of(piece, moves[piece.move], setup);
  return steps;
}

PathResult run_path(const std::vector<BeamMove>& moves, const PathSetup& setup,
                    const EachStep& each_step) {
  const std::vector<MotionPiece> pieces = beam_motion(moves, setup.accel_mm_s2, setup.deviation_mm);
  PathResult result;
  double all_s = 0;
  for (const MotionPiece& piece : pieces) all_s += piece.seconds;
  const MovingSetup moving = moving_setup(moves, setup, all_s);
  result.depth_mm = moving.depth_mm;
  MovingField field(moving);
  double last_k = setup.surface.ambient_k;
  for (const MotionPiece& piece : pieces) {
    const BeamMove& move = moves[piece.move];
    const std::size_t steps = steps_of(piece, move, setup);
    const double step_s = piece.seconds / static_cast<double>(steps);
    for (std::size_t n = 0; n < steps; ++n) {
      const double from = piece.way_at(static_cast<double>(n) / static_cast<double>(steps));
      const double to = piece.way_at(static_cast<double>(n + 1) / static_cast<double>(steps));
      const double dx = piece.x1 - piece.x0, dy = piece.y1 - piece.y0;
      const BeamWay way{piece.x0 + from * dx, piece.y0 + from * dy, piece.x0 + to * dx,
                        piece.y0 + to * dy};
      const double speed = (to - from) * std::hypot(dx, dy) / step_s;
      const double power = move.power_w > 0 ? power_at(move, speed) : 0;
      field.advance(way, power, step_s);
      result.seconds += step_s;
      const double max_k = field.max_surface_k();
      result.samples.push_back({result.seconds, piece.move, way.x1, way.y1, speed, power, max_k,
                                (max_k - last_k) / step_s});
      last_k = max_k;
      if (each_step && !each_step(result.samples.back(), field)) return result;
    }
  }
  result.balance = field.solver().balance();
  return result;
}

std::vector<LineHeat> hottest_of_lines(const std::vector<BeamMove>& moves,
                                       const PathResult& result) {
  std::map<std::size_t, LineHeat> lines;
  for (const PathSample& sample : result.samples) {
    const BeamMove& move = moves[sample.move];
    if (move.power_w <= 0) continue;
    LineHeat& heat = lines[move.line];
    if (sample.max_k <= heat.hottest.max_k) continue;
    heat = {move.line, sample, move.power_w, move.speed_mm_s};
  }
  std::vector<LineHeat> out;
  out.reserve(lines.size());
  for (const auto& [line, heat] : lines) out.push_back(heat);
  return out;
}

double usual_temperature_k(const std::vector<BeamMove>& moves, const PathResult& result) {
  std::vector<std::pair<double, double>> times;  // of a temperature
  double all = 0, last_s = 0;
  for (const PathSample& sample : result.samples) {
    if (moves[sample.move].power_w > 0) {
      times.emplace_back(sample.max_k, sample.time_s - last_s);
      all += sample.time_s - last_s;
    }
    last_s = sample.time_s;
  }
  std::sort(times.begin(), times.end());
  double sum = 0;
  for (const auto& [temperature, seconds] : times)
    if ((sum += seconds) >= all / 2) return temperature;
  return 0;
}

std::vector<Overheated> overheated_lines(const std::vector<LineHeat>& lines, double limit_k,
                                         double ambient_k) {
  std::vector<Overheated> out;
  for (const LineHeat& heat : lines) {
    if (heat.hottest.max_k <= limit_k) continue;
    const double factor = (limit_k - ambient_k) / (heat.hottest.max_k - ambient_k);
    out.push_back({heat, factor, {}});
    // Where the beam brakes or turns its speed does not follow from the feed.
    constexpr double min_part_of_feed = 0.95;
    if (heat.speed_mm_s > 0 && heat.hottest.speed_mm_s >= min_part_of_feed * heat.speed_mm_s)
      out.back().feed_factor = 1 / (factor * factor);
  }
  return out;
}

std::vector<BeamMove> with_proposed_feed(std::vector<BeamMove> moves,
                                         const std::vector<Overheated>& lines) {
  std::map<std::size_t, double> factors;
  for (const Overheated& one : lines) factors[one.heat.line] = one.feed_factor.value_or(1);
  for (BeamMove& move : moves)
    if (const auto found = factors.find(move.line); found != factors.end())
      move.speed_mm_s *= found->second;
  return moves;
}

void keep_effective_feeds(std::vector<Overheated>& lines, const std::vector<LineHeat>& with_feeds,
                          double limit_k, double ambient_k) {
  constexpr double max_rise = 1.05;
  for (const LineHeat& after : with_feeds) {
    if (after.hottest.max_k - ambient_k <= max_rise * (limit_k - ambient_k)) continue;
    for (Overheated& one : lines)
      if (one.heat.line == after.line) one.feed_factor.reset();
  }
}

std::vector<BeamMove> with_proposed_power(std::vector<BeamMove> moves,
                                          const std::vector<Overheated>& lines) {
  std::map<std::size_t, double> factors;
  for (const Overheated& one : lines) factors[one.heat.line] = one.power_factor;
  for (BeamMove& move : moves)
    if (const auto found = factors.find(move.line); found != factors.end())
      move.power_w *= found->second;
  return moves;
}

}  // namespace lamplock::thermal
