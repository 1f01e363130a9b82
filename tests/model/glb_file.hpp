// Writes GLB files for the tests of their reader.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "host/bytes.hpp"
#include "host/model/mesh.hpp"

namespace lamplock::mesh_files {

using nlohmann::json;

/// A GLB of one mesh; `change` edits its description, `more` follows its
/// numbers.
inline std::string glb_of(
    const model::Mesh& mesh, const std::function<void(json&)>& change = [](json&) {},
    const std::string& more = "") {
  std::string buffer;
  for (const geometry::Point& v : mesh.vertices)
    for (const double c : {v.x, v.y, v.z}) append(buffer, static_cast<float>(c));
  const std::size_t positions = buffer.size();
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) append(buffer, v);
  const std::size_t indices = buffer.size() - positions;
  buffer += more;
  json d = {{"asset", {{"version", "2.0"}}},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}}},
            {"buffers", {{{"byteLength", buffer.size()}}}},
            {"bufferViews",
             {{{"buffer", 0}, {"byteLength", positions}},
              {{"buffer", 0}, {"byteOffset", positions}, {"byteLength", indices}}}},
            {"accessors",
             {{{"bufferView", 0},
               {"componentType", 5126},
               {"count", mesh.vertices.size()},
               {"type", "VEC3"}},
              {{"bufferView", 1},
               {"componentType", 5125},
               {"count", 3 * mesh.triangles.size()},
               {"type", "SCALAR"}}}}};
  change(d);
  std::string text = d.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  append(bytes, std::uint32_t{2});
  append(bytes, static_cast<std::uint32_t>(28 + text.size() + buffer.size()));
  append(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  append(bytes, static_cast<std::uint32_t>(buffer.size()));
  return bytes + std::string("BIN\0", 4) + buffer;
}

}  // namespace lamplock::mesh_files
