#include "host/model/ply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/mesh_checks.hpp"
#include "host/model/text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

[[noreturn]] void refuse_header(const path& file, std::size_t line, const std::string& what) {
  refuse(file, fmt::format("PLY header, line {}: {}", line, what), "export the file again");
}

std::optional<PlyType> type_named(std::string_view name) {
  struct Name {
    std::string_view name;
    PlyType type;
  };
  // The names of the original format and those with sizes that later programs write.
  constexpr std::array<Name, 16> names{{{"char", PlyType::int8},
                                        {"int8", PlyType::int8},
                                        {"uchar", PlyType::uint8},
                                        {"uint8", PlyType::uint8},
                                        {"short", PlyType::int16},
                                        {"int16", PlyType::int16},
                                        {"ushort", PlyType::uint16},
                                        {"uint16", PlyType::uint16},
                                        {"int", PlyType::int32},
                                        {"int32", PlyType::int32},
                                        {"uint", PlyType::uint32},
                                        {"uint32", PlyType::uint32},
                                        {"float", PlyType::float32},
                                        {"float32", PlyType::float32},
                                        {"double", PlyType::float64},
                                        {"float64", PlyType::float64}}};
  for (const Name& entry : names) {
    if (entry.name == name) return entry.type;
  }
  return std::nullopt;
}

std::optional<PlyFormat> format_named(std::string_view name) {
  if (name == "ascii") return PlyFormat::ascii;
  if (name == "binary_little_endian") return PlyFormat::little_endian;
  if (name == "binary_big_endian") return PlyFormat::big_endian;
  return std::nullopt;
}

/// The rest of a line that began with `property`.
std::optional<PlyProperty> parse_property(std::string_view rest) {
  PlyProperty property;
  std::string_view type = next_field(rest);
  if (type == "list") {
    property.list_count = type_named(next_field(rest));
    if (!property.list_count || *property.list_count >= PlyType::float32) return std::nullopt;
    type = next_field(rest);
  }
  const auto known = type_named(type);
  property.name = next_field(rest);
  if (!known || property.name.empty()) return std::nullopt;
  property.type = *known;
  return property;
}

/// The values after the header in order, in any format.
class Values {
 public:
  Values(std::string_view data, PlyFormat format)
      : rest_(data),
        ascii_(format == PlyFormat::ascii),
        order_(format == PlyFormat::big_endian ? std::endian::big : std::endian::little) {}

  /// Empty at the end of the data or of the line, or if the text is not a number.
  std::optional<double> next(PlyType type) {
    if (ascii_) return next_in_line();
    const std::size_t size = size_of(type);
    if (rest_.size() < size) return std::nullopt;
    const char* bytes = rest_.data();
    rest_.remove_prefix(size);
    switch (type) {
      case PlyType::int8:
        return load<std::int8_t>(bytes, order_);
      case PlyType::uint8:
        return load<std::uint8_t>(bytes, order_);
      case PlyType::int16:
        return load<std::int16_t>(bytes, order_);
      case PlyType::uint16:
        return load<std::uint16_t>(bytes, order_);
      case PlyType::int32:
        return load<std::int32_t>(bytes, order_);
      case PlyType::uint32:
        return load<std::uint32_t>(bytes, order_);
      case PlyType::float32:
        return load<float>(bytes, order_);
      case PlyType::float64:
        return load<double>(bytes, order_);
    }
    return std::nullopt;
  }

  /// Text: moves to the next line that is not blank. False if numbers are left in this one.
  bool end_element() {
    if (!ascii_) return true;
    skip_blanks();
    if (!rest_.empty() && rest_.front() != '\n') return false;
    const std::size_t next = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(std::min(next, rest_.size()));
    return true;
  }

 private:
  void skip_blanks() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r"), rest_.size()));
  }

  std::optional<double> next_in_line() {
    skip_blanks();
    if (rest_.empty() || rest_.front() == '\n') return std::nullopt;
    return to_double(next_field(rest_));
  }

  static std::size_t size_of(PlyType type) {
    switch (type) {
      case PlyType::int8:
      case PlyType::uint8:
        return 1;
      case PlyType::int16:
      case PlyType::uint16:
        return 2;
      case PlyType::int32:
      case PlyType::uint32:
      case PlyType::float32:
        return 4;
      case PlyType::float64:
        break;
    }
    return 8;
  }

  std::string_view rest_;
  bool ascii_;
  std::endian order_;
};

/// Reads all elements of one file.
class Reader {
 public:
  Reader(const path& file, std::string_view bytes, const PlyHeader& header)
      : file_(file),
        header_(header),
        values_(bytes.substr(header.data_offset), header.format),
        vertex_count_(header.count("vertex")) {}

  geometry::PointCloud read() {
    geometry::PointCloud vertices;
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        read_vertices(element, vertices);
      } else {
        read_others(element);
      }
    }
    return vertices;
  }

 private:
  double value(const PlyElement& element, std::size_t index, PlyType type) {
    const auto number = values_.next(type);
    if (!number) {
      refuse(file_,
             fmt::format("the header announces {} elements '{}', the data end or are unreadable in "
                         "number {}",
                         element.count, element.name, index),
             "the file is cut off or damaged: export it again");
    }
    return *number;
  }

  void end_element(const PlyElement& element, std::size_t index) {
    if (values_.end_element()) return;
    refuse(file_,
           fmt::format("element '{}' {} has more or fewer numbers in its line than announced",
                       element.name, index),
           "the file is damaged: export it again");
  }

  void read_vertices(const PlyElement& element, geometry::PointCloud& vertices) {
    std::array<std::size_t, 3> column{};
    constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto found =
          std::find_if(element.properties.begin(), element.properties.end(),
                       [&](const auto& p) { return p.name == names[axis] && !p.list_count; });
      if (found == element.properties.end()) {
        refuse(file_, fmt::format("its vertices have no property {}", names[axis]),
               "export points with x, y and z");
      }
      column[axis] = static_cast<std::size_t>(found - element.properties.begin());
    }
    std::vector<double> row(element.properties.size());
    vertices.reserve(element.count);  // no more than the file has bytes (read_ply_header)
    for (std::size_t i = 0; i < element.count; ++i) {
      for (std::size_t p = 0; p < row.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (property.list_count) {
          skip_list(element, i, property);
        } else {
          row[p] = value(element, i, property.type);
        }
      }
      end_element(element, i);
      const geometry::Point point{row[column[0]], row[column[1]], row[column[2]]};
      require_finite(file_, i, point);
      vertices.push_back(point);
    }
  }

  std::size_t list_size(const PlyElement& element, std::size_t index, const PlyProperty& list) {
    const double size = value(element, index, *list.list_count);
    if (!(size >= 0) || size != std::floor(size) || size > 4294967295.0) {
      refuse(file_,
             fmt::format("element '{}' {} has a list of {} entries", element.name, index, size),
             "export the file again");
    }
    return static_cast<std::size_t>(size);
  }

  void skip_list(const PlyElement& element, std::size_t index, const PlyProperty& list) {
    for (std::size_t n = list_size(element, index, list); n > 0; --n) {
      value(element, index, list.type);
    }
  }

  void read_others(const PlyElement& element) {
    for (std::size_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) {
        if (!property.list_count) {
          value(element, i, property.type);
        } else if (element.name == "face" &&
                   (property.name == "vertex_indices" || property.name == "vertex_index")) {
          check_face(element, i, property);
        } else {
          skip_list(element, i, property);
        }
      }
      end_element(element, i);
    }
  }

  void check_face(const PlyElement& element, std::size_t index, const PlyProperty& list) {
    const std::size_t corners = list_size(element, index, list);
    // The mesh library terminates the program at such a face.
    if (corners == 0)
      refuse(file_, fmt::format("face {} has no corners", index), "repair the model");
    for (std::size_t n = corners; n > 0; --n) {
      const double vertex = value(element, index, list.type);
      if (!(vertex >= 0) || vertex >= static_cast<double>(vertex_count_) ||
          vertex != std::floor(vertex)) {
        refuse(file_, fmt::format("face {} names vertex {} of {}", index, vertex, vertex_count_),
               "repair the model");
      }
    }
  }

  const path& file_;
  const PlyHeader& header_;
  Values values_;
  std::size_t vertex_count_;
};

}  // namespace

std::size_t PlyHeader::count(std::string_view name) const {
  for (const PlyElement& element : elements) {
    if (element.name == name) return element.count;
  }
  return 0;
}

PlyHeader read_ply_header(const path& file, std::string_view bytes) {
  PlyHeader header;
  bool has_format = false;
  Lines lines(bytes);
  const auto magic = lines.next();
  if (!magic || *magic != "ply") refuse_header(file, 1, "it does not begin with 'ply'");
  while (const auto line = lines.next()) {
    std::string_view rest = *line;
    const std::string_view keyword = next_field(rest);
    if (keyword == "format") {
      const auto format = format_named(next_field(rest));
      if (!format) refuse_header(file, lines.number(), "unknown format");
      header.format = *format;
      has_format = true;
    } else if (keyword == "element") {
      const std::string_view name = next_field(rest);
      const auto count = to_integer(next_field(rest));
      // An element takes a byte at least, so a greater count is damage and must not take memory.
      if (name.empty() || !count || *count < 0 || static_cast<std::size_t>(*count) > bytes.size()) {
        refuse_header(file, lines.number(), "an element without a valid count");
      }
      header.elements.push_back({std::string(name), static_cast<std::size_t>(*count), {}});
    } else if (keyword == "property") {
      const auto property = parse_property(rest);
      if (!property || header.elements.empty()) {
        refuse_header(file, lines.number(), "a property that cannot be read");
      }
      header.elements.back().properties.push_back(*property);
    } else if (keyword == "end_header") {
      if (!has_format) refuse_header(file, lines.number(), "no format");
      header.data_offset = static_cast<std::size_t>(line->data() - bytes.data()) + line->size();
      const std::size_t line_end = bytes.find('\n', header.data_offset);
      header.data_offset = line_end == std::string_view::npos ? bytes.size() : line_end + 1;
      return header;
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      refuse_header(file, lines.number(), fmt::format("unknown word '{:.20}'", keyword));
    }
  }
  refuse_header(file, lines.number(), "the file ends before end_header");
}

geometry::PointCloud read_ply_vertices(const path& file, std::string_view bytes,
                                       const PlyHeader& header) {
  return Reader(file, bytes, header).read();
}

}  // namespace lamplock::model
