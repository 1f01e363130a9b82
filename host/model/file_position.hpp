// A position in a text file, for errors. In: file, text and an offset into it. Out: an Error that
// names file and line. Called by the readers of curves.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace lamplock::model {

/// Cheap to construct; lines are counted only on request.
struct FilePosition {
  const std::filesystem::path& file;
  std::string_view text;
  std::size_t offset = 0;
  /// The text was made of a binary DXF, two lines of each group: errors count groups.
  bool counts_groups = false;

  /// From 1.
  std::size_t line() const;
  /// Throws Error (bad_input).
  [[noreturn]] void refuse(const std::string& what, const std::string& remedy) const;
};

}  // namespace lamplock::model
