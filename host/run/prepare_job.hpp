// From a description to a job: points, their order, the job for the machine.
//
// In:  a request. Out: a job with its points. Who: `engrave`, `job`, `estimate`, `frame`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/geometry/point.hpp"
#include "host/glass/description.hpp"
#include "host/glass/volume.hpp"
#include "host/run/frontend.hpp"
#include "host/run/origin.hpp"
#include "host/run/prepared_job.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::run {

/// A model or description to engrave.
struct JobRequest {
  std::string input{};  ///< the file that the user has named
  glass::Description description{};
  std::string save{};                   ///< file that the description is written to; empty: none
  std::string origin = origin_machine;  ///< or origin_zero
};

/// The files that a request reads: its input, and those that its description names.
std::vector<std::string> input_files(const JobRequest& request);

/// Reads, discretises, orders and rounds to steps; then writes the description if that was
/// requested. `origin`: the origin of the description in machine coordinates, mm; the points of the
/// job are the machine's. Throws Error(bad_input).
PreparedJob prepare_job(const JobRequest& request, bool dry,
                        const std::optional<geometry::Point>& origin, Frontend& frontend);

/// Prepares a job and writes its file, whole or not at all. Throws Error(bad_input).
job::Job make_job_file(const JobRequest& request, bool dry, const std::string& output,
                       Frontend& frontend);

/// Writes the description of a request if that was requested. Throws Error(bad_input).
void save_description(const JobRequest& request, Frontend& frontend);

/// The volume for a job, in its own coordinates: objects are placed round `origin`, if there is
/// one.
glass::Volume volume_at(const std::optional<geometry::Point>& origin,
                        const glass::Description& description, const settings::Values& values);
/// From these coordinates to the machine's: moves points and the glass that they are in.
void move_to(const std::optional<geometry::Point>& origin, geometry::PointCloud& points,
             glass::Volume& volume);

}  // namespace lamplock::run
