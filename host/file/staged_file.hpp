// Files that exist whole or not at all: written under another name, then renamed.
//
// In:  where the file is to be. Out: the file, or an Error and nothing.
// Who: every command that writes files.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "host/file/unfinished_paths.hpp"

namespace lamplock {

/// A file in the making; without commit() nothing is left of it.
class StagedFile {
 public:
  /// Throws Error(bad_input) if there is no folder for it, or a file that may not be written.
  explicit StagedFile(std::filesystem::path target);
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  /// Where to write. The target itself if that is no file (a device, a pipe).
  const std::filesystem::path& path() const { return staged_; }
  const std::filesystem::path& target() const { return target_; }

  /// Puts the written file in its place. Throws Error(bad_input) if that fails.
  void commit();

 private:
  std::filesystem::path target_, place_, staged_;
  std::optional<UnfinishedPath> unfinished_{};
};

/// The file that an output with this name makes or replaces: where symbolic links lead to, if it is
/// one. Throws Error(bad_input) for a circle of links.
std::filesystem::path place_of(const std::filesystem::path& target);

/// Puts a written file in its place; it gets mode and owner of the file that it replaces, as far as
/// the user may set them. Another hard link keeps the old contents.
std::error_code put_in_place(const std::filesystem::path& staged,
                             const std::filesystem::path& place);

/// True for what is there and no file: a device, a pipe, a folder.
bool is_special(const std::filesystem::path& path);

/// The name under which this process writes a file before the file is put in its place.
std::filesystem::path staged_path(const std::filesystem::path& target);

/// Requires that `target` ends in `extension` (".svg"); an empty name passes. `reason`: "charts are
/// written as SVG". Throws Error(bad_input).
void require_extension(const std::filesystem::path& target, std::string_view extension,
                       const std::string& reason);

/// Proves that `target` can be written: makes a file of a block beside it and removes it. Throws
/// Error(bad_input) if that fails: before hours of work, not after them.
void check_target(const std::filesystem::path& target);

/// Writes a file by `write`, which is given the path to use and throws Error if it cannot.
void write_whole(const std::filesystem::path& target,
                 const std::function<void(const std::filesystem::path&)>& write);
void write_whole(const std::filesystem::path& target, std::string_view bytes);

}  // namespace lamplock
