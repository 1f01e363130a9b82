#include "host/model/input.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "host/file.hpp"
#include "host/model/ply.hpp"
#include "host/model/read_dxf.hpp"

namespace lamplock::model {

InputKind classify(const std::string& file) {
  const std::filesystem::path path(file);
  struct Extension {
    std::string_view name;
    InputKind kind;
  };
  constexpr std::array<Extension, 14> extensions{{{".stl", InputKind::mesh},
                                                  {".obj", InputKind::mesh},
                                                  {".3mf", InputKind::mesh},
                                                  {".glb", InputKind::mesh},
                                                  {".png", InputKind::bitmap},
                                                  {".bmp", InputKind::bitmap},
                                                  {".jpg", InputKind::bitmap},
                                                  {".jpeg", InputKind::bitmap},
                                                  {".svg", InputKind::curves},
                                                  {".xyz", InputKind::points},
                                                  {".txt", InputKind::points},
                                                  {".csv", InputKind::points},
                                                  {".asc", InputKind::points},
                                                  {".cad", InputKind::points}}};
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) refuse(path, "no such file", "check the name");
  const std::string extension = lower_extension(path);
  if (extension == ".ply") {
    const PlyHeader header = read_ply_header(path, read_file(path));
    return header.count("face") > 0 ? InputKind::mesh : InputKind::points;
  }
  if (extension == ".dxf")
    return read_dxf(path).paths.empty() ? InputKind::points : InputKind::curves;
  for (const Extension& known : extensions) {
    if (known.name == extension) return known.kind;
  }
  refuse(
      path, fmt::format("unknown kind of file '{}'", extension),
      "give a mesh (stl, obj, ply, 3mf, glb), a drawing (dxf, svg), a picture (png, bmp, jpg) or "
      "points (xyz, txt, csv, asc, cad)");
}

}  // namespace lamplock::model
