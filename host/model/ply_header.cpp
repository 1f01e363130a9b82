#include <fmt/format.h>

#include <array>

#include "host/file.hpp"
#include "host/model/ply.hpp"
#include "host/model/text.hpp"
#include "host/text.hpp"

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
      const bool has_lf = bytes.substr(0, header.data_offset).find('\n') != std::string_view::npos;
      const std::size_t line_end = bytes.find(has_lf ? '\n' : '\r', header.data_offset);
      header.data_offset = line_end == std::string_view::npos ? bytes.size() : line_end + 1;
      return header;
    } else if (keyword == "comment" && next_field(rest) == "TextureFile") {
      header.picture = trimmed(rest);
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      refuse_header(file, lines.number(), fmt::format("unknown word '{:.20}'", keyword));
    }
  }
  refuse_header(file, lines.number(), "the file ends before end_header");
}

}  // namespace lamplock::model
