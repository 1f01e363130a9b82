#include "host/run/report_folder.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/report/files.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

constexpr std::array report_files{"report.json", "report.html", "shots.csv", "shots.ply",
                                  "cloud.png"};

/// Removes a folder of its own making when it goes.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(fs::path path) : path_(std::move(path)) {}
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

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
  files.reserve(report_files.size());
  for (const char* name : report_files) files.push_back(folder / name);
  return files;
}

void check_report_folder(const fs::path& folder) {
  // The nearest folder that is there decides about those that will be made in it.
  std::error_code ignored;
  fs::path there = fs::absolute(folder, ignored);
  while (!fs::exists(there, ignored) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, ignored)) refuse_folder(folder, "is not a folder");
  if (::access(there.c_str(), W_OK) != 0) refuse_folder(folder, "the folder cannot be written in");
  for (const char* name : report_files)
    if (fs::is_directory(folder / name, ignored)) refuse_folder(folder / name, "is a folder");
}

void write_report_whole(const report::Report& report, const report::JobRun& run,
                        const fs::path& folder) {
  // Next to its place, not inside it: a rename must not cross file systems.
  fs::path whole = folder;
  if (!whole.has_filename()) whole = whole.parent_path();
  const TemporaryFolder staged(whole.string() + fmt::format(".{}.part", ::getpid()));
  try {
    report::write_report(report, run, staged.path());
    fs::create_directories(folder);
    for (const char* name : report_files) {
      if (fs::exists(staged.path() / name))
        fs::rename(staged.path() / name, folder / name);
      else
        fs::remove(folder / name);
    }
  } catch (const std::exception&) {
    refuse_folder(folder, "the report cannot be written");
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
