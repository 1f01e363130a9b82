// A place in a text file, for errors. Comes in: file, text and an offset into it. Goes out: an
// Error that names file and line. Called by the readers of curves.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace lamplock::model {

/// Cheap to make; the line is counted when it is asked for.
struct Place {
  const std::filesystem::path& file;
  std::string_view text;
  std::size_t offset = 0;

  /// From 1.
  std::size_t line() const;
  /// Throws Error (bad_input).
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const;
};

}  // namespace lamplock::model
