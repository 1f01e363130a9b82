// A file with space reserved on its disk before there is anything to write: a job that has fired
// must not lose its numbers because the disk is full by then.
//
// In:  where the file is to be, how much space. Out: the file, or an Error and nothing.
// Who: the reports of jobs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

#include "host/file/unfinished_paths.hpp"

namespace lamplock {

/// A file in the making; without write() nothing is left of it.
class ReservedFile {
 public:
  /// Reserves `bytes` for the file beside its place. Throws Error(bad_input) if the file cannot be
  /// written there, or the disk is full.
  ReservedFile(std::filesystem::path target, std::size_t bytes);
  ~ReservedFile();
  ReservedFile(const ReservedFile&) = delete;
  ReservedFile& operator=(const ReservedFile&) = delete;

  const std::filesystem::path& target() const { return target_; }

  /// Writes the file and puts it in its place; at most once. If the reserved file is gone, another
  /// one is made. Throws Error(bad_input).
  void write(std::string_view text);

 private:
  std::filesystem::path target_, place_, staged_;
  UnfinishedPath unfinished_;
  int descriptor_ = -1;
};

}  // namespace lamplock
