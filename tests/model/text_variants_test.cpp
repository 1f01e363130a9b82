// Text of meshes as other programs write it: marks of encodings, line ends, case, one line; and
// triangles without area.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "host/geometry/bounds.hpp"
#include "host/model/read_mesh.hpp"
#include "tests/error_of.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::text_variants {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string stl_text =
    "solid a part\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 10 0 0\nvertex 0 10 0\n"
    "endloop\nendfacet\nendsolid a part\n";
const std::string obj_text = "v 99 99 99\nv 0 0 0\nv 10 0 0\nv 0 10 0\nf 2 3 4\n";
const std::string ply_text =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n10 0 0\n0 10 0\n3 0 1 2\n";

std::string with_line_ends(const std::string& text, const std::string& end) {
  std::string result;
  for (const char c : text) result += c == '\n' ? end : std::string(1, c);
  return result;
}

std::string in_upper_case(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return text;
}

void expect_the_triangle(const std::string& name, const std::string& bytes) {
  const test::TemporaryFolder folder;
  const model::Mesh mesh = model::read_mesh(folder.write(name, bytes));
  ASSERT_EQ(mesh.triangles.size(), 1u) << bytes;
  const geometry::Bounds box = geometry::bounds(mesh.vertices);
  EXPECT_EQ(box.low, (geometry::Point{0, 0, 0})) << bytes;
  EXPECT_EQ(box.high, (geometry::Point{10, 10, 0})) << bytes;
}

TEST(TextVariants, MarksAndLineEndsOfMeshes) {
  const std::pair<std::string, std::string> files[] = {
      {"a.stl", stl_text}, {"a.obj", obj_text}, {"a.ply", ply_text}};
  for (const auto& [name, text] : files)
    for (const std::string end : {"\n", "\r\n", "\r"})
      for (const std::string mark : {"", "\xEF\xBB\xBF"})
        expect_the_triangle(name, mark + with_line_ends(text, end));
}

TEST(TextVariants, StlInUpperCaseAndInOneLine) {
  expect_the_triangle("a.stl", in_upper_case(stl_text));
  expect_the_triangle("a.stl", with_line_ends(stl_text, " "));
  expect_the_triangle("a.stl", "\n " + with_line_ends(in_upper_case(stl_text), "\t"));
}

/// Unused vertices of an OBJ do not count, nor do triangles without area that reach out.
TEST(TextVariants, TrianglesWithoutAreaDoNotChangeTheSize) {
  const test::TemporaryFolder folder;
  const std::string flat = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 50 0 0\nv 100 0 0\nf 1 2 3\nf 1 4 5\n";
  const model::Mesh mesh = model::read_mesh(folder.write("a.obj", flat));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(geometry::bounds(mesh.vertices).high, (geometry::Point{10, 10, 0}));
  EXPECT_THAT(mesh.reader_warnings,
              ElementsAre(HasSubstr("1 triangle without area reaches out of the object")));
  // Inside they stay: they may close a seam.
  const std::string seam = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 5 0 0\nf 1 2 3\nf 1 4 2\n";
  const model::Mesh closed = model::read_mesh(folder.write("b.obj", seam));
  EXPECT_EQ(closed.triangles.size(), 2u);
  EXPECT_TRUE(closed.reader_warnings.empty());
}

}  // namespace
}  // namespace lamplock::text_variants
