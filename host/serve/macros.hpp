// Named lines for the console, kept by the server.
//
// In:  names and lines from clients. Out: the lines of a name; a file in the folder of jobs.
// Who: the server.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lamplock::serve {

class Macros {
 public:
  static constexpr std::size_t max_macros = 50, max_lines = 50;

  /// The file is read when it is needed, and written with each change.
  explicit Macros(std::filesystem::path file) : file_(std::move(file)) {}

  /// Lines by name, separated by line feeds. Throws Error(bad_input): the file is damaged.
  std::map<std::string, std::string> all() const;
  /// The lines to send. Throws Error(bad_input): there is no such macro.
  std::vector<std::string> lines_of(const std::string& name) const;
  /// Adds or replaces a macro. Throws Error(bad_input): a line that cannot be sent, too many.
  void set(const std::string& name, const std::string& lines) const;
  /// Throws Error(bad_input): there is no such macro.
  void remove(const std::string& name) const;

 private:
  void write(const std::map<std::string, std::string>& macros) const;

  std::filesystem::path file_;
};

}  // namespace lamplock::serve
