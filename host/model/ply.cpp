#include "host/model/ply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <utility>

#include "host/file.hpp"
#include "host/model/mesh_checks.hpp"
#include "host/model/ply_values.hpp"
#include "host/model/polygon_triangles.hpp"
#include "host/model/read_bitmap.hpp"
#include "host/number_text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// What the elements of a file describe.
struct PlyContent {
  geometry::PointCloud vertices;
  std::vector<float> lights;         // of vertices, or empty
  std::vector<TexturePlace> places;  // of vertices, or empty
  struct Face {
    std::size_t end = 0;  // of its corners
    std::optional<float> light{};
  };
  std::vector<Face> faces;
  std::vector<std::uint32_t> corners;
  std::vector<TexturePlace> corner_places;  // of corners, or shorter
};

/// The column of a property that is not a list, by one of its names.
std::optional<std::size_t> column_of(const PlyElement& element,
                                     std::initializer_list<std::string_view> names) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.list_count && std::ranges::find(names, property.name) != names.end()) return i;
  }
  return std::nullopt;
}

/// The value of a colour of full brightness.
double full_value(PlyType type) {
  switch (type) {
    case PlyType::int8:
      return 127;
    case PlyType::uint8:
      return 255;
    case PlyType::int16:
      return 32767;
    case PlyType::uint16:
      return 65535;
    case PlyType::int32:
      return 2147483647.0;
    case PlyType::uint32:
      return 4294967295.0;
    case PlyType::float32:
    case PlyType::float64:
      break;
  }
  return 1;
}

/// The columns of the colour of an element.
class PlyColour {
 public:
  explicit PlyColour(const PlyElement& element)
      : element_(element),
        red_(column_of(element, {"red", "r", "diffuse_red"})),
        green_(column_of(element, {"green", "g", "diffuse_green"})),
        blue_(column_of(element, {"blue", "b", "diffuse_blue"})) {}

  bool is_there() const { return red_ && green_ && blue_; }

  float light(const std::vector<double>& row) const {
    const auto share = [&](std::size_t column) {
      return row[column] / full_value(element_.properties[column].type);
    };
    return luma(share(*red_), share(*green_), share(*blue_));
  }

 private:
  const PlyElement& element_;
  std::optional<std::size_t> red_, green_, blue_;
};

bool has_single_coordinates(const PlyHeader& header) {
  for (const PlyElement& element : header.elements)
    if (const auto x = column_of(element, {"x"}); element.name == "vertex" && x)
      return element.properties[*x].type == PlyType::float32;
  return false;
}

/// Vertices joined by edges are neither a mesh nor a list of points.
void require_more_than_edges(const path& file, const PlyHeader& header) {
  const std::size_t edges = header.count("edge");
  if (edges > 0 && !header.has_surface())
    refuse(file, fmt::format("it has {} edges and no faces", edges),
           "export it with faces, or its vertices alone as a list of points");
}

/// Reads all elements of one file.
class Reader {
 public:
  Reader(const path& file, std::string_view bytes, const PlyHeader& header)
      : file_(file),
        header_(header),
        values_(bytes.substr(header.data_offset), header.format),
        vertex_count_(header.count("vertex")) {}

  PlyContent read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        read_vertices(element);
      } else {
        read_others(element);
      }
    }
    return std::move(content_);
  }

 private:
  double value(const PlyElement& element, std::size_t index, PlyType type) {
    const auto number = values_.next(type);
    if (!number) {
      if (values_.failed_at_comma())
        refuse(file_, fmt::format("element '{}' {} has decimal commas", element.name, index),
               write_decimal_points);
      refuse(
          file_,
          fmt::format("the header announces {} '{}', the data end or are unreadable in number {}",
                      count_text(element.count, "element"), element.name, index),
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

  std::size_t coordinate(const PlyElement& element, std::string_view name) const {
    const auto column = column_of(element, {name});
    if (!column)
      refuse(file_, fmt::format("its vertices have no property {}", name),
             "export points with x, y and z");
    return *column;
  }

  void read_vertices(const PlyElement& element) {
    const std::size_t x = coordinate(element, "x"), y = coordinate(element, "y"),
                      z = coordinate(element, "z");
    const PlyColour colour(element);
    const auto u = column_of(element, {"u", "s", "texture_u"}),
               v = column_of(element, {"v", "t", "texture_v"});
    std::vector<double> row(element.properties.size());
    content_.vertices.reserve(element.count);  // no more than the file has bytes (read_ply_header)
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
      const geometry::Point point{row[x], row[y], row[z]};
      require_finite(file_, i, point);
      content_.vertices.push_back(point);
      if (colour.is_there()) content_.lights.push_back(colour.light(row));
      if (u && v)
        content_.places.push_back({static_cast<float>(row[*u]), static_cast<float>(row[*v])});
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
    const bool is_face = element.name == "face", is_strip = element.name == ply_strips;
    const PlyColour colour(element);
    std::vector<double> row(element.properties.size());
    for (std::size_t i = 0; i < element.count; ++i) {
      const std::size_t before = content_.corners.size();
      for (std::size_t p = 0; p < row.size(); ++p) {
        const PlyProperty& property = element.properties[p];
        if (!property.list_count) {
          row[p] = value(element, i, property.type);
        } else if (is_face && has_corners(property)) {
          read_corners(element, i, property);
        } else if (is_strip && has_corners(property)) {
          read_strips(element, i, property);
        } else if (is_face && property.name == "texcoord") {
          read_places(element, i, property, before);
        } else {
          skip_list(element, i, property);
        }
      }
      end_element(element, i);
      if (!is_face) continue;
      content_.faces.push_back({content_.corners.size(), std::nullopt});
      if (colour.is_there()) content_.faces.back().light = colour.light(row);
    }
  }

  static bool has_corners(const PlyProperty& property) {
    return property.name == "vertex_indices" || property.name == "vertex_index";
  }

  std::uint32_t vertex_of(const PlyElement& element, std::size_t index, double vertex) const {
    if (!(vertex >= 0) || vertex >= static_cast<double>(vertex_count_) ||
        vertex != std::floor(vertex)) {
      refuse(file_,
             fmt::format("{} {} names vertex {} of {}", element.name, index, vertex, vertex_count_),
             "repair the model");
    }
    return static_cast<std::uint32_t>(vertex);
  }

  /// Strips of triangles: each corner after the first two forms a triangle with its two
  /// predecessors, of which every other one is turned. -1 begins a new strip.
  void read_strips(const PlyElement& element, std::size_t index, const PlyProperty& list) {
    std::array<std::uint32_t, 2> last{};
    std::size_t length = 0;
    for (std::size_t n = list_size(element, index, list); n > 0; --n) {
      const double number = value(element, index, list.type);
      if (number == -1) {
        length = 0;
        continue;
      }
      const std::uint32_t corner = vertex_of(element, index, number);
      if (length >= 2) {
        const std::size_t first = length % 2;
        content_.corners.insert(content_.corners.end(), {last[first], last[1 - first], corner});
        content_.faces.push_back({content_.corners.size(), std::nullopt});
      }
      last = {last[1], corner};
      ++length;
    }
  }

  void read_corners(const PlyElement& element, std::size_t index, const PlyProperty& list) {
    const std::size_t corners = list_size(element, index, list);
    if (corners == 0)
      refuse(file_, fmt::format("face {} has no corners", index), "repair the model");
    for (std::size_t n = corners; n > 0; --n)
      content_.corners.push_back(vertex_of(element, index, value(element, index, list.type)));
  }

  /// Two numbers for each corner of the face, whose corners begin at `first`. MeshLab writes them
  /// after the corners; faces without pictures have an empty list.
  void read_places(const PlyElement& element, std::size_t index, const PlyProperty& list,
                   std::size_t first) {
    std::vector<TexturePlace>& places = content_.corner_places;
    places.resize(first);
    const std::size_t size = list_size(element, index, list);
    for (std::size_t n = 0; n < size; ++n) {
      const auto number = static_cast<float>(value(element, index, list.type));
      if (n % 2 == 0) places.push_back({number, 0});
      if (n % 2 == 1) places.back().v = number;
    }
    places.resize(std::min(places.size(), std::max(first, content_.corners.size())));
  }

  const path& file_;
  const PlyHeader& header_;
  PlyValues values_;
  std::size_t vertex_count_;
  PlyContent content_;
};

/// Adds the faces to a mesh.
class PlyFaces {
 public:
  PlyFaces(const path& file, const PlyHeader& header, const PlyContent& content, MeshBuilder& mesh)
      : file_(file), content_(content), mesh_(mesh) {
    if (!header.picture.empty() && (!content.places.empty() || !content.corner_places.empty()))
      texture_ = mesh.texture(header.picture,
                              [&] { return read_bitmap(file.parent_path() / header.picture); });
  }

  void add_all() {
    std::size_t begin = 0;
    for (std::size_t i = 0; i < content_.faces.size(); ++i) {
      add(i, begin);
      begin = content_.faces[i].end;
    }
  }

 private:
  void add(std::size_t index, std::size_t begin) {
    const PlyContent::Face& face = content_.faces[index];
    polygon_.clear();
    for (std::size_t i = begin; i < face.end; ++i)
      polygon_.push_back(content_.vertices[content_.corners[i]]);
    if (polygon_.size() < 3) return;  // a point or a line
    const auto triangles = triangles_of(polygon_);
    if (triangles.empty())
      refuse(file_, fmt::format("face {} is concave and has {} corners", index, polygon_.size()),
             "split the faces into triangles before the export");
    for (const auto& indices : triangles) {
      MeshTriangle triangle;
      triangle.textured.texture = texture_;
      if (face.light || !content_.lights.empty()) triangle.lights = {1, 1, 1};
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t corner = begin + indices[i];
        const std::uint32_t vertex = content_.corners[corner];
        triangle.corners[i] = polygon_[indices[i]];
        // Programs that write both write the same colour twice.
        if (face.light) {
          (*triangle.lights)[i] = *face.light;
        } else if (!content_.lights.empty()) {
          (*triangle.lights)[i] = content_.lights[vertex];
        }
        if (corner < content_.corner_places.size()) {
          triangle.textured.corners[i] = content_.corner_places[corner];
        } else if (vertex < content_.places.size()) {
          triangle.textured.corners[i] = content_.places[vertex];
        }
      }
      mesh_.add(triangle);
    }
  }

  const path& file_;
  const PlyContent& content_;
  MeshBuilder& mesh_;
  std::uint32_t texture_ = Brightness::no_texture;
  geometry::PointCloud polygon_;
};

}  // namespace

geometry::PointCloud read_ply_vertices(const path& file, std::string_view bytes,
                                       const PlyHeader& header) {
  require_more_than_edges(file, header);
  return Reader(file, bytes, header).read().vertices;
}

void read_ply(const path& file, std::string_view bytes, MeshBuilder& mesh) {
  const PlyHeader header = read_ply_header(file, bytes);
  require_more_than_edges(file, header);
  const PlyContent content = Reader(file, bytes, header).read();
  if (header.format != PlyFormat::ascii && has_single_coordinates(header))
    for (const geometry::Point& vertex : content.vertices) mesh.stored_in_single(vertex, 1);
  PlyFaces(file, header, content, mesh).add_all();
}

}  // namespace lamplock::model
