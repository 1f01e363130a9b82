// `lamplock bench`: gain of planning, compared with the source documents and the optimum.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/bench/command_bench.hpp"
#include "host/bench/report.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/console.hpp"
#include "host/cli/program.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/validators.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/version.hpp"

namespace lamplock::bench {
namespace {

using cli::Command;
using cli::Console;
using cli::Json;
using cli::number_from;
using cli::number_in;
using cli::one_of;
using cli::ProgressBar;

struct Options {
  std::vector<std::string> rows{};
  std::optional<int> points{};
  std::uint64_t seed = 1;
  std::string chart{};
  bool json = false;

  /// Tables of jerk limits and of orders are made only if named: few users need them.
  bool needs(const std::string& part) const {
    const bool asked_for =
        part == "jerk" || part == "orders" || part == "angles" || part == "cutting";
    return (rows.empty() && !asked_for) || std::find(rows.begin(), rows.end(), part) != rows.end();
  }
};

/// Number of all points to plan.
std::size_t work(const Options& options, const BenchReport& report) {
  std::size_t points = 0;
  const auto add = [&](const char* part, std::size_t rows, int each) {
    if (options.needs(part)) points += rows * static_cast<std::size_t>(each);
  };
  add("measured", glass_start_stop_times.size(), report.measured_points);
  add("walks", graded_walks.size(), report.walk_points);
  add("example", pulse_courses.size() * pulse_draws, pulse_points);
  add("jerk", jerk_machines.size() * jerk_limits.size(),
      report.walk_points + std::min(report.walk_points, pulse_points));
  constexpr std::size_t clouds = 6;
  add("orders", clouds * order_machines.size() * compared_orderings.size(), report.order_points);
  add("angles", measured_angles.size(), report.order_points);
  return points;
}

void measure_orders(const Options& options, BenchReport& report, const PointsPlanned& planned) {
  if (options.needs("orders")) {
    const std::vector<OrderCloud> clouds = order_clouds(report.order_points);
    for (const Machine& machine : order_machines)
      for (const OrderCloud& cloud : clouds)
        report.orders.push_back(order_figures(cloud, machine, planned));
  }
  if (options.needs("angles")) {
    const OrderCloud cloud = angle_cloud(report.order_points);
    for (const SortingAngle& row : measured_angles)
      report.angles.push_back(sorting_angle(row, cloud, planned));
  }
}

void measure_cuts(BenchReport& report) {
  ProgressBar progress("orders of cuts", cut_sheet_parts.size() * cut_searches.size());
  std::size_t done = 0;
  report.cuts = cut_order_figures(report.seed, [&] { progress.update(++done); });
}

BenchReport measure(const Options& options) {
  BenchReport report;
  report.seed = options.seed;
  report.measured_points = options.points.value_or(glass_points);
  report.walk_points = options.points.value_or(graded_points);
  report.order_points = options.points.value_or(glass_points);
  ProgressBar progress("points planned", work(options, report));
  std::size_t done = 0;
  const auto planned = [&](std::size_t points) { progress.update(done += points); };
  if (options.needs("measured")) {
    for (const StartStopTime& row : glass_start_stop_times) {
      MeasuredFigures figures{row, start_stop_on_one_axis(row), {}};
      figures.walk = walk_figures(figures.machine(), report.measured_points, options.seed, planned);
      report.measured.push_back(figures);
    }
  }
  if (options.needs("walks"))
    for (const Machine& machine : graded_walks)
      report.walks.push_back(
          {machine, walk_figures(machine, report.walk_points, options.seed, planned)});
  if (options.needs("example"))
    for (const PulseCourse& row : pulse_courses)
      report.courses.push_back({row.name, course_figures(row, pulse_draws, options.seed, planned)});
  if (options.needs("jerk"))
    for (const Machine& machine : jerk_machines)
      report.jerks.push_back(
          {machine,
           jerk_beats(machine, wire::JoinMode::free, report.walk_points, options.seed, planned),
           jerk_beats(machine, wire::JoinMode::path, report.walk_points, options.seed, planned)});
  measure_orders(options, report, planned);
  if (options.needs("cutting")) measure_cuts(report);
  return report;
}

void add_figures(Json& row, const Figures& f) {
  row["start_stop"] = f.start_stop;
  row["path"] = f.path ? Json(*f.path) : Json(nullptr);
  row["free"] = f.free;
  row["optimum"] = f.optimum;
  row["gap_percent"] = f.gap_percent();
  row["saved_percent"] = f.saved_percent();
  row["labels"] = f.labels;
}

Json machine_json(const Machine& machine) {
  return {{"lamp_hz", machine.lamp_hz},
          {"speed_m_s", machine.speed_m_s},
          {"accel_m_s2", machine.accel_m_s2}};
}

Json orders_json(const BenchReport& report) {
  Json rows = Json::array();
  for (const OrderFigures& o : report.orders) {
    Json row = machine_json(o.machine);
    row["cloud"] = o.cloud;
    row["points"] = o.points;
    for (std::size_t i = 0; i < o.beats.size(); ++i) {
      const auto ordering = static_cast<std::size_t>(compared_orderings[i]);
      row["beats"][std::string(order::ordering_names[ordering])] = o.beats[i];
    }
    rows.push_back(row);
  }
  return rows;
}

Json angles_json(const BenchReport& report) {
  Json rows = Json::array();
  for (const SortingAngle& row : report.angles)
    rows.push_back({{"angle_deg", row.angle_deg},
                    {"measured_s", row.measured_s},
                    {"start_stop", row.start_stop},
                    {"free", row.free}});
  return rows;
}

Json cuts_json(const BenchReport& report) {
  Json rows = Json::array();
  for (const CutOrderFigures& one : report.cuts) {
    Json row{{"contours", one.contours}};
    for (std::size_t i = 0; i < cut_searches.size(); ++i)
      row["searches"].push_back({{"name", cut_searches[i].name},
                                 {"rapid_mm", one.rapid_mm[i]},
                                 {"cpu_s", one.seconds[i]}});
    rows.push_back(row);
  }
  return rows;
}

Json document(const BenchReport& report) {
  Json json{{"version", lamplock::version()}, {"seed", report.seed}};
  if (!report.measured.empty()) {
    Json rows = Json::array();
    for (const MeasuredFigures& m : report.measured) {
      Json row = machine_json(m.machine());
      row["measured"] = measured_beats(m.row);
      row["start_stop_one_axis"] = m.start_stop;
      row["off_percent"] = m.off_percent();
      add_figures(row["walk"], m.walk);
      rows.push_back(row);
    }
    json["measured"] = {{"points", report.measured_points}, {"rows", rows}};
  }
  if (!report.walks.empty()) {
    Json rows = Json::array();
    for (const WalkFigures& w : report.walks) {
      Json row = machine_json(w.machine);
      add_figures(row, w.walk);
      rows.push_back(row);
    }
    json["walks"] = {{"points", report.walk_points}, {"rows", rows}};
  }
  if (!report.courses.empty()) {
    Json rows = Json::array();
    for (const CourseFigures& c : report.courses) {
      Json row{{"course", c.name}};
      add_figures(row, c.course);
      rows.push_back(row);
    }
    json["example"] = {{"points", pulse_points}, {"draws", pulse_draws}, {"rows", rows}};
  }
  if (!report.jerks.empty()) {
    Json rows = Json::array();
    for (const JerkFigures& j : report.jerks) {
      Json row = machine_json(j.machine);
      row["free"] = j.free;
      row["path"] = j.path;
      rows.push_back(row);
    }
    json["jerk"] = {{"points", report.walk_points}, {"limits_m_s3", jerk_limits}, {"rows", rows}};
  }
  if (!report.orders.empty()) json["orders"] = orders_json(report);
  if (!report.angles.empty()) json["angles"] = angles_json(report);
  if (!report.cuts.empty()) json["cutting"] = cuts_json(report);
  return json;
}

Exit run_bench(const Options& options) {
  Console console(options.json);
  if (!options.chart.empty()) {
    check_target(options.chart);
    if (lower_extension(options.chart) != ".svg")
      throw Error(Exit::bad_input, options.chart, "charts are written as SVG",
                  "give a name with the extension .svg");
    if (!options.needs("measured"))
      throw Error(Exit::bad_input, "--chart", "the chart shows the measured rows",
                  "add measured to --rows");
  }
  const BenchReport report = measure(options);
  console.text(tables(report));
  console.document(document(report));
  if (!options.chart.empty())
    write_whole(options.chart,
                [&](const std::filesystem::path& file) { write_file(file, chart_svg(report)); });
  return Exit::done;
}

}  // namespace

void add_bench(Command& program) {
  Command& app = cli::add_bench_command(program);
  app.footer(
      "Example:\n  lamplock bench --chart beats.svg\n"
      "  lamplock bench --rows walks --points 2000 --seed 7 --json\n"
      "  lamplock bench --rows example,jerk\n"
      "  lamplock bench --rows orders,angles\n"
      "  lamplock bench --rows cutting\n\n"
      "The planner of the firmware plans each stream of points like on the machine, without a\n"
      "simulation, and a search finds the fewest beats that any plan needs. Rows of the example\n"
      "are means over " +
      std::to_string(pulse_draws) + " draws of their random distances.");
  const auto options = std::make_shared<Options>();
  app.add_option(
         "--rows", &options->rows,
         "Tables to print: measured, walks, example, jerk, orders, angles, cutting; default: "
         "measured,walks,example")
      .check(one_of({"measured", "walks", "example", "jerk", "orders", "angles", "cutting"}))
      .comma_separated()
      .value_name("TABLE,...");
  app.add_option("--points", &options->points,
                 "Number of points of each walk; default: as many as the source has")
      .check(number_in({10, 10'000'000}))
      .value_name("N");
  app.add_option("--seed", &options->seed,
                 "Seed of the random points; the same seed gives the same points")
      .check(number_from(0, true))
      .show_default()
      .value_name("N");
  app.add_option("--chart", &options->chart, "Write a chart of beats per point against a/f^2 (SVG)")
      .value_name("FILE")
      .file(cli::FileUse::write);
  app.add_json(options->json, "Print the figures as JSON on stdout");
  app.action([options] { return run_bench(*options); });
}

}  // namespace lamplock::bench
