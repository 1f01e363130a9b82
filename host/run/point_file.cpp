#include "host/run/point_file.hpp"

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/model/write_points.hpp"

namespace lamplock::run {

void check_point_file(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension != ".xyz" && extension != ".ply" && extension != ".dxf")
    throw Error(Exit::bad_input, file.string(), "is not a kind of point list",
                "name it .xyz, .ply or .dxf");
  check_target(file);
}

void write_point_file(const std::filesystem::path& file, std::span<const geometry::Point> cloud) {
  const std::string extension = lower_extension(file);
  write_whole(file, [&](const std::filesystem::path& path) {
    if (extension == ".ply")
      model::write_ply(path, cloud);
    else if (extension == ".dxf")
      model::write_dxf(path, cloud);
    else
      model::write_xyz(path, cloud);
  });
}

}  // namespace lamplock::run
