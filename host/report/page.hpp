// The page of a job: report.html.
//
// In:  an evaluated run, or an estimate in the form of one.
// Out: one self-contained HTML file: style, script and data are in it, and it needs no server.
//      Template and script: host/report/page/, built into the program.
// Who: the files of a report, `estimate --page`. Budget: a million points in 2 s and 15 MB.
//
// Data: JSON for numbers and charts, and for the cloud eight bytes per point in base64: x y z as
// fractions of the bounding box (16 bits each, little endian), the beats from the point before (0:
// none or unknown, 254: as many or more) and its fate: 0 fired or unknown, 1 missed, 2 not reached
// before the job ended, 3 fired by an earlier run. The latter come first. Of clouds of more than
// `max_points_shown` every n-th point is shown, or one of the next n that was missed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "host/report/report.hpp"

namespace lamplock::report {

/// A page with more points would be too large a file.
inline constexpr std::size_t max_points_shown = 1'000'000;

/// The page as text. A run with predicted beats is shown as an estimate.
std::string page(const Report& report, const JobRun& run);

/// Writes the page. Throws lamplock::Error if the file cannot be written.
void write_page(const Report& report, const JobRun& run, const std::filesystem::path& file);

}  // namespace lamplock::report
