#include "host/thermal/beam_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamplock::thermal {
namespace {

double length_of(const BeamMove& move) { return std::hypot(move.x1 - move.x0, move.y1 - move.y0); }

double junction_speed(const BeamMove& a, const BeamMove& b, double accel, double deviation) {
  const double la = length_of(a), lb = length_of(b);
  if (la <= 0 || lb <= 0) return 0;
  // Cosine of the angle between the way back and the way on: -1 straight on, 1 back.
  const double cosine =
      -((a.x1 - a.x0) * (b.x1 - b.x0) + (a.y1 - a.y0) * (b.y1 - b.y0)) / (la * lb);
  constexpr double straight = -0.9999985;  // 0.1 degrees
  if (cosine <= straight) return std::numeric_limits<double>::infinity();
  const double s = std::sqrt(std::max(0.0, (1 - cosine) / 2));
  if (s >= 1) return std::numeric_limits<double>::infinity();
  return std::sqrt(accel * deviation * s / (1 - s));
}

/// Speeds at the begin of each move and after the last one.
std::vector<double> corner_speeds(const std::vector<BeamMove>& moves, double accel,
                                  double deviation) {
  std::vector<double> speeds(moves.size() + 1, 0);
  for (std::size_t i = 1; i < moves.size(); ++i)
    speeds[i] = std::min({moves[i - 1].speed_mm_s, moves[i].speed_mm_s,
                          junction_speed(moves[i - 1], moves[i], accel, deviation)});
  for (std::size_t i = moves.size(); i-- > 0;)
    speeds[i] = std::min(
        speeds[i], std::sqrt(speeds[i + 1] * speeds[i + 1] + 2 * accel * length_of(moves[i])));
  for (std::size_t i = 0; i < moves.size(); ++i)
    speeds[i + 1] =
        std::min(speeds[i + 1], std::sqrt(speeds[i] * speeds[i] + 2 * accel * length_of(moves[i])));
  return speeds;
}

/// Accelerate, constant speed, brake: those parts that are not empty.
void add_trapezoid(std::vector<MotionPiece>& pieces, const BeamMove& move, std::size_t index,
                   double from, double to, double accel) {
  const double length = length_of(move);
  const double top =
      std::min(move.speed_mm_s, std::sqrt((2 * accel * length + from * from + to * to) / 2));
  const double up = (top * top - from * from) / (2 * accel);
  const double down = (top * top - to * to) / (2 * accel);
  double at = 0;
  const auto add = [&](double way, double v0, double v1) {
    constexpr double negligible_mm = 1e-9;
    if (way <= negligible_mm) return;
    const auto x = [&](double s) { return move.x0 + (move.x1 - move.x0) * s / length; };
    const auto y = [&](double s) { return move.y0 + (move.y1 - move.y0) * s / length; };
    pieces.push_back({index, x(at), y(at), x(at + way), y(at + way), 2 * way / (v0 + v1), v0, v1});
    at += way;
  };
  add(std::max(0.0, up), from, top);
  add(std::max(0.0, length - up - down), top, top);
  add(std::max(0.0, down), top, to);
}

}  // namespace

double MotionPiece::way_at(double part) const {
  const double sum = begin_mm_s + end_mm_s;
  if (sum <= 0) return part;
  return part * (2 * begin_mm_s + (end_mm_s - begin_mm_s) * part) / sum;
}

std::vector<MotionPiece> beam_motion(const std::vector<BeamMove>& moves, double accel_mm_s2,
                                     double deviation_mm) {
  const std::vector<double> speeds = corner_speeds(moves, accel_mm_s2, deviation_mm);
  std::vector<MotionPiece> pieces;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const BeamMove& move = moves[i];
    if (move.rest_s > 0)
      pieces.push_back({i, move.x1, move.y1, move.x1, move.y1, move.rest_s, 0, 0});
    else if (length_of(move) > 0)
      add_trapezoid(pieces, move, i, speeds[i], speeds[i + 1], accel_mm_s2);
  }
  return pieces;
}

}  // namespace lamplock::thermal
