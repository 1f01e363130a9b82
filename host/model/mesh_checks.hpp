// Errors that several mesh readers share. In: a part of a file. Out: an Error (bad_input) that
// names the file. Called by the STL, OBJ and PLY readers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string_view>

#include "host/geometry/point.hpp"

namespace lamplock::model {

/// Every coordinate must be a finite number; `index` counts the file's vertices from 0.
void require_finite(const std::filesystem::path& path, std::size_t index,
                    const geometry::Point& vertex);

/// Refuses a line of a text format, from 1.
[[noreturn]] void refuse_mesh_line(const std::filesystem::path& path, std::size_t line,
                                   std::string_view what);

/// Removes three numbers from the rest of a line. Throws Error (bad_input) with `what` unless it
/// begins with three; decimal commas are named.
geometry::Point take_point(const std::filesystem::path& path, std::size_t line,
                           std::string_view& text, std::string_view what);

}  // namespace lamplock::model
