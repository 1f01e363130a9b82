#include "host/serve/run_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "host/duration_text.hpp"
#include "host/run/run_program.hpp"
#include "host/run/send_job.hpp"
#include "host/svg.hpp"
#include "shared/units.hpp"
#include "shared/work_space.hpp"

namespace lamplock::serve {
namespace {

constexpr const char* style =
    "body{font:16px/1.5 system-ui,sans-serif;margin:1rem auto;max-width:60rem;padding:0 1rem;"
    "color-scheme:light dark}"
    "th{text-align:left;font-weight:normal;padding-right:2rem;opacity:.75}"
    "svg{width:100%;max-height:80vh;border:1px solid #8888}"
    "path{fill:none;stroke-width:1.5px;vector-effect:non-scaling-stroke}"
    ".done{stroke:#2e7d32}.cut{stroke:#1976d2}.rapid{stroke:#8888;stroke-dasharray:4 3}";

std::string seconds_of(std::chrono::microseconds time) {
  return duration_text(std::chrono::duration<double>(time).count());
}

/// `rotary`: that of A is in degrees, the others are mm.
std::string place_text(const std::vector<double>& place, bool rotary) {
  std::string text;
  for (std::size_t a = 0; a < std::min(place.size(), axis_letters.size()); ++a) {
    if (rotary && a == rotary_axis) text += " mm";
    text += fmt::format("{}{} {:.3f}", a == 0 ? "" : ", ", axis_letters[a], place[a]);
  }
  return text + (rotary && place.size() > rotary_axis ? " degrees" : " mm");
}

std::string row(const std::string& name, const std::string& value) {
  return fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n", name, svg::escaped(value));
}

/// The pieces of one class as one element.
std::string pieces(const char* name, const std::string& places) {
  return places.empty() ? "" : fmt::format("<path class=\"{}\" d=\"{}\"/>\n", name, places);
}

/// Pieces up to this share of the lines are done.
std::string picture(const std::vector<PathPlace>& path, double done) {
  geometry::PointCloud points;
  points.reserve(path.size());
  for (const PathPlace& each : path) points.push_back(each.place);
  const geometry::Bounds box = geometry::bounds(points);
  const double width = box.high.x - box.low.x, height = box.high.y - box.low.y;
  const double margin = std::max({width, height, 1.0}) / 20;
  std::string rapid, cut, done_pieces;
  for (std::size_t i = 1; i < path.size(); ++i) {
    std::string& target = path[i].is_rapid ? rapid : path[i].share <= done ? done_pieces : cut;
    target += fmt::format("M{:.3f} {:.3f}L{:.3f} {:.3f}", path[i - 1].place.x, -path[i - 1].place.y,
                          path[i].place.x, -path[i].place.y);
  }
  return fmt::format(
             "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"path from "
             "above\" viewBox=\"{:.3f} {:.3f} {:.3f} {:.3f}\">\n",
             box.low.x - margin, -box.high.y - margin, width + 2 * margin, height + 2 * margin) +
         pieces("rapid", rapid) + pieces("cut", cut) + pieces("done", done_pieces) + "</svg>\n";
}

/// Share of the lines of the file that is done; 0 if it is not known.
double done_share(const material::JobRecord& record, const RunReport& report) {
  if (record.result == "done") return 1;
  if (!report.has_share || record.total == 0) return 0;
  return static_cast<double>(record.done) / static_cast<double>(record.total);
}

}  // namespace

RunReport report_of(const run::ProgramOutcome& outcome) {
  RunReport report;
  report.facts.emplace_back("Time", seconds_of(outcome.result.elapsed));
  if (outcome.planned_s)
    report.facts.emplace_back("Planned time", duration_text(*outcome.planned_s));
  if (!outcome.result.status.position.empty())
    report.facts.emplace_back("Place at the end",
                              place_text(outcome.result.status.position, outcome.rotary));
  return report;
}

RunReport report_of(const run::SentJob& rows) {
  const link::JobResult& result = rows.outcome.result;
  RunReport report;
  report.facts.emplace_back("Time", seconds_of(result.elapsed));
  report.facts.emplace_back("Planned time", duration_text(rows.planned_s));
  report.facts.emplace_back("Starvations", fmt::format("{}", result.status.starvations));
  report.facts.emplace_back("Frames sent again", fmt::format("{}", result.resent));
  report.facts.emplace_back("Connections opened again", fmt::format("{}", result.reconnects));
  return report;
}

std::string run_page(const material::JobRecord& record, const RunReport& report,
                     const std::vector<PathPlace>& path) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n<table>\n",
      svg::escaped(record.file), style);
  html +=
      row("Result", record.message.empty() ? record.result : record.result + ": " + record.message);
  html += row("Lines done", fmt::format("{} of {}", record.done, record.total));
  html += row("Laser", record.is_dry ? "off (dry)" : "as programmed");
  html += row("Board", record.board);
  html += row("Begin", record.begin);
  html += row("End", record.end);
  for (const auto& [name, value] : report.facts) html += row(name, value);
  html += "</table>\n";
  if (path.size() > 1) {
    html += "<p>Path from above: green is done, blue is not";
    if (!report.has_share && record.result != "done") html += " known to be done";
    html += ", dashed is rapid or without power.</p>\n" + picture(path, done_share(record, report));
  }
  return html + "</body>\n</html>\n";
}

}  // namespace lamplock::serve
