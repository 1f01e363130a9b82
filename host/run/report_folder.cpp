#include "host/run/report_folder.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/output_error.hpp"
#include "host/report/files.hpp"
#include "host/run/free_name.hpp"
#include "host/shell_text.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

/// More than report.json needs: settings and counters, each by name.
constexpr std::size_t numbers_bytes = 64 << 10;

/// One of report_files().
constexpr const char* program_page = "report.html";

template <class T>
void read_optional(const nlohmann::json& json, const char* key, std::optional<T>& value) {
  if (const auto& found = json.at(key); !found.is_null()) value = found.get<T>();
}

void read_settings(const nlohmann::json& json, settings::Values& values) {
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const auto id = static_cast<settings::Id>(i);
    const auto found = json.find(std::string(settings::row(id).name));
    if (found == json.end()) continue;
    values.set_milli(id,
                     static_cast<std::int32_t>(std::lround(found->get<double>() * milli_per_unit)));
  }
}

/// Reports of older programs have no such keys.
void read_making(const nlohmann::json& json, report::Report& report) {
  const auto read_text = [&json](const char* key, std::string& text) {
    const auto found = json.find(key);
    if (found != json.end() && !found->is_null()) found->get_to(text);
  };
  read_text("command", report.making.command);
  read_text("method", report.making.method);
  read_text("order", report.making.order);
  read_text("material", report.making.material);
  if (json.contains("spacing_mm")) read_optional(json, "spacing_mm", report.making.spacing_mm);
  if (json.contains("size_mm")) read_optional(json, "size_mm", report.size_mm);
}

report::Report parse(const std::string& text) {
  const auto json = nlohmann::json::parse(text);
  report::Report report;
  json.at("version").get_to(report.version);
  json.at("input").get_to(report.input);
  json.at("mode").get_to(report.mode);
  json.at("board").get_to(report.board);
  read_making(json, report);
  json.at("lamp_hz").get_to(report.lamp_hz);
  report.dry = json.value("dry", false);
  // Reports of older programs have no end, and estimates have none either.
  if (const auto end = json.find("end"); end != json.end() && !end->is_null()) {
    end->get_to(report.end.name);
    // A dry run has no such numbers.
    if (!json.at("first_unfired").is_null()) {
      json.at("first_unfired").get_to(report.end.first_unfired);
      json.at("may_have_fired").get_to(report.end.may_have_fired);
    }
    json.at("continue_with").get_to(report.end.continue_with);
  }
  report.from = json.value("from", report.from);
  report.points_before = json.value("points_before", report.points_before);
  report.flashes_per_point = json.value("flashes_per_point", report.flashes_per_point);
  report.pauses = json.value("pauses", report.pauses);
  report.pause_beats = json.value("pause_beats", report.pause_beats);
  json.at("points").get_to(report.points);
  json.at("shots").get_to(report.shots);
  // Reports of older programs have it not; there "points" may be more than were fired.
  report.points_fired = json.value("points_fired", report.points);
  json.at("beats").get_to(report.beats);
  json.at("beats_before").get_to(report.beats_before);
  json.at("beats_per_point").get_to(report.beats_per_point);
  json.at("utilisation").get_to(report.utilisation);
  json.at("time_s").get_to(report.time_s);
  json.at("points_per_s").get_to(report.points_per_s);
  read_optional(json, "largest_error_steps", report.max_error_steps);
  read_optional(json, "largest_jitter_error_steps", report.max_jitter_error_steps);
  read_optional(json, "missed", report.missed);
  read_optional(json, "doubled", report.doubled);
  json.at("beats_by_reason").get_to(report.beats_by_reason);
  json.at("beats_outside").get_to(report.beats_outside);
  const auto& checks = json.at("photosensors");
  report.checks = {checks.at("made"), checks.at("not_made"), checks.at("repeats")};
  const auto& link = json.at("link");
  report.link = {link.at("resent"), link.at("bad"), link.at("reconnects")};
  read_settings(json.at("settings"), report.settings);
  return report;
}

/// The folder of a report that is named by its folder or by its file.
fs::path folder_of_report(const fs::path& named) {
  std::error_code ignored;
  fs::path path = fs::absolute(named, ignored).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();
  return path.filename() == report::report_files().front().name ? path.parent_path() : path;
}

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& why) {
  throw Error(Exit::bad_input, folder.string(), why, "give another folder with --report");
}

}  // namespace

std::vector<fs::path> files_of_report(const fs::path& folder) {
  std::vector<fs::path> files;
  if (folder.empty()) return files;
  for (const report::ReportFile& file : report::report_files()) files.push_back(folder / file.name);
  return files;
}

void check_report_folder(const fs::path& folder) {
  const ReportFolder trial(folder);
  for (const fs::path& file : files_of_report(folder)) check_target(file);
}

void refuse_first_part(const fs::path& folder) {
  std::error_code ignored;
  const fs::path numbers = folder / report::report_files().front().name;
  if (!fs::exists(numbers, ignored)) return;
  report::Report older;
  try {
    older = read_report(folder);
  } catch (const Error&) {
    return;  // not a report that could be compared with the rest of the job
  }
  const bool has_ended_early = !older.end.name.empty() && older.end.name != "done";
  if (!has_ended_early || older.dry) return;
  throw Error(
      Exit::bad_input, folder.string(), "has the report of the part that was engraved before",
      "keep it and give a new folder: --report " + shell_text({next_free_folder(folder.string())}));
}

ReportFolder::ReportFolder(fs::path folder) : folder_(std::move(folder)) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();
  make_folders();
  try {
    numbers_.emplace(folder_ / report::report_files().front().name, numbers_bytes);
  } catch (const OutputError& error) {
    remove_folders();
    refuse_folder(folder_, error.problem());
  }
}

ReportFolder::~ReportFolder() {
  numbers_.reset();
  remove_folders();
}

void ReportFolder::make_folders() {
  std::error_code error;
  fs::path there = fs::absolute(folder_, error);
  for (; !fs::exists(there, error) && there.has_relative_path(); there = there.parent_path())
    made_.push_back(there);
  if (!fs::is_directory(there, error)) refuse_folder(folder_, "is not a folder");
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder)
    unfinished_.emplace_back(*folder);
  fs::create_directories(folder_, error);
  if (!error) return;
  remove_folders();
  refuse_folder(folder_, "cannot be made (" + error.message() + ")");
}

/// Folders with files in them remain.
void ReportFolder::remove_folders() {
  std::error_code ignored;
  for (const fs::path& made : made_) fs::remove(made, ignored);
}

void ReportFolder::write_json(std::string_view text, LostFiles& lost) {
  std::error_code ignored;
  for (const fs::path& file : files_of_report(folder_)) fs::remove(file, ignored);
  fs::create_directories(folder_, ignored);  // it may be gone since
  lost.attempt(numbers_->target().string(), [&] { numbers_->write(text); });
}

void ReportFolder::write_numbers(const report::Report& report, LostFiles& lost) {
  write_json(report::to_json(report), lost);
}

void ReportFolder::write_program(std::string_view numbers, std::string_view page, LostFiles& lost) {
  write_json(numbers, lost);
  const fs::path target = folder_ / program_page;
  lost.attempt(target.string(), [&] { write_whole(target, page); });
}

void ReportFolder::write_rest(const report::Report& report, const report::JobRun& run,
                              LostFiles& lost) const {
  const auto& files = report::report_files();
  for (auto file = files.begin() + 1; file != files.end(); ++file) {
    if (!file->belongs_to(run)) continue;
    const fs::path target = folder_ / file->name;
    lost.attempt(target.string(), [&] {
      write_whole(target, [&](const fs::path& path) { file->write(report, run, path); });
    });
  }
}

std::array<std::string, 2> report_names(const fs::path& first, const fs::path& second) {
  const std::array paths{folder_of_report(first), folder_of_report(second)};
  const auto end_of = [](const fs::path& path, std::ptrdiff_t parts) {
    const std::ptrdiff_t all = std::distance(path.begin(), path.end());
    fs::path end;
    for (auto part = std::next(path.begin(), std::max<std::ptrdiff_t>(0, all - parts));
         part != path.end(); ++part)
      end /= *part;
    return end.string();
  };
  std::array<std::string, 2> names;
  // No path has more parts than characters.
  const auto max_parts =
      static_cast<std::ptrdiff_t>(std::max(paths[0].native().size(), paths[1].native().size()));
  for (std::ptrdiff_t parts = 1; parts <= max_parts && names[0] == names[1]; ++parts)
    names = {end_of(paths[0], parts), end_of(paths[1], parts)};
  return names;
}

report::Report read_report(const fs::path& folder) {
  std::error_code ignored;
  const bool is_folder = fs::is_directory(folder, ignored);
  const fs::path file = is_folder ? folder / report::report_files().front().name : folder;
  if (is_folder && !fs::exists(file, ignored))
    throw Error(Exit::bad_input, folder.string(), "has no report of lamplock (report.json)",
                "give a folder written with --report");
  const std::string text = read_file(file);
  try {
    return parse(text);
  } catch (const nlohmann::json::exception&) {
    throw Error(Exit::bad_input, file.string(), "is not a report of lamplock",
                "give a folder written with --report");
  }
}

}  // namespace lamplock::run
