#include "host/thermal/remap.hpp"

#include <algorithm>
#include <cmath>

namespace lamplock::thermal {
namespace {

/// A part of an old volume in a new one: value times width = a * value + b * slope.
struct Overlap {
  std::size_t from = 0, to = 0;
  double width = 0, moment = 0;  ///< moment: width times distance from the middle of the old one
};

std::vector<Overlap> overlaps(const Axis& from, const Axis& to) {
  std::vector<Overlap> parts;
  std::size_t i = 0, j = 0;
  double at = from.face(0);
  while (i < from.size() && j < to.size()) {
    const double end = std::min(from.face(i + 1), to.face(j + 1));
    if (end > at) {
      const double middle = (from.face(i) + from.face(i + 1)) / 2;
      parts.push_back({i, j, end - at, (end - at) * ((at + end) / 2 - middle)});
    }
    at = end;
    const bool ends_old = from.face(i + 1) <= end, ends_new = to.face(j + 1) <= end;
    if (ends_old) ++i;
    if (ends_new) ++j;
    if (!ends_old && !ends_new) break;
  }
  return parts;
}

/// Limited slope in volume i of a line of values at a stride.
double limited_slope(const double* values, std::size_t stride, const Axis& axis, std::size_t i) {
  if (i == 0 || i + 1 == axis.size()) return 0;
  const auto middle = [&](std::size_t n) { return (axis.face(n) + axis.face(n + 1)) / 2; };
  const double here = values[i * stride];
  const double left = here - values[(i - 1) * stride], right = values[(i + 1) * stride] - here;
  if (left * right <= 0) return 0;
  const double central = (left + right) / (middle(i + 1) - middle(i - 1));
  const double most = 2 * std::min(std::abs(left), std::abs(right)) / axis.width(i);
  return std::copysign(std::min(std::abs(central), most), central);
}

void remap_line(const double* from_values, std::size_t from_stride, const Axis& from,
                double* to_values, std::size_t to_stride, const Axis& to,
                const std::vector<Overlap>& parts) {
  std::size_t last = from.size();
  double slope = 0;
  for (const Overlap& part : parts) {
    if (part.from != last) slope = limited_slope(from_values, from_stride, from, part.from);
    last = part.from;
    to_values[part.to * to_stride] +=
        (from_values[part.from * from_stride] * part.width + slope * part.moment) /
        to.width(part.to);
  }
}

}  // namespace

std::vector<double> remapped(const std::vector<double>& values, const Grid& from, const Grid& to) {
  const std::size_t nx = from.x.size(), ny = from.y.size(), nz = from.z.size();
  const std::size_t mx = to.x.size(), my = to.y.size(), mz = to.z.size();
  const std::vector<Overlap> along_x = overlaps(from.x, to.x), along_y = overlaps(from.y, to.y),
                             along_z = overlaps(from.z, to.z);
  std::vector<double> first(mx * ny * nz), second(mx * my * nz), out(mx * my * mz);
  for (std::size_t row = 0; row < ny * nz; ++row)
    remap_line(&values[row * nx], 1, from.x, &first[row * mx], 1, to.x, along_x);
  for (std::size_t k = 0; k < nz; ++k)
    for (std::size_t i = 0; i < mx; ++i)
      remap_line(&first[k * ny * mx + i], mx, from.y, &second[k * my * mx + i], mx, to.y, along_y);
  for (std::size_t i = 0; i < mx * my; ++i)
    remap_line(&second[i], mx * my, from.z, &out[i], mx * my, to.z, along_z);
  return out;
}

}  // namespace lamplock::thermal
