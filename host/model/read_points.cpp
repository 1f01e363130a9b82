#include "host/model/read_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/file.hpp"
#include "host/letter_case.hpp"
#include "host/model/ply.hpp"
#include "host/model/read_dxf.hpp"
#include "host/model/text.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

[[noreturn]] void refuse_line(const path& file, std::size_t line, const std::string& what) {
  refuse(file, fmt::format("line {}: {}", line, what),
         "write one point per line: x y z in mm, # for comments");
}

[[noreturn]] void refuse_decimal_comma(const path& file, std::size_t line) {
  refuse(file, fmt::format("line {}: has decimal commas", line), write_decimal_points);
}

/// Which fields of a line are the coordinates, and what separates fields.
struct Columns {
  std::array<std::size_t, 3> of_axis{0, 1, 2};
  char separator = ' ';   ///< ' ' means blanks and commas, otherwise the only separator
  std::size_t count = 3;  ///< of a line; a line of names may be longer than the lines of points
  bool has_names = false;

  std::size_t min_count() const {
    return has_names ? std::max({of_axis[0], of_axis[1], of_axis[2]}) + 1 : count;
  }
};

/// A row of `.cad`: flag, layer, X, Y, Z.
constexpr Columns cad_columns{{2, 3, 4}, ' ', 5};

std::vector<std::string_view> fields_of(std::string_view text, char separator) {
  std::vector<std::string_view> fields;
  if (separator == ' ') {
    for (auto field = next_field(text); !field.empty(); field = next_field(text)) {
      fields.push_back(field);
    }
    return fields;
  }
  while (true) {
    const std::size_t end = text.find(separator);
    fields.push_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end + 1);
  }
}

/// Some programs write numbers as texts: "0.5" is 0.5.
std::string_view without_quotes(std::string_view field) {
  const bool is_quoted = field.size() >= 2 && field.front() == '"' && field.back() == '"';
  return is_quoted ? trimmed(field.substr(1, field.size() - 2)) : field;
}

/// "X", "x_mm" and "\"x\"" are x.
std::string axis_name(std::string_view field) {
  std::string name;
  for (const char letter : field) {
    if (letter == '"') continue;
    name += lower_case(letter);
  }
  return name.ends_with("_mm") ? name.substr(0, name.size() - 3) : name;
}

/// The columns by a line of names.
Columns named_columns(const path& file, std::size_t line, std::string_view names) {
  constexpr std::array<std::string_view, 3> axes{"x", "y", "z"};
  Columns columns;
  columns.has_names = true;
  for (const char separator : {',', ';'}) {
    if (names.find(separator) != std::string_view::npos) columns.separator = separator;
  }
  const std::vector<std::string_view> fields = fields_of(names, columns.separator);
  columns.count = fields.size();
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    const auto is_axis = [&](std::string_view field) { return axis_name(field) == axes[axis]; };
    const auto found = std::find_if(fields.begin(), fields.end(), is_axis);
    if (found == fields.end())
      refuse_line(file, line, fmt::format("the names of columns lack '{}'", axes[axis]));
    if (std::count_if(fields.begin(), fields.end(), is_axis) > 1)
      refuse_line(file, line, fmt::format("more than one column is named '{}'", axes[axis]));
    columns.of_axis[axis] = static_cast<std::size_t>(found - fields.begin());
  }
  return columns;
}

/// True if blanks alone separate two fields.
bool has_blank_separator(std::string_view text) {
  char before = ',';
  bool blank = false;
  for (const char letter : trimmed(text)) {
    const bool is_blank = letter == ' ' || letter == '\t' || letter == '\r';
    if (!is_blank && blank && before != ',' && letter != ',') return true;
    blank = is_blank;
    if (!is_blank) before = letter;
  }
  return false;
}

void check_count(const path& file, std::size_t line, std::span<const std::string_view> fields,
                 const Columns& columns) {
  const std::size_t min_count = columns.min_count();
  if (fields.size() < min_count) {
    refuse_line(file, line,
                columns.count == 3 && !columns.has_names
                    ? fmt::format("has {} of 3 coordinates", fields.size())
                    : fmt::format("has {} of {} columns", fields.size(), min_count));
  }
  // A separator at the end of a line makes an empty field.
  while (!fields.empty() && fields.back().empty()) fields = fields.first(fields.size() - 1);
  if (fields.size() <= columns.count) return;
  if (columns.has_names)
    refuse_line(file, line,
                fmt::format("has {} columns, and names for {}", fields.size(), columns.count));
  if (columns.count != 3)
    refuse_line(file, line, fmt::format("has {} of {} columns", fields.size(), columns.count));
  refuse(file, fmt::format("line {}: has {} numbers, and 3 are a point", line, fields.size()),
         "begin the file with a line of names, as: x y z red green blue");
}

geometry::Point parse_point(const path& file, std::size_t line, std::string_view text,
                            const Columns& columns) {
  const std::vector<std::string_view> fields = fields_of(text, columns.separator);
  std::array<double, 3> coordinates{};
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const auto axis = std::find(columns.of_axis.begin(), columns.of_axis.end(), i);
    if (axis == columns.of_axis.end() && columns.has_names) continue;
    const auto number = to_double(without_quotes(fields[i]));
    if (!number && has_decimal_comma(fields[i])) refuse_decimal_comma(file, line);
    if (!number || !std::isfinite(*number)) {
      refuse_line(file, line, fmt::format("'{:.20}' is not a usable number", fields[i]));
    }
    if (axis != columns.of_axis.end())
      coordinates[static_cast<std::size_t>(axis - columns.of_axis.begin())] = *number;
  }
  check_count(file, line, fields, columns);
  return {coordinates[0], coordinates[1], coordinates[2]};
}

/// True if a line has names of columns: words, not numbers.
bool is_names(std::string_view content) {
  const std::size_t first = content.find_first_not_of(" \t\",;");
  if (first == std::string_view::npos) return false;
  const char letter = content[first];
  std::string_view rest = content.substr(first);
  const bool is_letter = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
  return is_letter && !to_double(next_field(rest));  // nan is a number
}

/// The line without its comment.
std::string_view content_of(std::string_view line) { return line.substr(0, line.find('#')); }

/// True if a line of points or names has a semicolon: then a comma is no separator.
bool has_semicolons(std::string_view text) {
  Lines lines(text);
  while (const auto line = lines.next())
    if (content_of(*line).find(';') != std::string_view::npos) return true;
  return false;
}

geometry::PointCloud read_text(const path& file, const std::string& bytes, Columns columns) {
  const std::string_view text = bytes;
  const bool semicolons = has_semicolons(without_byte_order_mark(text));
  std::string spaced = bytes;
  std::replace(spaced.begin(), spaced.end(), semicolons ? ';' : ',', ' ');
  geometry::PointCloud cloud;
  Lines lines(without_byte_order_mark(text));
  bool names_may_follow = columns.count == 3;
  while (const auto line = lines.next()) {
    std::string_view content = content_of(*line);
    if (names_may_follow && is_names(content)) {
      columns = named_columns(file, lines.number(), content);
      names_may_follow = false;
      continue;
    }
    if (columns.separator == ' ') {
      // "1,5 2,5 3,5": a comma that separates would be with or instead of the blanks.
      if (!semicolons && has_decimal_comma(content) && has_blank_separator(content))
        refuse_decimal_comma(file, lines.number());
      content = std::string_view(spaced).substr(
          static_cast<std::size_t>(content.data() - text.data()), content.size());
    }
    std::string_view rest = content;
    if (next_field(rest).empty()) continue;
    names_may_follow = false;
    cloud.push_back(parse_point(file, lines.number(), content, columns));
  }
  return cloud;
}

void require_points(const path& file, const geometry::PointCloud& cloud) {
  if (cloud.empty()) refuse(file, "it has no points", "give at least one point");
}

geometry::PointCloud read_ply(const path& file, const std::string& bytes) {
  const PlyHeader header = read_ply_header(file, bytes);
  if (header.has_surface()) {
    refuse(file, "it has faces and is a mesh, not a point list", "use it as a mesh");
  }
  return read_ply_vertices(file, bytes, header);
}

}  // namespace

geometry::PointCloud read_point_list(const path& file) {
  if (lower_extension(file) == ".dxf") return points_of_drawing(file, read_dxf(file));
  return decode_point_list(file, read_text_file(file));
}

geometry::PointCloud decode_point_list(const path& file, const std::string& bytes) {
  const std::string extension = lower_extension(file);
  geometry::PointCloud cloud = extension == ".ply"   ? read_ply(file, bytes)
                               : extension == ".cad" ? read_text(file, bytes, cad_columns)
                                                     : read_text(file, bytes, {});
  require_points(file, cloud);
  return cloud;
}

geometry::PointCloud points_of_drawing(const path& file, Curves drawing) {
  if (!drawing.paths.empty()) refuse(file, "it has curves besides points", "use it as a drawing");
  if (!drawing.left_out.empty())
    refuse(file, fmt::format("it has other entities besides points: {}", left_out_text(drawing)),
           "export the points alone");
  require_points(file, drawing.points);
  return std::move(drawing.points);
}

}  // namespace lamplock::model
