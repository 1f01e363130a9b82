#include "host/serve/check_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/geometry/bounds.hpp"
#include "host/program/path_picture.hpp"
#include "host/program/process_values.hpp"
#include "host/program/program_run.hpp"
#include "host/run/read_job.hpp"
#include "host/run/sent_file.hpp"
#include "host/serve/material_choice.hpp"
#include "host/serve/or_null.hpp"

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

/// Dots of the picture of a job; more are not visible.
constexpr std::size_t max_dots = 4000;

Json program_json(const program_run::ProgramRun& run, const std::string& name) {
  Json problems = Json::array();
  for (const program_run::Problem& problem : run.problems)
    problems.push_back({{"line", problem.line},
                        {"column", problem.column},
                        {"text", problem.text},
                        {"remedy", problem.remedy}});
  const auto corner = [&](const PerAxis<double>& place) {
    return Json(std::vector<double>(place.begin(), place.begin() + run.axes));
  };
  return {{"kind", "program"},
          {"lines", run.lines},
          {"seconds", run.seconds()},
          {"cut_mm", run.feed_mm},
          {"rapid_mm", run.rapid_mm},
          {"problems", std::move(problems)},
          {"bounds", {corner(run.bounds.low), corner(run.bounds.high)}},
          {"rotary", run.rotary},
          {"picture", program_run::path_svg(run, name)}};
}

Json material_json(const program_run::ProcessValues& values) {
  return {{"title", values.title},
          {"feed", values.feed_mm_min},
          {"power", values.power_w},
          {"passes", values.passes},
          {"air", values.air},
          {"kerf", or_null(values.kerf_mm)},
          {"frequency", or_null(values.frequency_hz)},
          {"thickness", or_null(values.thickness_mm)}};
}

/// The points seen from above.
std::string points_svg(const geometry::PointCloud& points, const geometry::Bounds& bounds) {
  const geometry::Point size{bounds.high.x - bounds.low.x, bounds.high.y - bounds.low.y, 0};
  const double side = std::max({size.x, size.y, 1e-3}), margin = side / 20, dot = side / 300;
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.4f} {:.4f} {:.4f} {:.4f}\" "
      "fill=\"#1565c0\">\n",
      bounds.low.x - margin, -bounds.high.y - margin, size.x + 2 * margin, size.y + 2 * margin);
  const std::size_t step = points.size() / max_dots + 1;
  for (std::size_t i = 0; i < points.size(); i += step)
    text += fmt::format("<circle cx=\"{:.3f}\" cy=\"{:.3f}\" r=\"{:.4f}\"/>\n", points[i].x,
                        -points[i].y, dot);
  return text + "</svg>\n";
}

Json job_json(const run::PreparedJob& prepared) {
  Json result{{"kind", prepared.job.is_rows() ? "rows" : "points"},
              {prepared.job.is_rows() ? "lines" : "points", prepared.job.size()},
              {"dry", prepared.job.header.dry},
              {"problems", Json::array()}};
  if (prepared.points.empty()) return result;
  const geometry::Bounds bounds = geometry::bounds(prepared.points);
  result["bounds"] = {{bounds.low.x, bounds.low.y, bounds.low.z},
                      {bounds.high.x, bounds.high.y, bounds.high.z}};
  result["picture"] = points_svg(prepared.points, bounds);
  return result;
}

}  // namespace

run::CheckOptions check_options(const std::string& path, const run::MachineOptions& machine,
                                const run::ProcessChoice& material) {
  run::CheckOptions options;
  options.input = path;
  options.machine = machine;
  options.process = run::process_values(material);
  return options;
}

Json check_file(const std::string& path, const std::string& name,
                const run::MachineOptions& machine, const run::ProcessChoice& material) {
  if (run::kind_of_sent_file(path) == run::SentKind::job) {
    refuse_for_jobs(material);
    return job_json(run::read_prepared_job(path));
  }
  const run::CheckOptions options = check_options(path, machine, material);
  Json result = program_json(run::check_program(options), name);
  if (program_run::has_process_values(run::read_program_text(path)))
    result["material"] = options.process ? material_json(*options.process) : Json();
  return result;
}

}  // namespace lamplock::serve
