#include "host/model/mesh_checks.hpp"

#include <fmt/format.h>

#include "host/file.hpp"
#include "host/model/text.hpp"

namespace lamplock::model {

using std::filesystem::path;

void require_finite(const path& file, std::size_t index, const geometry::Point& vertex) {
  if (geometry::is_finite(vertex)) return;
  refuse(file, fmt::format("vertex {} is ({}, {}, {})", index, vertex.x, vertex.y, vertex.z),
         "repair the model");
}

void refuse_mesh_line(const path& file, std::size_t line, std::string_view what) {
  refuse(file, fmt::format("line {}: {}", line, what),
         "the file is cut off or damaged: export it again");
}

std::optional<geometry::Point> take_point(std::string_view& text) {
  const auto x = to_double(next_field(text)), y = to_double(next_field(text)),
             z = to_double(next_field(text));
  if (!x || !y || !z) return std::nullopt;
  return geometry::Point{*x, *y, *z};
}

}  // namespace lamplock::model
