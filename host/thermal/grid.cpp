#include "host/thermal/grid.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::thermal {
namespace {

/// Distances that grow from the focus outwards and end exactly at `length`.
std::vector<double> growing(double length, const Grading& grading) {
  std::vector<double> steps;
  double sum = 0, step = grading.fine;
  while (sum < length * (1 - 1e-9)) {
    step *= grading.growth;
    steps.push_back(step);
    sum += step;
  }
  for (double& one : steps) one *= length / sum;
  return steps;
}

}  // namespace

Axis::Axis(std::vector<double> nodes) : nodes_(std::move(nodes)) {
  faces_.reserve(nodes_.size() + 1);
  faces_.push_back(nodes_.front());
  for (std::size_t i = 1; i < nodes_.size(); ++i) faces_.push_back((nodes_[i - 1] + nodes_[i]) / 2);
  faces_.push_back(nodes_.back());
}

Axis Axis::single(double width_mm) {
  Axis axis;
  axis.nodes_ = {0};
  axis.faces_ = {-width_mm / 2, width_mm / 2};
  return axis;
}

std::size_t Axis::nearest(double place) const {
  const auto above = std::lower_bound(nodes_.begin(), nodes_.end(), place);
  if (above == nodes_.begin()) return 0;
  if (above == nodes_.end()) return nodes_.size() - 1;
  const auto i = static_cast<std::size_t>(above - nodes_.begin());
  return place - nodes_[i - 1] < nodes_[i] - place ? i - 1 : i;
}

std::vector<double> depth_nodes(double depth, std::size_t count, double growth) {
  std::vector<double> nodes{0};
  double step = 1;
  for (std::size_t i = 1; i < count; ++i, step *= growth) nodes.push_back(nodes.back() + step);
  const double scale = depth / nodes.back();
  for (double& node : nodes) node *= scale;
  nodes.back() = depth;
  return nodes;
}

std::vector<double> graded_nodes(double low, double high, double focus_low, double focus_high,
                                 const Grading& grading) {
  const double from = std::clamp(focus_low, low, high), to = std::clamp(focus_high, low, high);
  std::vector<double> nodes;
  const std::vector<double> below = growing(from - low, grading);
  double at = low;
  for (auto step = below.rbegin(); step != below.rend(); ++step) {
    nodes.push_back(at);
    at += *step;
  }
  const double count = std::max(1.0, std::ceil((to - from) / grading.fine - 1e-9));
  if (to > from)
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
      nodes.push_back(from + (to - from) * static_cast<double>(i) / count);
  nodes.push_back(to);
  at = to;
  for (const double step : growing(high - to, grading)) nodes.push_back(at += step);
  nodes.back() = high;
  return nodes;
}

}  // namespace lamplock::thermal
