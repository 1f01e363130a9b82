// The log of a server: lines with the time, in files of limited size.
//
// In:  lines. Out: FILE, and the parts before it as FILE.1 (newest) to FILE.3. Who: serve().
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace lamplock::serve {

class LogFile {
 public:
  static constexpr std::size_t default_bytes = 1024 * 1024;
  static constexpr int old_files = 3;

  /// Appends to the file. Throws Error(bad_input) if that is not possible.
  explicit LogFile(std::filesystem::path file, std::size_t max_bytes = default_bytes);

  /// Adds a line; control characters are replaced. Does not throw: false if the line could not be
  /// written, because the disk is full for example. A later line is tried again.
  bool add(std::string_view line) noexcept;

 private:
  void open();
  void rotate();

  std::filesystem::path file_;
  std::size_t max_bytes_, bytes_ = 0;
  std::ofstream stream_;
};

}  // namespace lamplock::serve
