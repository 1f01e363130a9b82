// The folder of the files that clients have sent, and nothing outside of it.
//
// In:  names and contents from clients. Out: paths of files in the folder.
// Who: the server.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::serve {

struct JobFile {
  std::string name;
  std::uint64_t bytes = 0;
  const char* kind = "";  ///< job, program, model, description
};

class JobFolder {
 public:
  /// Makes the folder, for this user alone. Throws Error(bad_input) if that fails.
  explicit JobFolder(const std::filesystem::path& folder);

  /// Letters, digits, and " ._-()+" inside; no folder, and no hidden file.
  static bool is_name(std::string_view name);

  const std::filesystem::path& path() const { return folder_; }
  /// Throws Error(bad_input) unless a client may use this name for a file.
  static void check_name(const std::string& name);

  /// Files for a machine, models and descriptions, by name.
  std::vector<JobFile> list() const;
  /// Writes a file, whole or not at all, and removes the progress of the job that it replaces.
  /// Throws Error(bad_input).
  void write(const std::string& name, std::string_view bytes) const;
  /// The path of a file that is there. Throws Error(bad_input).
  std::filesystem::path path_of(const std::string& name) const;
  /// Another text after each write of a file. Throws Error(bad_input).
  std::string revision_of(const std::string& name) const;
  /// Removes a file, and the progress of its job. Throws Error(bad_input).
  void remove(const std::string& name) const;

 private:
  std::filesystem::path folder_;
};

/// lamplock/jobs in XDG_DATA_HOME, or in ~/.local/share. Throws Error(bad_input) without a home.
std::filesystem::path default_job_folder();

}  // namespace lamplock::serve
