#include "host/report/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "host/error.hpp"
#include "host/geometry/bounds.hpp"
#include "host/report/matching.hpp"
#include "host/units.hpp"
#include "host/version.hpp"
#include "shared/beat_reason.hpp"

namespace lamplock::report {
namespace {

void check(const JobRun& run) {
  const auto contradiction = [](const std::string& what) {
    throw Error(
        Exit::job_failed, "report", what,
        "the recorded data contradict each other: a fault of this program; do not fire the job a "
        "second time, and report the fault");
  };
  if (!run.lattice_steps.empty() && run.lattice_steps.size() != run.shots.size())
    contradiction(fmt::format("{} lattice positions for {} shots", run.lattice_steps.size(),
                              run.shots.size()));
  if (!run.shots_ordered.empty() && run.shots_ordered.size() != run.points.size())
    contradiction(
        fmt::format("{} orders for {} points", run.shots_ordered.size(), run.points.size()));
  if (run.points.size() >= no_point) contradiction("too many points");
}

/// Largest error over all matched shots; empty if there is no shot to measure.
template <class StepsOfShot>
std::optional<double> max_error(const JobRun& run, const Matching& matching, StepsOfShot steps_of) {
  std::optional<double> largest;
  for (std::size_t i = 0; i < run.shots.size(); ++i) {
    const std::uint32_t point = matching.point_of_shot[i];
    if (point == no_point) continue;
    const double error = error_steps(
        steps_of(i), wanted_steps(run.refraction.stage(run.points[point]), run.steps_per_mm));
    largest = std::max(largest.value_or(0), error);
  }
  return largest;
}

/// Number of points with shots: 0 for a dry run.
std::uint64_t points_to_fire(const JobRun& run) {
  if (run.shots_ordered.empty()) return run.points.size();
  return run.points.size() - static_cast<std::uint64_t>(
                                 std::count(run.shots_ordered.begin(), run.shots_ordered.end(), 0));
}

void judge_shots(const JobRun& run, Report& report) {
  const Matching matching = match_shots(run);
  report.points_fired = points_to_fire(run) - matching.missed;
  report.missed = matching.missed;
  report.doubled = matching.doubled - std::min(matching.doubled, run.checks.repeats);
  report.max_jitter_error_steps =
      max_error(run, matching, [&run](std::size_t i) { return run.shots[i].steps; });
  if (!run.lattice_steps.empty())
    report.max_error_steps =
        max_error(run, matching, [&run](std::size_t i) { return run.lattice_steps[i]; });
}

/// Beats in which the user or the door held the machine; they say nothing about the job.
std::uint64_t held_beats(const Report& report) {
  std::uint64_t held = 0;
  for (const BeatReason reason : {BeatReason::hold, BeatReason::door}) {
    const auto found = report.beats_by_reason.find(std::string(name(reason)));
    if (found != report.beats_by_reason.end()) held += found->second;
  }
  return std::min(held, report.beats);
}

/// Ratios per point and per second, by the points that were fired, or passed in a dry run: a job
/// may have been stopped.
void add_ratios(const JobRun& run, Report& report) {
  const auto ratio = [](double a, double b) { return b > 0 ? a / b : 0.0; };
  const auto done = static_cast<double>(run.dry ? run.stopped_before.value_or(run.points.size())
                                                : report.points_fired);
  const auto beats = static_cast<double>(report.beats - held_beats(report));
  report.beats_per_point = ratio(beats, done);
  report.utilisation = ratio(static_cast<double>(report.shots), beats);
  report.points_per_s = ratio(done, report.time_s);
}

/// Sides of the box round all points of the job, if all of them are finite.
std::optional<std::array<double, 3>> size_of(const JobRun& run) {
  std::optional<geometry::Bounds> box;
  for (const geometry::PointCloud* points : {&run.points_before, &run.points}) {
    if (!std::all_of(points->begin(), points->end(), geometry::is_finite)) return std::nullopt;
    if (points->empty()) continue;
    geometry::Bounds part = geometry::bounds(*points);
    if (box) {
      part.low = {std::min(part.low.x, box->low.x), std::min(part.low.y, box->low.y),
                  std::min(part.low.z, box->low.z)};
      part.high = {std::max(part.high.x, box->high.x), std::max(part.high.y, box->high.y),
                   std::max(part.high.z, box->high.z)};
    }
    box = part;
  }
  if (!box) return std::nullopt;
  return std::array{box->high.x - box->low.x, box->high.y - box->low.y, box->high.z - box->low.z};
}

nlohmann::ordered_json text_or_null(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

template <class T>
nlohmann::ordered_json or_null(const std::optional<T>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

/// The number of a point where firing ended; null if nothing could be fired.
nlohmann::ordered_json of_firing(const Report& report, std::uint64_t number) {
  return report.end.name.empty() || report.dry ? nlohmann::ordered_json(nullptr)
                                               : nlohmann::ordered_json(number);
}

/// Null instead of the keys of an end: an estimate has none.
nlohmann::ordered_json of_end(const Report& report, const nlohmann::ordered_json& value) {
  return report.end.name.empty() ? nlohmann::ordered_json(nullptr) : value;
}

nlohmann::ordered_json settings_json(const settings::Values& values) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const auto id = static_cast<settings::Id>(i);
    const settings::Row& row = settings::row(id);
    const std::string name(row.name);
    if (row.whole)
      json[name] = values.whole(id);
    else
      json[name] = in_units(values, id);
  }
  return json;
}

}  // namespace

Report evaluate(const JobRun& run) {
  check(run);
  Report report;
  report.version = lamplock::version();
  report.input = run.input;
  report.mode = run.mode;
  report.board = run.board;
  report.making = run.making;
  report.dry = run.dry;
  report.size_mm = size_of(run);
  report.lamp_hz = in_units(run.settings, settings::Id::lamp_frequency);
  report.end = run.end;
  report.from = run.first_number;
  report.points_before = run.points_before.size();
  report.flashes_per_point = run.flashes_per_point;
  report.pauses = run.pauses.size();
  report.pause_beats = run.pause_beats;
  report.points = run.points.size();
  report.points_fired = run.points_fired;
  report.shots = run.shots_known ? run.shots.size() : run.shots_fired;
  report.beats = run.beats;
  report.beats_before = run.beats_before;
  report.time_s = run.time_s;
  report.beats_by_reason = run.beats_by_reason;
  report.beats_outside = run.beats_outside;
  report.checks = run.checks;
  report.link = run.link;
  report.settings = run.settings;
  if (run.shots_known) judge_shots(run, report);
  add_ratios(run, report);
  return report;
}

std::size_t first_not_fired(const JobRun& run) {
  return run.dry ? 0 : run.stopped_before.value_or(run.points.size());
}

std::vector<std::uint64_t> point_numbers(const JobRun& run) {
  std::vector<std::uint64_t> numbers(run.points.size());
  std::size_t pauses = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    while (pauses < run.pauses.size() && run.pauses[pauses] <= i) ++pauses;
    numbers[i] = run.first_number + i + pauses;
  }
  return numbers;
}

std::string to_json(const Report& report) {
  const nlohmann::ordered_json json{
      {"version", report.version},
      {"input", report.input},
      {"mode", report.mode},
      {"board", report.board},
      {"command", text_or_null(report.making.command)},
      {"dry", report.dry},
      {"size_mm", or_null(report.size_mm)},
      {"spacing_mm", or_null(report.making.spacing_mm)},
      {"method", text_or_null(report.making.method)},
      {"order", text_or_null(report.making.order)},
      {"material", text_or_null(report.making.material)},
      {"lamp_hz", report.lamp_hz},
      {"flashes_per_point", report.flashes_per_point},
      {"pauses", report.pauses},
      {"pause_beats", report.pause_beats},
      {"from", report.from},
      {"points_before", report.points_before},
      {"end", of_end(report, report.end.name)},
      {"first_unfired", of_firing(report, report.end.first_unfired)},
      {"may_have_fired", of_firing(report, report.end.may_have_fired)},
      {"continue_with", of_end(report, report.end.continue_with)},
      {"points", report.points},
      {"points_fired", report.points_fired},
      {"shots", report.shots},
      {"beats", report.beats},
      {"beats_before", report.beats_before},
      {"beats_per_point", report.beats_per_point},
      {"utilisation", report.utilisation},
      {"time_s", report.time_s},
      {"points_per_s", report.points_per_s},
      {"largest_error_steps", or_null(report.max_error_steps)},
      {"largest_jitter_error_steps", or_null(report.max_jitter_error_steps)},
      {"missed", or_null(report.missed)},
      {"doubled", or_null(report.doubled)},
      {"beats_by_reason", report.beats_by_reason},
      {"beats_outside", report.beats_outside},
      {"photosensors",
       {{"made", report.checks.made},
        {"not_made", report.checks.not_made},
        {"repeats", report.checks.repeats}}},
      {"link",
       {{"resent", report.link.resent},
        {"bad", report.link.bad},
        {"reconnects", report.link.reconnects}}},
      {"settings", settings_json(report.settings)},
  };
  // A file name that is not valid UTF-8 must not prevent the report.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace lamplock::report
