// One page that shows a job: report.html.
//
// In:  a judged run, or an estimate in the form of one.
// Out: one HTML file that needs nothing else: style, script and data are in it, and it asks no
//      server. Template and script: host/report/page/, built into the program.
// Who: the files of a report, `estimate --page`. Budget: a million points in 2 s and 15 MB.
//
// Data: JSON for numbers and charts, and for the cloud eight bytes a point in base64: x y z as
// shares of the box round the cloud (16 bits each, little endian), the beats of the way to it
// (0: none or not known, 254: as many or more) and 1 if it was missed. Of clouds of more than
// `most_points_shown` every n-th point is shown, or one of the next n that was missed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "host/report/report.hpp"

namespace lamplock::report {

/// More points than this make a file too large to pass on.
inline constexpr std::size_t most_points_shown = 1'000'000;

/// The page as text. A run with foreseen beats is shown as an estimate.
std::string page(const Report& report, const JobRun& run);

/// Writes it. Throws lamplock::Error if the file cannot be written.
void write_page(const Report& report, const JobRun& run, const std::filesystem::path& file);

}  // namespace lamplock::report
