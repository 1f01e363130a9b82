#include "host/model/read_mesh.hpp"

#include <fmt/format.h>

#include "host/file.hpp"
#include "host/model/input.hpp"
#include "host/model/mesh_builder.hpp"
#include "host/model/ply.hpp"
#include "host/model/read_3mf.hpp"
#include "host/model/read_glb.hpp"
#include "host/model/read_obj.hpp"
#include "host/model/read_stl.hpp"

namespace lamplock::model {

using std::filesystem::path;

Mesh read_mesh(const path& file) { return decode_mesh(file, read_file(file)); }

Mesh decode_mesh(const path& file, const std::string& bytes) {
  const std::string extension = lower_extension(file);
  MeshBuilder mesh(file);
  if (extension == ".stl") {
    read_stl(file, bytes, mesh);
  } else if (extension == ".obj") {
    refuse_utf16(file, bytes);
    read_obj(file, bytes, mesh);
  } else if (extension == ".ply") {
    read_ply(file, bytes, mesh);
  } else if (extension == ".glb") {
    read_glb(file, bytes, mesh);
  } else if (extension == ".3mf") {
    read_3mf(file, mesh);
  } else {
    refuse(file, fmt::format("'{}' is not a mesh format", extension),
           fmt::format("give a mesh ({})", extensions(InputKind::mesh)));
  }
  return mesh.take();
}

}  // namespace lamplock::model
