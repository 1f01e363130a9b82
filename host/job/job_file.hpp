// The job file (.llj): a job on disk, made for certain settings (docs/wire-format.md, section 6).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "host/job/job.hpp"

namespace lamplock::job {

/// The bytes of a job file. The settings hash in its header is that of job.settings.
std::vector<std::uint8_t> encode_job_file(const Job& job);

/// A job from the bytes of a file; `name` is for errors. Throws Error(bad_input) if they are
/// truncated, corrupt, of another version, or made with another settings table.
Job decode_job_file(std::span<const std::uint8_t> bytes, const std::string& name);

/// The first bytes of the file are those of a job, maybe a damaged one; false if it cannot be read.
bool starts_with_job(const std::filesystem::path& file);

/// Writes a job file. Throws Error(bad_input) if it cannot be written.
void write_job_file(const std::filesystem::path& file, const Job& job);

/// Reads a job file; see decode_job_file.
Job read_job_file(const std::filesystem::path& file);

}  // namespace lamplock::job
