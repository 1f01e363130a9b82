#include "host/model/mesh_checks.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <optional>
#include <string>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

// Binary STL: a header of 80 bytes, a 32-bit count, then 50 bytes a triangle: normal and three
// corners of three 32-bit floats and 16 bits of attributes, all little-endian.
constexpr std::size_t stl_count_offset = 80, stl_data_offset = 84, stl_triangle_bytes = 50;

/// The triangle count in a binary STL.
std::size_t stl_count(std::string_view bytes) {
  return load<std::uint32_t>(bytes.data() + stl_count_offset);
}

[[noreturn]] void refuse_line(const path& file, std::size_t line, std::string_view what) {
  refuse(file, fmt::format("line {}: {}", line, what),
         "the file is cut off or damaged: export it again");
}

std::size_t check_binary_stl(const path& file, std::string_view bytes) {
  if (bytes.size() < stl_data_offset) {
    refuse(file, fmt::format("{} bytes are too few for an STL", bytes.size()),
           "the file is cut off or not an STL: export it again");
  }
  const std::size_t count = stl_count(bytes);
  const std::size_t present = (bytes.size() - stl_data_offset) / stl_triangle_bytes;
  if (present < count) {
    refuse(file, fmt::format("{} triangles announced, {} in the file", count, present),
           "the file is cut off or not an STL: export it again");
  }
  for (std::size_t corner = 0; corner < 3 * count; ++corner) {
    // 12 bytes: the normal, then each corner.
    const char* at =
        bytes.data() + stl_data_offset + corner / 3 * stl_triangle_bytes + 12 + corner % 3 * 12;
    require_finite(file, corner, {load<float>(at), load<float>(at + 4), load<float>(at + 8)});
  }
  return stl_data_offset + count * stl_triangle_bytes;
}

std::optional<geometry::Point> read_vertex(std::string_view text) {
  const auto x = to_double(next_field(text)), y = to_double(next_field(text)),
             z = to_double(next_field(text));
  if (!x || !y || !z) return std::nullopt;
  return geometry::Point{*x, *y, *z};
}

/// Checks the words of an ASCII STL. Only mandatory words are required.
class AsciiStl {
 public:
  explicit AsciiStl(const path& file) : file_(file) {}

  void line(std::size_t number, std::string_view text) {
    number_ = number;
    const std::string_view word = next_field(text);
    if (word == "solid") {
      require(!in_solid_, "a solid inside a solid");
      in_solid_ = true;
    } else if (word == "facet") {
      require(in_solid_ && !in_facet_, "a facet that does not follow a finished one");
      in_facet_ = true;
      corners_ = 0;
    } else if (word == "vertex") {
      require(in_facet_ && ++corners_ <= 3, "a vertex outside a facet");
      const auto vertex = read_vertex(text);
      require(vertex.has_value(), "a vertex without three numbers");
      require_finite(file_, vertices_++, *vertex);
    } else if (word == "endfacet") {
      require(in_facet_ && corners_ == 3, "a facet without three corners");
      in_facet_ = false;
    } else if (word == "endsolid") {
      require(in_solid_ && !in_facet_, "an endsolid at the wrong place");
      in_solid_ = false;
    } else {
      require(word.empty() || word == "outer" || word == "endloop",
              fmt::format("unknown word '{:.20}'", word));
    }
  }

  void end() { require(!in_solid_, "the file ends before endsolid"); }

 private:
  void require(bool condition, std::string_view what) const {
    if (!condition) refuse_line(file_, number_, what);
  }

  const path& file_;
  bool in_solid_ = false, in_facet_ = false;
  int corners_ = 0;
  std::size_t number_ = 0, vertices_ = 0;
};

/// Checks the lines of an OBJ in order; negative indices count back from the last vertex.
class Obj {
 public:
  explicit Obj(const path& file) : file_(file) {}

  void line(std::size_t number, std::string_view text) {
    number_ = number;
    const std::string_view word = next_field(text);
    if (word == "v") {
      const auto vertex = read_vertex(text);
      if (!vertex) damaged(fmt::format("vertex {} without three numbers", vertices_));
      require_finite(file_, vertices_++, *vertex);
    } else if (word == "f") {
      face(text);
    }
  }

  void end() {
    number_ = max_line_;
    if (highest_ > vertices_)
      damaged(fmt::format("a face names vertex {} of {}", highest_, vertices_));
  }

 private:
  void face(std::string_view text) {
    int corners = 0;
    for (std::string_view field = next_field(text); !field.empty() && field.front() != '#';
         field = next_field(text)) {
      const auto index = to_integer(field.substr(0, field.find('/')));
      if (!index || *index == 0 || *index < -static_cast<long long>(vertices_)) {
        damaged(fmt::format("'{:.20}' is not a vertex from 1 to {}", field, vertices_));
      }
      if (*index > 0 && static_cast<std::size_t>(*index) > highest_) {
        highest_ = static_cast<std::size_t>(*index);
        max_line_ = number_;
      }
      ++corners;
    }
    if (corners < 3) damaged(fmt::format("a face of {} corners", corners));
  }

  [[noreturn]] void damaged(std::string_view what) const { refuse_line(file_, number_, what); }

  const path& file_;
  std::size_t number_ = 0, vertices_ = 0, highest_ = 0, max_line_ = 0;
};

}  // namespace

void require_finite(const path& file, std::size_t index, const geometry::Point& vertex) {
  if (geometry::is_finite(vertex)) return;
  refuse(file, fmt::format("vertex {} is ({}, {}, {})", index, vertex.x, vertex.y, vertex.z),
         "repair the model");
}

std::size_t check_stl(const path& file, std::string_view bytes) {
  // Binary files may begin with "solid" too: then the count decides, as in the mesh library.
  const bool counted = bytes.size() >= stl_data_offset &&
                       bytes.size() == stl_data_offset + stl_triangle_bytes * stl_count(bytes);
  const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
  const bool text = begin != std::string_view::npos && bytes.substr(begin).starts_with("solid") &&
                    bytes.find('\0') == std::string_view::npos;
  if (counted || !text) return check_binary_stl(file, bytes);
  AsciiStl checker(file);
  Lines lines(bytes);
  while (const auto line = lines.next()) checker.line(lines.number(), *line);
  checker.end();
  return bytes.size();
}

void check_obj(const path& file, std::string_view bytes) {
  Obj checker(file);
  Lines lines(bytes);
  std::string joined;  // a backslash at the end of a line continues it on the next
  while (const auto line = lines.next()) {
    if (line->ends_with('\\')) {
      joined.append(line->substr(0, line->size() - 1)).append(" ");
      continue;
    }
    checker.line(lines.number(), joined.empty() ? *line : joined.append(*line));
    joined.clear();
  }
  checker.line(lines.number(), joined);
  checker.end();
}

}  // namespace lamplock::model
