#include "host/report/page.hpp"
#include "host/json_in_script.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/report/page_series.hpp"
#include "host/report/page_template.hpp"
#include "host/report/summary.hpp"

namespace lamplock::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t max_beats_shown = 254;
/// Places of the job with a time; between them the page interpolates.
constexpr std::size_t clock_places = 256;

/// The bounding box of all finite points.
struct CloudBox {
  std::array<double, 3> low{}, size{};
};

std::array<double, 3> coordinates(const geometry::Point& p) { return {p.x, p.y, p.z}; }

CloudBox box_round(const JobRun& run) {
  CloudBox box;
  bool first = true;
  std::array<double, 3> high{};
  for (const geometry::PointCloud* cloud : {&run.points_before, &run.points})
    for (const geometry::Point& point : *cloud) {
      if (!is_finite(point)) continue;
      const auto at = coordinates(point);
      for (std::size_t a = 0; a < 3; ++a) {
        box.low[a] = first ? at[a] : std::min(box.low[a], at[a]);
        high[a] = first ? at[a] : std::max(high[a], at[a]);
      }
      first = false;
    }
  for (std::size_t a = 0; a < 3; ++a) box.size[a] = high[a] - box.low[a];
  return box;
}

/// A coordinate as a fraction of the box.
std::uint16_t share(double value, double low, double size) {
  constexpr double whole = 65535;
  if (!(size > 0) || !std::isfinite(value)) return 32768;
  return static_cast<std::uint16_t>(
      std::lround(std::clamp((value - low) / size, 0.0, 1.0) * whole));
}

/// Beats from the point before; 0 for the first point.
std::uint8_t beats_to(const PointBeats& beats, std::size_t point) {
  if (!beats.known || point == 0) return 0;
  const std::uint32_t from = beats.beat[point - 1], to = beats.beat[point];
  return to <= from ? std::uint8_t{0}
                    : static_cast<std::uint8_t>(std::min(to - from, max_beats_shown));
}

/// What became of a point.
enum class Fate : std::uint8_t { fired, missed, not_reached, fired_before };

Fate fate_of(const JobRun& run, const PointBeats& beats, std::size_t point) {
  const bool is_after_end = point >= first_not_fired(run);
  if (!run.shots_known || !beats.known) return is_after_end ? Fate::not_reached : Fate::fired;
  const bool has_shots = run.shots_ordered.empty() || run.shots_ordered[point] != 0;
  const bool is_missed = beats.missed[point] != 0;
  if (is_after_end && (is_missed || !has_shots)) return Fate::not_reached;
  return is_missed ? Fate::missed : Fate::fired;
}

std::uint64_t count_not_reached(const JobRun& run, const PointBeats& beats) {
  std::uint64_t count = 0;
  for (std::size_t i = first_not_fired(run); i < run.points.size(); ++i)
    if (fate_of(run, beats, i) == Fate::not_reached) ++count;
  return count;
}

/// Every n-th point is shown, or one of the next n that was missed.
std::size_t stride_of(const JobRun& run) {
  const std::size_t all = run.points_before.size() + run.points.size();
  return std::max<std::size_t>(1, (all + max_points_shown - 1) / max_points_shown);
}

std::vector<std::uint32_t> shown_points(const JobRun& run, const PointBeats& beats) {
  const std::size_t count = run.points.size(), stride = stride_of(run);
  std::vector<std::uint32_t> shown;
  if (count == 0) return shown;
  shown.reserve(count / stride + 1);
  for (std::size_t i = 0; i < count; i += stride) {
    std::size_t chosen = i;
    const std::size_t end = std::min(i + stride, count);
    if (beats.known)
      while (chosen + 1 < end && beats.missed[chosen] == 0) ++chosen;
    if (beats.known && beats.missed[chosen] == 0) chosen = i;
    shown.push_back(static_cast<std::uint32_t>(chosen));
  }
  return shown;
}

/// Number of points shown among those of an earlier run.
std::size_t count_before(const JobRun& run) {
  return (run.points_before.size() + stride_of(run) - 1) / stride_of(run);
}

void append_point(const geometry::Point& point, const CloudBox& box, std::uint8_t beats, Fate fate,
                  std::string& bytes) {
  const auto at = coordinates(point);
  for (std::size_t a = 0; a < 3; ++a) append(bytes, share(at[a], box.low[a], box.size[a]));
  append(bytes, beats);
  append(bytes, static_cast<std::uint8_t>(fate));
}

std::string cloud_bytes(const JobRun& run, const PointBeats& beats, const CloudBox& box,
                        const std::vector<std::uint32_t>& shown) {
  std::string bytes;
  bytes.reserve(8 * (count_before(run) + shown.size()));
  for (std::size_t i = 0; i < run.points_before.size(); i += stride_of(run))
    append_point(run.points_before[i], box, 0, Fate::fired_before, bytes);
  for (const std::uint32_t i : shown)
    append_point(run.points[i], box, beats_to(beats, i), fate_of(run, beats, i), bytes);
  return bytes;
}

/// Appends base64 by RFC 4648.
void append_base64(std::string_view bytes, std::string& text) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text.push_back(k <= count ? digits[group >> (18 - 6 * k) & 63] : '=');
  }
}

Json histogram_json(const Histogram& histogram) {
  return {{"from", histogram.from},   {"bin", histogram.bin},       {"counts", histogram.counts},
          {"least", histogram.least}, {"median", histogram.median}, {"values", histogram.values},
          {"open", histogram.open}};
}

/// Beats at places evenly spread over the points, for a clock: the beat when all points up to there
/// were fired. The beats of single points are not monotonic after a point that was fired late.
Json clock_json(const PointBeats& beats) {
  Json places = Json::array();
  if (!beats.known || beats.beat.empty()) return places;
  const std::size_t last = beats.beat.size() - 1;
  std::uint32_t latest = 0;
  std::size_t point = 0;
  for (std::size_t i = 0; i <= clock_places; ++i) {
    for (const std::size_t end = last * i / clock_places; point <= end; ++point)
      latest = std::max(latest, beats.beat[point]);
    places.push_back(latest);
  }
  return places;
}

Json settings_table() {
  Json rows = Json::array();
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const settings::Row& row = settings::row(static_cast<settings::Id>(i));
    rows.push_back(
        {row.number, std::string(row.name), std::string(row.unit), std::string(row.description)});
  }
  return rows;
}

/// How the job ended early; warnings about the points, and about faults in the run.
std::vector<std::string> warnings_of(const Report& report, const JobRun& run,
                                     std::uint64_t not_reached) {
  std::vector<std::string> warnings;
  if (const std::string end = headline(report); !end.empty()) warnings.push_back(end);
  warnings.insert(warnings.end(), run.warnings.begin(), run.warnings.end());
  const auto warn = [&warnings](std::uint64_t count, const char* what) {
    if (count > 0) warnings.push_back(fmt::format("{} {}", count, what));
  };
  const auto beats = [&report](const char* reason) {
    const auto found = report.beats_by_reason.find(reason);
    return found == report.beats_by_reason.end() ? 0 : found->second;
  };
  const std::uint64_t missed = report.missed.value_or(0);
  warn(missed - std::min(missed, not_reached), "points were not fired");
  warn(report.doubled.value_or(0), "shots were fired in addition to those ordered");
  warn(report.checks.not_made, "shots were not detected by their photosensor");
  warn(beats("starved"), "beats were lost because the computer sent points too late");
  warn(beats("outside_tolerance"), "flashes occurred while the machine was not at its point");
  warn(beats("no_edge"), "flashes of the lamp were missing");
  return warnings;
}

Json page_json(const Report& report, const JobRun& run, const PointBeats& beats,
               const CloudBox& box, const std::vector<std::uint32_t>& shown) {
  const Utilisation use = utilisation_over_time(beats, report.beats);
  const std::uint64_t not_reached = count_not_reached(run, beats);
  return {{"report", Json::parse(to_json(report))},
          {"estimate", !run.foreseen_beats.empty()},
          {"first", run.first_number},
          {"pauses", run.pauses},
          {"description", run.making.description.empty() ? Json(nullptr) : Json(description_name)},
          {"warnings", warnings_of(report, run, not_reached)},
          {"settings_table", settings_table()},
          {"cloud",
           {{"count", shown.size()},
            {"before", count_before(run)},
            {"of", run.points.size()},
            {"not_reached", not_reached},
            {"stride", stride_of(run)},
            {"low_mm", box.low},
            {"size_mm", box.size},
            {"beats_known", beats.known},
            {"fates_known", run.shots_known && !run.dry}}},
          {"clock", clock_json(beats)},
          {"spacing_mm", histogram_json(spacing_histogram(run.points))},
          {"beats", histogram_json(beats_histogram(beats))},
          {"utilisation", {{"beats_per_bin", use.beats_per_bin}, {"share", use.share}}}};
}

}  // namespace

std::string page(const Report& report, const JobRun& run) {
  const PointBeats beats = point_beats(run);
  const CloudBox box = box_round(run);
  const std::vector<std::uint32_t> shown = shown_points(run, beats);
  const std::string_view whole = page_template();
  const std::size_t data = whole.find(data_place), cloud = whole.find(cloud_place);
  const std::string json = json_in_script(page_json(report, run, beats, box, shown));
  const std::string bytes = cloud_bytes(run, beats, box, shown);
  std::string text;
  text.reserve(whole.size() + json.size() + bytes.size() / 3 * 4 + 8);
  text.append(whole.substr(0, data)).append(json);
  text.append(whole.substr(data + data_place.size(), cloud - data - data_place.size()));
  append_base64(bytes, text);
  text.append(whole.substr(cloud + cloud_place.size()));
  return text;
}

void write_page(const Report& report, const JobRun& run, const std::filesystem::path& file) {
  write_file(file, page(report, run));
}

}  // namespace lamplock::report
