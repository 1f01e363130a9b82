// The files of a report.
//
// In:  the run of a job. Out: report.json, job.toml, report.html, shots.csv, shots.ply, cloud.png.
// Who: report folders of the use cases (host/run/report_folder.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "host/report/report.hpp"

namespace lamplock::report {

/// Writes shots whose points are unknown: one line each, positions in mm. Throws lamplock::Error if
/// the file cannot be written.
void write_shots_csv(const sim::Shots& shots, const PerAxis<double>& steps_per_mm,
                     const std::filesystem::path& path);
/// Writes the shots of a job for shots.csv: positions in the glass, followed by the number in the
/// job of the point of each. Throws as the other.
void write_shots_csv(const JobRun& run, const std::filesystem::path& path);

/// What a run must have for a file of its report.
enum class ReportNeeds : std::uint8_t {
  nothing,
  shots,       ///< known shots
  description  ///< the description of how the job was made
};

/// A file of a report.
struct ReportFile {
  const char* name;
  /// Throws lamplock::Error if the file cannot be written.
  std::function<void(const Report&, const JobRun&, const std::filesystem::path&)> write;
  ReportNeeds needs = ReportNeeds::nothing;

  /// Whether there is such a file for this run.
  bool belongs_to(const JobRun& run) const;
};

/// All files in the order of writing: the numbers first, pictures last. Without known shots there
/// is no shots.csv and no shots.ply, and the picture shows the ordered points.
const std::vector<ReportFile>& report_files();

/// Writes the files into `folder`, which is made if needed. Throws lamplock::Error if one cannot be
/// written.
void write_report(const Report& report, const JobRun& run, const std::filesystem::path& folder);

}  // namespace lamplock::report
