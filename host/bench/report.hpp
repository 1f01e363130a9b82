// The tables of `lamplock bench` as text, and a chart.
//
// In:  figures. Out: aligned plain ASCII; an SVG picture. Who: `lamplock bench`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/bench/cut_orders.hpp"
#include "host/bench/figures.hpp"
#include "host/bench/orders.hpp"

namespace lamplock::bench {

/// A measured row with the result of this planner, and a walk with the same step lengths.
struct MeasuredFigures {
  StartStopTime row;
  double start_stop = 0;  ///< ours, one axis
  Figures walk;

  double off_percent() const { return 100 * (start_stop / measured_beats(row) - 1); }
  Machine machine() const { return {row.lamp_hz, row.accel_m_s2, row.speed_m_s}; }
};

/// A graded walk.
struct WalkFigures {
  Machine machine;
  Figures walk;
};

/// A course of the example of the thesis.
struct CourseFigures {
  const char* name;
  Figures course;
};

/// A walk and a row under limits of jerk.
struct JerkFigures {
  Machine machine;
  JerkBeats free{};  ///< the walk
  JerkBeats path{};  ///< the row
};

/// The requested parts; other parts are empty.
struct BenchReport {
  std::uint64_t seed = 0;
  int measured_points = 0;  ///< of the walk beside each measured row
  int walk_points = 0;
  std::vector<MeasuredFigures> measured;
  std::vector<WalkFigures> walks;
  std::vector<CourseFigures> courses;
  std::vector<JerkFigures> jerks;
  int order_points = 0;  ///< of each cloud, about
  std::vector<OrderFigures> orders;
  std::vector<SortingAngle> angles;
  std::vector<CutOrderFigures> cuts;
};

/// Tables with a few lines that explain each column.
std::string tables(const BenchReport& report);

/// Beats per point against a/f^2: measured, start-stop, free, optimum. Needs measured rows.
std::string chart_svg(const BenchReport& report);

}  // namespace lamplock::bench
