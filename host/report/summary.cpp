#include "host/report/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "host/duration_text.hpp"
#include "host/number_text.hpp"
#include "host/units.hpp"

namespace lamplock::report {
namespace {

using Formatter = std::string (*)(const Report&);
struct Line {
  const char* label;
  Formatter value;
  bool foreseen = true;  ///< also in an estimate
};

using lamplock::grouped;

std::string grouped(const std::optional<std::uint64_t>& number) {
  return number ? grouped(*number) : "unknown";
}

std::string error_text(const std::optional<double>& steps) {
  return steps ? fmt::format("{:.2f} step", *steps) : "unknown";
}

std::string mode_of(const Report& r) { return r.mode; }

/// The begin of a headline by the name of the end (host/run/job_outcome.cpp).
std::string end_text(const std::string& end) {
  constexpr std::array<std::pair<std::string_view, const char*>, 6> texts{
      {{"stopped", "Stopped"},
       {"failed", "Failed"},
       {"alarm", "Stopped by an alarm"},
       {"lost", "Connection lost"},
       {"restarted", "The machine restarted"},
       {"replaced", "Replaced by a job of another program"}}};
  for (const auto& [name, text] : texts)
    if (name == end) return text;
  return "Ended";
}

/// The points that may or may not have been fired, in parentheses; empty if there is none.
std::string doubt_text(const RunEnd& end) {
  const std::uint64_t first = end.first_unfired - end.pauses_before,
                      from = end.may_have_fired - end.pauses_before_end;
  if (from == first + 1) return fmt::format(" (point {} may have been fired)", first);
  if (from > first) return fmt::format(" (points {} to {} may have been fired)", first, from - 1);
  return "";
}

/// ", continued at point 333 of 871"; empty for a run from the first point on.
std::string part_text(const Report& report) {
  if (report.from == 0) return "";
  return fmt::format(", continued at point {} of {}", grouped(report.points_before),
                     grouped(report.points_before + report.points));
}

constexpr std::array result_lines{
    Line{"points", [](const Report& r) { return grouped(r.points); }},
    Line{"points fired", [](const Report& r) { return grouped(r.points_fired); }, false},
    Line{"shots", [](const Report& r) { return grouped(r.shots); }},
    Line{"beats", [](const Report& r) { return grouped(r.beats); }},
    Line{"beats per point",
         [](const Report& r) { return fmt::format("{:.3f}", r.beats_per_point); }},
    Line{"utilisation",
         [](const Report& r) { return fmt::format("{:.1f} %", 100 * r.utilisation); }},
    Line{"machine time", [](const Report& r) { return duration_text(r.time_s); }},
    Line{"points per second",
         [](const Report& r) { return fmt::format("{:.1f}", r.points_per_s); }},
    Line{"largest error", [](const Report& r) { return error_text(r.max_error_steps); }, false},
    Line{"  with lamp jitter", [](const Report& r) { return error_text(r.max_jitter_error_steps); },
         false},
    Line{"missed points", [](const Report& r) { return grouped(r.missed); }, false},
    Line{"doubled shots", [](const Report& r) { return grouped(r.doubled); }, false},
};

using Row = std::vector<std::string>;

/// Aligns columns: the first to the left, the others to the right.
std::string aligned(const std::vector<Row>& rows) {
  std::vector<std::size_t> widths;
  for (const Row& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const Row& row : rows) {
    std::string line = fmt::format("  {:<{}}", row[0], widths[0]);
    for (std::size_t i = 1; i < row.size(); ++i)
      line += fmt::format("   {:>{}}", row[i], widths[i]);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

/// One form for the whole row.
Row time_row(std::span<const std::reference_wrapper<const Report>> reports) {
  double longest = 0;
  for (const Report& report : reports) longest = std::max(longest, report.time_s);
  Row row{"machine time"};
  for (const Report& report : reports) row.push_back(duration_text(report.time_s, longest));
  return row;
}

std::vector<Row> result_rows(std::span<const std::reference_wrapper<const Report>> reports) {
  std::vector<Row> rows;
  for (const Line& line : result_lines) {
    if (std::string_view(line.label) == "machine time") {
      rows.push_back(time_row(reports));
      continue;
    }
    Row row{line.label};
    for (const Report& report : reports) row.push_back(line.value(report));
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string or_unknown(const std::string& text) { return text.empty() ? "unknown" : text; }

std::string size_text(const Report& r) {
  if (!r.size_mm) return "unknown";
  const auto& [x, y, z] = *r.size_mm;
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", x, y, z);
}

std::string spacing_text(const Report& r) {
  return r.making.spacing_mm ? fmt::format("{:.4g} mm", *r.making.spacing_mm) : "unknown";
}

std::string pauses_text(const Report& r) {
  if (r.pauses == 0) return "0";
  return fmt::format("{} of {} beats", grouped(r.pauses), grouped(r.pause_beats));
}

/// How the job was made and run.
constexpr std::array making_lines{
    Line{"end", [](const Report& r) { return or_unknown(r.end.name); }},
    Line{"from", [](const Report& r) { return fmt::to_string(r.from); }},
    Line{"dry run", [](const Report& r) { return std::string(r.dry ? "yes" : "no"); }},
    Line{"flashes per point", [](const Report& r) { return grouped(r.flashes_per_point); }},
    Line{"pauses", pauses_text},
    Line{"input", [](const Report& r) { return r.input; }},
    Line{"board", [](const Report& r) { return r.board; }},
    Line{"size", size_text},
    Line{"spacing", spacing_text},
    Line{"method", [](const Report& r) { return or_unknown(r.making.method); }},
    Line{"order", [](const Report& r) { return or_unknown(r.making.order); }},
    Line{"material", [](const Report& r) { return or_unknown(r.making.material); }},
};

std::string setting_text(const settings::Values& values, settings::Id id) {
  return fmt::format("{:.10g} {}", in_units(values, id), settings::row(id).unit);
}

/// What the two jobs do not have in common.
std::vector<Row> differing_rows(const Report& first, const Report& second) {
  std::vector<Row> rows;
  for (const Line& line : making_lines)
    if (Row row{line.label, line.value(first), line.value(second)}; row[1] != row[2])
      rows.push_back(std::move(row));
  for (const settings::Id id : differing_settings(first, second))
    rows.push_back({std::string(settings::row(id).name), setting_text(first.settings, id),
                    setting_text(second.settings, id)});
  return rows;
}

}  // namespace

std::vector<settings::Id> differing_settings(const Report& first, const Report& second) {
  std::vector<settings::Id> differing;
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const auto id = static_cast<settings::Id>(i);
    if (first.settings.milli(id) != second.settings.milli(id)) differing.push_back(id);
  }
  return differing;
}

std::string headline(const Report& report) {
  const RunEnd& end = report.end;
  const std::string dry = report.dry ? "Dry run: nothing was fired" : "";
  if (end.name.empty() || end.name == "done") return dry;
  std::string text =
      (dry.empty() ? "" : dry + ". ") + fmt::format("{} at {} of {}", end_text(end.name),
                                                    grouped(end.first_unfired - end.pauses_before),
                                                    grouped(report.points_before + report.points));
  if (!report.dry) text += doubt_text(end);
  return end.continue_with.empty() ? text : text + "; continue with: " + end.continue_with;
}

std::string summary(const Report& report) {
  const std::string head = headline(report);
  return (head.empty() ? "" : head + "\n") + table(report);
}

std::string table(const Report& report) {
  const std::array reports{std::cref(report)};
  std::vector<Row> rows = result_rows(reports);
  rows.push_back({report.dry ? "beats before the motion" : "beats before the first shot",
                  grouped(report.beats_before)});
  for (const auto& [reason, beats] : report.beats_by_reason)
    if (beats > 0) rows.push_back({"beats: " + reason, grouped(beats)});
  if (report.checks.made + report.checks.not_made > 0) {
    rows.push_back({"photosensors: not made", grouped(report.checks.not_made)});
    rows.push_back({"photosensors: repeats", grouped(report.checks.repeats)});
  }
  rows.push_back({"link: frames resent", grouped(report.link.resent)});
  rows.push_back({"link: bad frames", grouped(report.link.bad)});
  rows.push_back({"link: reconnects", grouped(report.link.reconnects)});
  const std::string title =
      fmt::format("{}: {}, {} board, lamp {:g} Hz{}\n", report.input, report.mode, report.board,
                  report.lamp_hz, part_text(report));
  return title + aligned(rows);
}

std::string estimate_summary(const Report& report) {
  std::vector<Row> rows;
  for (const Line& line : result_lines)
    if (line.foreseen) rows.push_back({line.label, line.value(report)});
  rows.push_back({"beats before the first shot", grouped(report.beats_before)});
  for (const auto& [reason, beats] : report.beats_by_reason)
    if (beats > 0) rows.push_back({"beats: " + reason, grouped(beats)});
  return fmt::format("{}: {}, lamp {:g} Hz{}\n", report.input, report.mode, report.lamp_hz,
                     part_text(report)) +
         aligned(rows);
}

std::string summary(const Report& first, const Report& second,
                    const std::array<std::string, 2>& headings) {
  const std::array reports{std::cref(first), std::cref(second)};
  std::vector<Row> rows;
  if (!headings[0].empty()) rows.push_back({"", headings[0], headings[1]});
  rows.push_back({"mode", mode_of(first), mode_of(second)});
  for (Row& row : result_rows(reports)) rows.push_back(std::move(row));
  const std::string ratio = first.beats > 0
                                ? fmt::format("{:.3f}", static_cast<double>(second.beats) /
                                                            static_cast<double>(first.beats))
                                : "unknown";
  rows.push_back({"beats, ratio", "", ratio});
  for (Row& row : differing_rows(first, second)) rows.push_back(std::move(row));
  return aligned(rows);
}

}  // namespace lamplock::report
