// The files of a report.
//
// In:  the run of a job. Out: report.json, report.html, shots.csv, shots.ply, cloud.png.
// Who: report folders of the use cases (host/run/report_folder.hpp).
#pragma once

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

/// A file of a report.
struct ReportFile {
  const char* name;
  /// Throws lamplock::Error if the file cannot be written.
  std::function<void(const Report&, const JobRun&, const std::filesystem::path&)> write;
  bool needs_shots = false;  ///< there is no such file without known shots
};

/// All files in the order of writing: the numbers first, pictures last. Without known shots the
/// picture shows the ordered points.
const std::vector<ReportFile>& report_files();

/// Writes the files into `folder`, which is made if needed. Throws lamplock::Error if one cannot be
/// written.
void write_report(const Report& report, const JobRun& run, const std::filesystem::path& folder);

}  // namespace lamplock::report
