#include "host/model/read_stl.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/letter_case.hpp"
#include "host/model/mesh_checks.hpp"
#include "host/model/text.hpp"
#include "host/number_text.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

// Binary STL: a header of 80 bytes, a 32-bit count, then 50 bytes a triangle: normal and three
// corners of three 32-bit floats and 16 bits of attributes, all little-endian.
constexpr std::size_t stl_count_offset = 80, stl_data_offset = 84, stl_triangle_bytes = 50,
                      stl_attribute_offset = 48;

/// The triangle count in a binary STL.
std::size_t stl_count(std::string_view bytes) {
  return load<std::uint32_t>(bytes.data() + stl_count_offset);
}

/// Colours of facets, five bits each, which two programs write into the attributes. VisCAM marks
/// them by the highest bit and has blue in the lowest bits; Materialise Magics names a colour in
/// the header, marks facets of this colour by the highest bit and has red in the lowest bits.
std::optional<float> stl_light(std::uint16_t attribute, bool is_magics) {
  constexpr std::uint16_t mark = 0x8000, mask = 0x1F;
  if (((attribute & mark) != 0) == is_magics) return std::nullopt;
  const double low = (attribute & mask) / 31.0, green = (attribute >> 5 & mask) / 31.0,
               high = (attribute >> 10 & mask) / 31.0;
  return is_magics ? luma(low, green, high) : luma(high, green, low);
}

void read_binary_stl(const path& file, std::string_view bytes, MeshBuilder& mesh) {
  if (bytes.size() < stl_data_offset) {
    refuse(file,
           fmt::format("{} too few for an STL", count_text(bytes.size(), "byte is", "bytes are")),
           "the file is cut off or not an STL: export it again");
  }
  const std::size_t count = stl_count(bytes);
  const std::size_t present = (bytes.size() - stl_data_offset) / stl_triangle_bytes;
  if (present < count) {
    refuse(file,
           fmt::format("{} announced, {} in the file", count_text(count, "triangle"),
                       grouped(present)),
           "the file is cut off or not an STL: export it again");
  }
  const std::string_view header = bytes.substr(0, stl_count_offset);
  const bool is_magics = header.find("COLOR=") != std::string_view::npos;
  for (std::size_t i = 0; i < count; ++i) {
    const char* at = bytes.data() + stl_data_offset + i * stl_triangle_bytes;
    MeshTriangle triangle;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const char* here = at + 12 * (corner + 1);  // 12 bytes: the normal, then each corner
      const geometry::Point point{load<float>(here), load<float>(here + 4), load<float>(here + 8)};
      require_finite(file, 3 * i + corner, point);
      mesh.stored_in_single(point, 1);
      triangle.corners[corner] = point;
    }
    if (const auto light = stl_light(load<std::uint16_t>(at + stl_attribute_offset), is_magics))
      triangle.lights = {*light, *light, *light};
    mesh.add(triangle);
  }
}

/// Reads the words of an ASCII STL. Only mandatory words are required.
class AsciiStl {
 public:
  AsciiStl(const path& file, MeshBuilder& mesh) : file_(file), mesh_(mesh) {}

  /// Usually a line has one statement; some programs write a file into one line.
  void line(std::size_t number, std::string_view text) {
    number_ = number;
    in_name_ = false;
    for (auto word = next_field(text); !word.empty(); word = next_field(text))
      statement(in_lower_case(word), text);
  }

  void end() { require(!in_solid_, "the file ends before endsolid"); }

 private:
  void statement(const std::string& word, std::string_view& rest) {
    // A name may have any words; a normal follows from the corners.
    if (in_name_ && word != "facet" && word != "endsolid" && word != "outer" && word != "vertex")
      return;
    in_name_ = false;
    if (word == "solid") {
      require(!in_solid_, "a solid inside a solid");
      in_solid_ = in_name_ = true;
    } else if (word == "facet") {
      require(in_solid_ && !in_facet_, "a facet that does not follow a finished one");
      in_facet_ = in_name_ = true;
      corners_ = 0;
    } else if (word == "vertex") {
      vertex(rest);
    } else if (word == "endfacet") {
      require(in_facet_ && corners_ == 3, "a facet without three corners");
      in_facet_ = false;
      mesh_.add(triangle_);
    } else if (word == "endsolid") {
      require(in_solid_ && !in_facet_, "an endsolid at the wrong place");
      in_solid_ = false;
      in_name_ = true;
    } else {
      require(word == "outer" || word == "loop" || word == "endloop",
              fmt::format("unknown word '{:.20}'", word));
    }
  }

  void vertex(std::string_view& text) {
    require(in_facet_ && corners_ < 3, "a vertex outside a facet");
    const geometry::Point point =
        take_point(file_, number_, text, "a vertex without three numbers");
    require_finite(file_, vertices_++, point);
    triangle_.corners[corners_++] = point;
  }

  void require(bool condition, std::string_view what) const {
    if (!condition) refuse_mesh_line(file_, number_, what);
  }

  const path& file_;
  MeshBuilder& mesh_;
  MeshTriangle triangle_;
  bool in_solid_ = false, in_facet_ = false;
  bool in_name_ = false;  // words up to the end of the line or the next statement have no meaning
  std::size_t corners_ = 0, number_ = 0, vertices_ = 0;
};

}  // namespace

void read_stl(const path& file, std::string_view bytes, MeshBuilder& mesh) {
  // Binary files may begin with "solid" too: then the count decides.
  const bool counted = bytes.size() >= stl_data_offset &&
                       bytes.size() == stl_data_offset + stl_triangle_bytes * stl_count(bytes);
  std::string_view start = without_byte_order_mark(bytes);
  const bool text =
      in_lower_case(next_field(start)) == "solid" && bytes.find('\0') == std::string_view::npos;
  if (counted || !text) return read_binary_stl(file, bytes, mesh);
  AsciiStl reader(file, mesh);
  Lines lines(bytes);
  while (const auto line = lines.next()) reader.line(lines.number(), *line);
  reader.end();
}

}  // namespace lamplock::model
