// Files and folders in the making that must not remain when a signal ends the program.
//
// In:  paths, as they are made and finished. Out: none of them is left. Who: files in the making
//      (staged_file.hpp, reserved_file.hpp), folders of reports; handlers of signals.
// A handler may only call functions that are safe in it: no memory is allocated here.
#pragma once

#include <cstddef>
#include <filesystem>

namespace lamplock {

/// A path that is removed if a signal ends the program while the object exists. The object itself
/// removes nothing. A path without a free place, or too long for the system, is not removed.
class UnfinishedPath {
 public:
  explicit UnfinishedPath(const std::filesystem::path& path);
  ~UnfinishedPath();
  UnfinishedPath(const UnfinishedPath&) = delete;
  UnfinishedPath& operator=(const UnfinishedPath&) = delete;

 private:
  std::size_t place_;
};

/// Removes all unfinished paths, the last one first: files, and folders that are empty. May be
/// called in a signal handler.
void remove_unfinished_paths() noexcept;

}  // namespace lamplock
