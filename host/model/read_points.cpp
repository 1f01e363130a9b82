#include "host/model/read_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/file.hpp"
#include "host/model/ply.hpp"
#include "host/model/text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

[[noreturn]] void refuse_line(const path& file, std::size_t line, const std::string& what) {
  refuse(file, fmt::format("line {}: {}", line, what),
         "give a point a line: x y z in mm, # for comments");
}

points::Point parse_point(const path& file, std::size_t line, std::string_view text) {
  std::array<double, 3> coordinates{};
  std::size_t count = 0;
  for (std::string_view field = next_field(text); !field.empty(); field = next_field(text)) {
    const auto number = to_double(field);
    if (!number || !std::isfinite(*number)) {
      refuse_line(file, line, fmt::format("'{:.20}' is not a usable number", field));
    }
    if (count < coordinates.size()) coordinates[count] = *number;
    ++count;
  }
  if (count < coordinates.size()) {
    refuse_line(file, line, fmt::format("{} of 3 coordinates", count));
  }
  return {coordinates[0], coordinates[1], coordinates[2]};
}

points::PointCloud read_xyz(const path& file, std::string bytes) {
  std::replace(bytes.begin(), bytes.end(), ',', ' ');
  std::string_view text = bytes;
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  points::PointCloud cloud;
  Lines lines(text);
  while (const auto line = lines.next()) {
    const std::string_view content = line->substr(0, line->find('#'));
    std::string_view rest = content;
    if (next_field(rest).empty()) continue;
    cloud.push_back(parse_point(file, lines.number(), content));
  }
  return cloud;
}

points::PointCloud read_ply(const path& file, const std::string& bytes) {
  const PlyHeader header = read_ply_header(file, bytes);
  if (header.count("face") > 0) {
    refuse(file, "it has faces and is a mesh, not a point list", "use it as a mesh");
  }
  return read_ply_vertices(file, bytes, header);
}

}  // namespace

points::PointCloud read_point_list(const path& file) {
  std::string bytes = read_file(file);
  points::PointCloud cloud =
      lower_extension(file) == ".ply" ? read_ply(file, bytes) : read_xyz(file, std::move(bytes));
  if (cloud.empty()) refuse(file, "it has no points", "give at least one point");
  return cloud;
}

}  // namespace lamplock::model
