// The files of a report.
//
// In:  the run of a job. Out: report.json, report.html, shots.csv, shots.ply, cloud.png.
// Who: the command line after a job.
#pragma once

#include <filesystem>

#include "host/report/report.hpp"

namespace lamplock::report {

/// Writes shots whose points are unknown: one line each, positions in mm. Throws lamplock::Error if
/// the file cannot be written.
void write_shots_csv(const sim::Shots& shots, const PerAxis<double>& steps_per_mm,
                     const std::filesystem::path& path);
/// Writes the shots of a job for shots.csv: positions in the glass, followed by the number in the
/// job of the point of each. Throws as the other.
void write_shots_csv(const JobRun& run, const std::filesystem::path& path);

/// Writes report.json, report.html (page.hpp), shots.csv, shots.ply and cloud.png into `folder`,
/// which is made if needed. Without known shots there is no shots.csv and no shots.ply, and the
/// picture shows the ordered points. Throws lamplock::Error if a file cannot be written.
void write_report(const Report& report, const JobRun& run, const std::filesystem::path& folder);

}  // namespace lamplock::report
