// Numbers with decimal commas: every reader of text names the comma.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "host/model/input.hpp"
#include "tests/error_of.hpp"
#include "tests/model/dxf_text.hpp"
#include "tests/model/svg_page.hpp"
#include "tests/model/threemf_files.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::decimal_comma_test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(DecimalComma, IsNamedByEveryReader) {
  const test::TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> files{
      {"a.stl",
       "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1,5 0 0\nvertex 0 1 0\n"
       "endloop\nendfacet\nendsolid a\n"},
      {"a.obj", "v 0 0 0\nv 1,25 0 0\nv 0 1 0\nf 1 2 3\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
       "float "
       "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1,5 0 0\n0 1 "
       "0\n3 0 1 2\n"},
      {"a.dxf", test::dxf_drawing("0 LINE 10 0,5 20 0 11 1 21 0")},
      {"a.svg", test::svg_page("<rect width='10,5mm' height='3'/>")},
      {"a.xyz", "1,5 2,5 3,5\n2,5 3,5 4,5\n"}};
  for (const auto& [name, text] : files) {
    const auto path = folder.write(name, text);
    EXPECT_THAT(test::error_of([&path = path] { model::read_input(path); }),
                AllOf(HasSubstr("decimal comma"), HasSubstr("1.5 instead of 1,5")))
        << name;
  }
}

}  // namespace
}  // namespace lamplock::decimal_comma_test
