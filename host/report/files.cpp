#include "host/report/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <system_error>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/report/matching.hpp"
#include "host/report/page.hpp"
#include "host/report/picture.hpp"

namespace lamplock::report {
namespace {

namespace fs = std::filesystem;

/// Position of a shot in the glass, in the input's coordinates.
geometry::Point position_mm(const sim::Shot& shot, const PerAxis<double>& steps_per_mm,
                            const glass::Refraction& refraction) {
  return refraction.glass({shot.steps[0] / steps_per_mm[0], shot.steps[1] / steps_per_mm[1],
                           shot.steps[2] / steps_per_mm[2]});
}

/// PLY, binary little endian: x y z in mm, then the beat and the channel.
void write_ply(const JobRun& run, const fs::path& path) {
  std::string data = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment shots, mm\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uint beat\nproperty uchar channel\nend_header\n",
      run.shots.size());
  for (const sim::Shot& shot : run.shots) {
    const geometry::Point p = position_mm(shot, run.steps_per_mm, run.refraction);
    for (const double coordinate : {p.x, p.y, p.z}) append(data, static_cast<float>(coordinate));
    append(data, static_cast<std::uint32_t>(shot.beat));
    data.push_back(static_cast<char>(shot.channel));
  }
  write_file(path, data);
}

/// The points that were fired as far as it is known.
geometry::PointCloud engraved(const JobRun& run) {
  if (!run.shots_known) {
    const auto end = static_cast<std::ptrdiff_t>(first_not_fired(run));
    return {run.points.begin(), run.points.begin() + end};
  }
  geometry::PointCloud cloud(run.shots.size());
  std::transform(run.shots.begin(), run.shots.end(), cloud.begin(), [&run](const sim::Shot& shot) {
    return position_mm(shot, run.steps_per_mm, run.refraction);
  });
  return cloud;
}

/// The points after the last one fired. One of them may have been fired after all: its light hides
/// the grey dot.
geometry::PointCloud not_fired(const JobRun& run) {
  return {run.points.begin() + static_cast<std::ptrdiff_t>(first_not_fired(run)), run.points.end()};
}

constexpr const char* shot_columns = "index,channel,beat,time_us,x_mm,y_mm,z_mm";

/// The columns of a shot, without the end of its line.
void append_shot(const sim::Shot& shot, const geometry::Point& p, std::string& text) {
  // Shortest decimals that read back as the same number; time to the picosecond.
  fmt::format_to(std::back_inserter(text), "{},{},{},{}.{:06},{},{},{}", shot.index, shot.channel,
                 shot.beat, shot.at / sim::ps_per_us, shot.at % sim::ps_per_us, p.x, p.y, p.z);
}

}  // namespace

void write_shots_csv(const sim::Shots& shots, const PerAxis<double>& steps_per_mm,
                     const fs::path& path) {
  std::string text = fmt::format("{}\n", shot_columns);
  for (const sim::Shot& shot : shots) {
    append_shot(shot, position_mm(shot, steps_per_mm, {}), text);
    text.push_back('\n');
  }
  write_file(path, text);
}

void write_shots_csv(const JobRun& run, const fs::path& path) {
  std::string text = fmt::format("{},point\n", shot_columns);
  const std::vector<std::uint32_t> point_of_shot = match_shots(run).point_of_shot;
  const std::vector<std::uint64_t> numbers = point_numbers(run);
  for (std::size_t i = 0; i < run.shots.size(); ++i) {
    append_shot(run.shots[i], position_mm(run.shots[i], run.steps_per_mm, run.refraction), text);
    const std::uint32_t point = point_of_shot[i];
    text += point == no_point ? ",\n" : fmt::format(",{}\n", numbers[point]);
  }
  write_file(path, text);
}

bool ReportFile::belongs_to(const JobRun& run) const {
  return needs == ReportNeeds::shots         ? run.shots_known
         : needs == ReportNeeds::description ? !run.making.description.empty()
                                             : true;
}

const std::vector<ReportFile>& report_files() {
  static const std::vector<ReportFile> files{
      {"report.json", [](const Report& report, const JobRun&,
                         const fs::path& path) { write_file(path, to_json(report)); }},
      {description_name,
       [](const Report&, const JobRun& run, const fs::path& path) {
         write_file(path, run.making.description);
       },
       ReportNeeds::description},
      {"shots.csv",
       [](const Report&, const JobRun& run, const fs::path& path) { write_shots_csv(run, path); },
       ReportNeeds::shots},
      {"shots.ply",
       [](const Report&, const JobRun& run, const fs::path& path) { write_ply(run, path); },
       ReportNeeds::shots},
      {"report.html", write_page},
      {"cloud.png", [](const Report&, const JobRun& run, const fs::path& path) {
         write_cloud_picture(path, engraved(run), not_fired(run), run.points_before);
       }}};
  return files;
}

void write_report(const Report& report, const JobRun& run, const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(folder, "cannot be created (" + error.message() + ")", "choose another folder");
  for (const ReportFile& file : report_files())
    if (file.belongs_to(run)) file.write(report, run, folder / file.name);
}

}  // namespace lamplock::report
