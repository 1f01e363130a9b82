#include "host/model/write_points.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string>

#include "host/bytes.hpp"
#include "host/file.hpp"

namespace lamplock::model {

using std::filesystem::path;

void write_xyz(const path& file, std::span<const geometry::Point> cloud) {
  std::string text;
  for (const geometry::Point& point : cloud) {
    fmt::format_to(std::back_inserter(text), "{} {} {}\n", point.x, point.y, point.z);
  }
  write_file(file, text);
}

void write_ply(const path& file, std::span<const geometry::Point> cloud) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment lamplock, mm\nelement vertex {}\n"
      "property double x\nproperty double y\nproperty double z\nend_header\n",
      cloud.size());
  for (const geometry::Point& point : cloud) {
    append(bytes, point.x);
    append(bytes, point.y);
    append(bytes, point.z);
  }
  write_file(file, bytes);
}

void write_dxf(const path& file, std::span<const geometry::Point> cloud) {
  // $INSUNITS 4: millimetres.
  std::string text =
      "  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n  9\n$INSUNITS\n 70\n4\n"
      "  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n";
  for (const geometry::Point& point : cloud) {
    fmt::format_to(std::back_inserter(text), "  0\nPOINT\n  8\n0\n 10\n{}\n 20\n{}\n 30\n{}\n",
                   point.x, point.y, point.z);
  }
  write_file(file, text + "  0\nENDSEC\n  0\nEOF\n");
}

}  // namespace lamplock::model
