#include "host/model/dashes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "host/model/arc_length.hpp"
#include "host/model/piece_part.hpp"

namespace lamplock::model {

double DashPattern::period() const { return std::accumulate(lengths.begin(), lengths.end(), 0.0); }

double dash_count(const DashPattern& pattern, double length) {
  const double per_period = static_cast<double>(pattern.lengths.size()) / 2;
  return (length / pattern.period() + 1) * per_period;
}

std::vector<Path> dashes(const Path& path, const DashPattern& pattern) {
  const double period = pattern.period();
  ArcLength along(path);
  std::vector<Path> drawn;
  // A dash that begins at the end, but for rounding, draws nothing.
  constexpr double rounding = 1e-9;
  const double shortest = rounding * along.total();
  const double into = pattern.offset - period * std::floor(pattern.offset / period);
  // By counted periods: sums of many small lengths would drift.
  for (double count = 0;; ++count) {
    double at = count * period - into;
    if (!(at < along.total())) return drawn;
    for (std::size_t i = 0; i + 1 < pattern.lengths.size(); i += 2) {
      const double from = std::max(at, 0.0);
      const double to = std::min(at + pattern.lengths[i], along.total());
      const bool is_dot = pattern.lengths[i] == 0 && pattern.draws_dots && at >= 0;
      if (to - from > shortest) {
        Path dash = part_of(path, along.place(from), along.place(to));
        if (!dash.pieces.empty()) drawn.push_back(std::move(dash));
      } else if (is_dot && at < along.total() - shortest) {
        const geometry::Point dot = along.at(at);
        drawn.push_back({{Line{dot, dot}}});
        drawn.back().layer = path.layer;
      }
      at += pattern.lengths[i] + pattern.lengths[i + 1];
    }
  }
}

}  // namespace lamplock::model
