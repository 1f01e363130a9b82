// Reads a job file that the user named.
//
// In:  the name of a file. Out: the job, or an error that says how to make a job of a model or a
//      picture. Who: `send`, `estimate`, `job --show`.
#pragma once

#include <string>

#include "host/job/job.hpp"
#include "host/run/prepared_job.hpp"

namespace lamplock::run {

/// Throws Error(bad_input) if the file is not a valid job file.
job::Job read_job(const std::string& file);

/// The same with the points of the job. Throws Error(bad_input).
PreparedJob read_prepared_job(const std::string& file);

/// How to make a job of this file, for a remedy; empty for a file of which none is made.
std::string way_to_job(const std::string& file);

}  // namespace lamplock::run
