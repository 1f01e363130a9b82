#include "host/report/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

namespace lamplock::report {
namespace {

using Formatter = std::string (*)(const Report&);
struct Line {
  const char* label;
  Formatter value;
  bool foreseen = true;  ///< also in an estimate
};

/// 1234567 -> "1 234 567".
std::string grouped(std::uint64_t number) {
  std::string digits = fmt::to_string(number);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, 1, ' ');
  return digits;
}

std::string grouped(const std::optional<std::uint64_t>& number) {
  return number ? grouped(*number) : "unknown";
}

std::string error_text(const std::optional<double>& steps) {
  return steps ? fmt::format("{:.2f} step", *steps) : "unknown";
}

std::string time_text(double seconds) {
  if (seconds < 60) return fmt::format("{:.2f} s", seconds);
  const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
  const std::uint64_t hours = whole / 3600, minutes = whole / 60 % 60;
  if (hours == 0) return fmt::format("{} min {:02} s", minutes, whole % 60);
  return fmt::format("{} h {:02} min {:02} s", hours, minutes, whole % 60);
}

std::string mode_of(const Report& r) { return r.mode; }

constexpr std::array result_lines{
    Line{"points", [](const Report& r) { return grouped(r.points); }},
    Line{"points fired", [](const Report& r) { return grouped(r.points_fired); }, false},
    Line{"shots", [](const Report& r) { return grouped(r.shots); }},
    Line{"beats", [](const Report& r) { return grouped(r.beats); }},
    Line{"beats per point",
         [](const Report& r) { return fmt::format("{:.3f}", r.beats_per_point); }},
    Line{"utilisation",
         [](const Report& r) { return fmt::format("{:.1f} %", 100 * r.utilisation); }},
    Line{"machine time", [](const Report& r) { return time_text(r.time_s); }},
    Line{"points per second",
         [](const Report& r) { return fmt::format("{:.1f}", r.points_per_s); }},
    Line{"largest error", [](const Report& r) { return error_text(r.largest_error_steps); }, false},
    Line{"  with lamp jitter",
         [](const Report& r) { return error_text(r.largest_jitter_error_steps); }, false},
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

std::vector<Row> result_rows(std::span<const std::reference_wrapper<const Report>> reports) {
  std::vector<Row> rows;
  for (const Line& line : result_lines) {
    Row row{line.label};
    for (const Report& report : reports) row.push_back(line.value(report));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

std::string summary(const Report& report) {
  const std::array reports{std::cref(report)};
  std::vector<Row> rows = result_rows(reports);
  rows.push_back({"beats before the first shot", grouped(report.beats_before)});
  for (const auto& [reason, beats] : report.beats_by_reason)
    if (beats > 0) rows.push_back({"beats: " + reason, grouped(beats)});
  if (report.checks.made + report.checks.not_made > 0) {
    rows.push_back({"photosensors: not made", grouped(report.checks.not_made)});
    rows.push_back({"photosensors: repeats", grouped(report.checks.repeats)});
  }
  rows.push_back({"link: frames resent", grouped(report.link.resent)});
  rows.push_back({"link: bad frames", grouped(report.link.bad)});
  rows.push_back({"link: reconnects", grouped(report.link.reconnects)});
  const std::string title = fmt::format("{}: {}, {} board, lamp {:g} Hz\n", report.input,
                                        report.mode, report.board, report.lamp_hz);
  return title + aligned(rows);
}

std::string estimate_summary(const Report& report) {
  std::vector<Row> rows;
  for (const Line& line : result_lines)
    if (line.foreseen) rows.push_back({line.label, line.value(report)});
  rows.push_back({"beats before the first shot", grouped(report.beats_before)});
  for (const auto& [reason, beats] : report.beats_by_reason)
    if (beats > 0) rows.push_back({"beats: " + reason, grouped(beats)});
  return fmt::format("{}: {}, lamp {:g} Hz\n", report.input, report.mode, report.lamp_hz) +
         aligned(rows);
}

std::string summary(const Report& first, const Report& second) {
  const std::array reports{std::cref(first), std::cref(second)};
  std::vector<Row> rows{{"", mode_of(first), mode_of(second)}};
  for (Row& row : result_rows(reports)) rows.push_back(std::move(row));
  const std::string ratio = first.beats > 0
                                ? fmt::format("{:.3f}", static_cast<double>(second.beats) /
                                                            static_cast<double>(first.beats))
                                : "unknown";
  rows.push_back({"beats, ratio", "", ratio});
  return aligned(rows);
}

}  // namespace lamplock::report
