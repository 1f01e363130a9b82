#include "host/run/report_folder.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/output_error.hpp"
#include "host/report/files.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

/// More than report.json needs: settings and counters, each by name.
constexpr std::size_t numbers_bytes = 64 << 10;

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

report::Report parse(const std::string& text) {
  const auto json = nlohmann::json::parse(text);
  report::Report report;
  json.at("version").get_to(report.version);
  json.at("input").get_to(report.input);
  json.at("mode").get_to(report.mode);
  json.at("board").get_to(report.board);
  json.at("lamp_hz").get_to(report.lamp_hz);
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
  read_optional(json, "largest_error_steps", report.largest_error_steps);
  read_optional(json, "largest_jitter_error_steps", report.largest_jitter_error_steps);
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

void ReportFolder::write_numbers(const report::Report& report, LostFiles& lost) {
  std::error_code ignored;
  for (const fs::path& file : files_of_report(folder_)) fs::remove(file, ignored);
  fs::create_directories(folder_, ignored);  // it may be gone since
  lost.attempt(numbers_->target().string(), [&] { numbers_->write(report::to_json(report)); });
}

void ReportFolder::write_rest(const report::Report& report, const report::JobRun& run,
                              LostFiles& lost) const {
  const auto& files = report::report_files();
  for (auto file = files.begin() + 1; file != files.end(); ++file) {
    if (file->needs_shots && !run.shots_known) continue;
    const fs::path target = folder_ / file->name;
    lost.attempt(target.string(), [&] {
      write_whole(target, [&](const fs::path& path) { file->write(report, run, path); });
    });
  }
}

report::Report read_report(const fs::path& folder) {
  std::error_code ignored;
  const fs::path file = fs::is_directory(folder, ignored) ? folder / "report.json" : folder;
  const std::string text = read_file(file);
  try {
    return parse(text);
  } catch (const nlohmann::json::exception&) {
    throw Error(Exit::bad_input, file.string(), "is not a report of lamplock",
                "give a folder written with --report");
  }
}

}  // namespace lamplock::run
