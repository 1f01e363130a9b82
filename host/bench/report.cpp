#include "host/bench/report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace lamplock::bench {
namespace {

std::string path_text(const Figures& f) {
  return f.path ? fmt::format("{:.3f}", *f.path) : std::string("-");
}

/// The columns of one stream.
std::string columns(const Figures& f) {
  return fmt::format("{:>10.3f} {:>6} {:>7.4f} {:>8.4f} {:>+7.3f} {:>6.1f}", f.start_stop,
                     path_text(f), f.free, f.optimum, f.gap_percent(), f.saved_percent());
}

constexpr const char* column_heads = "start-stop   path    free  optimum   gap %  saved %";

std::string measured_table(const BenchReport& report) {
  std::string text = fmt::format(
      "Beats per point, {} measured start-stop times of one object of {} points\n"
      "  measured    lamp periods that passed, per point, on the machine of the source\n"
      "  ours        start-stop of this planner, the object's step lengths along one axis\n"
      "  on a walk   {} of the same step lengths in random directions in a plane, seed {}: each\n"
      "              axis has its own limits, so that start-stop is less than along one axis\n"
      "  optimum     exact: no plan needs fewer; gap: beats of free above the optimum\n"
      "  saved       time that free saves against start-stop on the same walk\n\n"
      "lamp  speed  accel                           | on a walk\n"
      "  Hz    m/s   m/s2  measured   ours   off %  | {}\n",
      report.measured.size(), glass_points, report.measured_points, report.seed, column_heads);
  for (const MeasuredFigures& m : report.measured)
    text += fmt::format("{:>4g} {:>6.2f} {:>6.1f} {:>9.3f} {:>6.3f} {:>+7.2f}  | {}\n",
                        m.row.lamp_hz, m.row.speed_m_s, m.row.accel_m_s2, measured_beats(m.row),
                        m.start_stop, m.off_percent(), columns(m.walk));
  return text;
}

std::string walk_table(const BenchReport& report) {
  std::string text = fmt::format(
      "Beats per point on walks of {} points in a plane, seed {}\n\n"
      "lamp  speed  accel\n"
      "  Hz    m/s   m/s2  {}  labels a point\n",
      report.walk_points, report.seed, column_heads);
  for (const WalkFigures& w : report.walks)
    text += fmt::format("{:>4g} {:>6.2f} {:>6.1f}  {} {:>15.1f}\n", w.machine.lamp_hz,
                        w.machine.speed_m_s, w.machine.accel_m_s2, columns(w.walk), w.walk.labels);
  return text;
}

std::string course_table(const BenchReport& report) {
  std::string text = fmt::format(
      "Beats per point on {} points 100-150 um apart, lamp {:g} Hz, {:g} m/s2, {:g} mm/s, seed "
      "{}:\n"
      "every figure is the mean of {} draws of these distances\n\n"
      "{:<47} {}\n",
      pulse_points, pulse_machine.lamp_hz, pulse_machine.accel_m_s2, pulse_machine.speed_m_s * 1e3,
      report.seed, pulse_draws, "course", column_heads);
  for (const CourseFigures& c : report.courses)
    text += fmt::format("{:<47} {}\n", c.name, columns(c.course));
  return text;
}

std::string jerk_rows(const BenchReport& report, JerkBeats JerkFigures::*beats) {
  std::string text =
      "lamp  speed  accel\n"
      "  Hz    m/s   m/s2";
  for (const double jerk : jerk_limits)
    text += jerk == 0 ? fmt::format("{:>9}", "none") : fmt::format("{:>9g}", jerk);
  text += "\n";
  for (const JerkFigures& row : report.jerks) {
    text += fmt::format("{:>4g} {:>6.2f} {:>6.1f}", row.machine.lamp_hz, row.machine.speed_m_s,
                        row.machine.accel_m_s2);
    for (const double b : row.*beats) text += fmt::format("{:>9.3f}", b);
    text += "\n";
  }
  return text;
}

std::string jerk_table(const BenchReport& report) {
  return fmt::format(
             "Beats per point by limit of jerk in m/s3, {} points, seed {}. Free, on a walk in a "
             "plane:\n\n",
             report.walk_points, report.seed) +
         jerk_rows(report, &JerkFigures::free) +
         fmt::format("\nPath mode, on a straight row of {} points 100 to 150 um apart:\n\n",
                     std::min(report.walk_points, pulse_points)) +
         jerk_rows(report, &JerkFigures::path);
}

std::string order_table(const BenchReport& report) {
  std::string text = fmt::format(
      "Beats per point of each order, free, on clouds of about {} points\n\n"
      "lamp  speed  accel\n"
      "  Hz    m/s   m/s2  {:<16} points",
      report.order_points, "cloud");
  for (const order::Ordering ordering : compared_orderings)
    text += fmt::format("{:>11}", order::ordering_names[static_cast<std::size_t>(ordering)]);
  text += "\n";
  for (const OrderFigures& row : report.orders) {
    text += fmt::format("{:>4g} {:>6.2f} {:>6.1f}  {:<16} {:>6}", row.machine.lamp_hz,
                        row.machine.speed_m_s, row.machine.accel_m_s2, row.cloud, row.points);
    for (const double beats : row.beats) text += fmt::format("{:>11.4f}", beats);
    text += "\n";
  }
  return text;
}

std::string angle_table(const BenchReport& report) {
  std::string text = fmt::format(
      "Sorting angle: time of the object of the source, beats per point of the cone order with\n"
      "K = tan(angle) on the example of about {} points, lamp {:g} Hz, {:g} m/s2, {:g} m/s\n\n"
      "angle  measured s  start-stop    free\n",
      report.order_points, angle_machine.lamp_hz, angle_machine.accel_m_s2,
      angle_machine.speed_m_s);
  for (const SortingAngle& row : report.angles)
    text += fmt::format("{:>5g} {:>11g} {:>11.4f} {:>7.4f}\n", row.angle_deg, row.measured_s,
                        row.start_stop, row.free);
  return text;
}

}  // namespace

std::string tables(const BenchReport& report) {
  std::string text;
  const auto add = [&text](bool wanted, auto table) {
    if (!wanted) return;
    if (!text.empty()) text += '\n';
    text += table();
  };
  add(!report.measured.empty(), [&] { return measured_table(report); });
  add(!report.walks.empty(), [&] { return walk_table(report); });
  add(!report.courses.empty(), [&] { return course_table(report); });
  add(!report.jerks.empty(), [&] { return jerk_table(report); });
  add(!report.orders.empty(), [&] { return order_table(report); });
  add(!report.angles.empty(), [&] { return angle_table(report); });
  add(!report.cuts.empty(), [&] { return cut_order_table(report.cuts, report.seed); });
  return text;
}

}  // namespace lamplock::bench
