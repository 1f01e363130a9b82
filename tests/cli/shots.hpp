// Reads the positions in a shots.csv.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {

inline std::vector<geometry::Point> read_shots(const std::string& file) {
  std::vector<geometry::Point> shots;
  const auto rows = lines(read(file));
  for (std::size_t i = 1; i < rows.size(); ++i) {
    geometry::Point p;
    // index,channel,beat,time_us,x_mm,y_mm,z_mm
    if (std::sscanf(rows[i].c_str(), "%*d,%*d,%*d,%*f,%lf,%lf,%lf", &p.x, &p.y, &p.z) == 3)
      shots.push_back(p);
  }
  return shots;
}

}  // namespace lamplock::cli::test
