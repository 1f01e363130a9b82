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

geometry::Point take_point(const path& file, std::size_t line, std::string_view& text,
                           std::string_view what) {
  const std::string_view whole = text;
  const auto x = to_double(next_field(text)), y = to_double(next_field(text)),
             z = to_double(next_field(text));
  if (x && y && z) return {*x, *y, *z};
  if (has_decimal_comma(whole))
    refuse(file, fmt::format("line {}: has decimal commas", line), write_decimal_points);
  refuse_mesh_line(file, line, what);
}

}  // namespace lamplock::model
