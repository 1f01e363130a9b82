#include "host/model/spline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lamplock::model {
namespace {

using geometry::Point;

// Outside this range a double has too few digits for the curve.
constexpr double min_range = 1e-12, max_range = 1e12;
constexpr double max_weight_ratio = 1e9;
// Knots closer than this part of the range differ by rounding.
constexpr double same_knot = 1e-12;

/// A point times its weight, and the weight.
struct Weighted {
  double x, y, z, w;
};

Weighted mix(const Weighted& a, const Weighted& b, double t) {
  const double r = 1 - t;
  return {r * a.x + t * b.x, r * a.y + t * b.y, r * a.z + t * b.z, r * a.w + t * b.w};
}

Weighted weighted_pole(const Spline& spline, std::size_t i) {
  const double w = spline.weights.empty() ? 1 : spline.weights[i];
  const Point& p = spline.poles[i];
  return {p.x * w, p.y * w, p.z * w, w};
}

/// The index of the non-empty knot span of t: knots[result] <= t < knots[result + 1].
std::size_t stretch_at(const Spline& spline, double t) {
  const std::vector<double>& knots = spline.knots;
  const auto degree = static_cast<std::ptrdiff_t>(spline.degree);
  const auto last = static_cast<std::ptrdiff_t>(spline.poles.size());
  auto k = std::upper_bound(knots.begin() + degree, knots.begin() + last, t) - knots.begin() - 1;
  while (k > degree && knots[static_cast<std::size_t>(k)] == knots[static_cast<std::size_t>(k) + 1])
    --k;
  return static_cast<std::size_t>(k);
}

std::string fault_of_weights(const Spline& spline) {
  if (spline.weights.empty()) return "";
  if (spline.weights.size() != spline.poles.size())
    return fmt::format("a spline has {} weights for {} poles", spline.weights.size(),
                       spline.poles.size());
  const auto [least, greatest] = std::minmax_element(spline.weights.begin(), spline.weights.end());
  if (!(*least > 0) || !(*greatest / *least <= max_weight_ratio))
    return fmt::format("a spline has weights from {} to {}", *least, *greatest);
  return "";
}

}  // namespace

std::string fault_of(Spline& spline) {
  if (spline.degree < 1 || spline.degree > max_degree)
    return fmt::format("a spline has degree {}, only 1 to {} are possible", spline.degree,
                       max_degree);
  const auto degree = static_cast<std::size_t>(spline.degree);
  std::vector<double>& knots = spline.knots;
  if (spline.poles.size() < degree + 1 || knots.size() != spline.poles.size() + degree + 1)
    return fmt::format("a spline of degree {} has {} knots for {} poles", degree, knots.size(),
                       spline.poles.size());
  const double range = knots[spline.poles.size()] - knots[degree];
  if (!(range >= min_range && range <= max_range))
    return fmt::format("the knots of a spline have the range {}", range);
  for (std::size_t i = 1; i < knots.size(); ++i) {
    if (knots[i] < knots[i - 1] - same_knot * range)
      return fmt::format("the knots of a spline fall from {} to {}", knots[i - 1], knots[i]);
    if (knots[i] - knots[i - 1] < same_knot * range) knots[i] = knots[i - 1];
  }
  return fault_of_weights(spline);
}

Motion spline_motion(const Spline& spline, double parameter) {
  const auto degree = static_cast<std::size_t>(spline.degree);
  const std::vector<double>& knots = spline.knots;
  const double t = std::clamp(parameter, knots[degree], knots[spline.poles.size()]);
  const std::size_t k = stretch_at(spline, t);
  std::array<Weighted, max_degree + 1> d{};
  for (std::size_t i = 0; i <= degree; ++i) d[i] = weighted_pole(spline, k - degree + i);
  for (std::size_t level = 1; level < degree; ++level) {
    for (std::size_t i = degree; i >= level; --i) {
      const double low = knots[k - degree + i], high = knots[k + 1 + i - level];
      d[i] = mix(d[i - 1], d[i], (t - low) / (high - low));
    }
  }
  // The last level is a straight line, which gives the derivative.
  const double width = knots[k + 1] - knots[k], rate = spline.degree / width;
  const Weighted a = d[degree - 1], b = d[degree];
  const Weighted p = mix(a, b, (t - knots[k]) / width);
  const Point at{p.x / p.w, p.y / p.w, p.z / p.w};
  const double grows = (b.w - a.w) * rate;
  return {at,
          {((b.x - a.x) * rate - grows * at.x) / p.w, ((b.y - a.y) * rate - grows * at.y) / p.w,
           ((b.z - a.z) * rate - grows * at.z) / p.w}};
}

std::vector<double> breaks_of(const Spline& spline) {
  const auto first = spline.knots.begin() + spline.degree;
  const auto last = spline.knots.begin() + static_cast<std::ptrdiff_t>(spline.poles.size()) + 1;
  std::vector<double> breaks(first, last);
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

Spline bezier(std::vector<Point> poles) {
  Spline spline;
  spline.degree = static_cast<int>(poles.size()) - 1;
  spline.knots.assign(poles.size(), 0);
  spline.knots.insert(spline.knots.end(), poles.size(), 1);
  spline.poles = std::move(poles);
  return spline;
}

}  // namespace lamplock::model
