#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "host/file.hpp"
#include "host/model/read_points.hpp"
#include "host/model/write_points.hpp"
#include "tests/damaged.hpp"
#include "tests/points/shapes.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using geometry::PointCloud;
using model::read_point_list;
using test::error_of;
using test::TemporaryFolder;
using ::testing::HasSubstr;

/// Doubles of every size, including those with the most digits.
PointCloud awkward_points(std::mt19937_64& random, int count) {
  const auto coordinate = [&] {
    double value;
    do {
      value = std::bit_cast<double>(random());
    } while (!std::isnormal(value));
    return random() % 2 == 0 ? value : static_cast<double>(random()) * 1e-17 - 50;
  };
  PointCloud cloud{{0.1, -0.0, 1.0 / 3}};
  for (int i = 0; i < count; ++i) cloud.push_back({coordinate(), coordinate(), coordinate()});
  return cloud;
}

bool same_bits(const PointCloud& a, const PointCloud& b) {
  return a.size() == b.size() &&
         std::equal(a.begin(), a.end(), b.begin(), [](const auto& p, const auto& q) {
           return std::bit_cast<std::array<std::uint64_t, 3>>(p) ==
                  std::bit_cast<std::array<std::uint64_t, 3>>(q);
         });
}

TEST(PointList, RoundTripsAreExact) {
  const TemporaryFolder folder;
  std::mt19937_64 random(1);
  const PointCloud cloud = awkward_points(random, test::scaled(3000));
  model::write_xyz(folder.file("a.xyz"), cloud);
  EXPECT_TRUE(same_bits(read_point_list(folder.file("a.xyz")), cloud));
  model::write_ply(folder.file("a.ply"), cloud);
  EXPECT_TRUE(same_bits(read_point_list(folder.file("a.ply")), cloud));
  // A drawing has its own limits.
  PointCloud near;
  for (const auto& p : cloud) {
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1e9) near.push_back(p);
  }
  EXPECT_GE(near.size(), 1u);
  model::write_dxf(folder.file("a.dxf"), near);
  EXPECT_TRUE(same_bits(read_point_list(folder.file("a.dxf")), near));
}

TEST(PointList, ReadsRowsOfGlassEngravers) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_point_list(folder.write("a.cad", "1 0 1.5 2 3\r\n1,1,4,5,6\n")),
            (PointCloud{{1.5, 2, 3}, {4, 5, 6}}));
  const auto message = [&](const std::string& bytes) {
    const auto path = folder.write("a.cad", bytes);
    return error_of([&] { read_point_list(path); });
  };
  EXPECT_THAT(message("1 0 1 2 3\n1 0 1 2\n"), HasSubstr("line 2: has 4 of 5 columns"));
  EXPECT_THAT(message("1 0 1 2 3 4\n"), HasSubstr("6 of 5 columns"));
  EXPECT_THAT(message("1 a 1 2 3\n"), HasSubstr("line 1: 'a'"));
}

TEST(PointList, ColumnNamesIdentifyCoordinates) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& bytes) {
    return read_point_list(folder.write("a.csv", bytes));
  };
  EXPECT_EQ(read("x,y,z\n1,2,3\n"), (PointCloud{{1, 2, 3}}));
  EXPECT_EQ(read("# made by\nindex,beat,X_mm,y_mm,z_mm\n0,7,1,2,3\n1,9,4,5,6\n"),
            (PointCloud{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(read("\"name\";\"z\";\"y\";\"x\"\na b;3;2;1\n;6; 5 ;4\n"),
            (PointCloud{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(read("z x y\n3 1 2\n"), (PointCloud{{1, 2, 3}}));
  EXPECT_EQ(read("1;2;3\n4; 5;6;\n"), (PointCloud{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(read("x y z red green blue\n1 2 3 9 9 9\n4,5,6,9,9,9\n7 8 9\n"),
            (PointCloud{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
  EXPECT_EQ(read("x,y,z\n1,2,3,\n"), (PointCloud{{1, 2, 3}}));
  EXPECT_EQ(read("# a;b\n1,2,3\n"), (PointCloud{{1, 2, 3}}));
  const auto message = [&](const std::string& bytes) { return error_of([&] { read(bytes); }); };
  EXPECT_THAT(message("x,y,z,x\n1,2,3,4\n"),
              HasSubstr("line 1: more than one column is named 'x'"));
  EXPECT_THAT(message("x_mm;y;Y;z\n1;2;3;4\n"), HasSubstr("more than one column is named 'y'"));
  EXPECT_THAT(message("a,b,c\n1,2,3\n"), HasSubstr("line 1: the names of columns lack 'x'"));
  EXPECT_THAT(message("x,y,z\n1,2\n"), HasSubstr("line 2: has 2 of 3"));
  EXPECT_THAT(message("x,y,z\n1,,3\n"), HasSubstr("line 2: ''"));
  EXPECT_THAT(message("x,y,z\nx,y,z\n"), HasSubstr("line 2: 'x'"));
  EXPECT_THAT(message("x,y,z\n1,2,3,4\n"), HasSubstr("line 2: has 4 columns, and names for 3"));
}

TEST(PointList, ReadsVariantsOfText) {
  const TemporaryFolder folder;
  const auto path = folder.write("a.txt",
                                 "\xEF\xBB\xBF# x y z\r\n1 2 3\r\n\r\n 4,5 , 6 # a comment\n"
                                 "+7\t-8e0\t.5\n\"1\",\"2\",\"3\"");
  EXPECT_EQ(read_point_list(path), (PointCloud{{1, 2, 3}, {4, 5, 6}, {7, -8, 0.5}, {1, 2, 3}}));
}

TEST(PointList, DecimalCommasAreRefused) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& bytes) {
    const auto path = folder.write(name, bytes);
    return error_of([&] { read_point_list(path); });
  };
  for (const char* line :
       {"1,5;2,5;3,5", "1,5\t2,25\t3,75", "1,5\t2,5", "1,5\t2", "1,5 2,5 3,5", "1,5 2 3", "1 2 3,5",
        "1,5; 2; 3", "\"1,5\";\"2,5\";\"3,5\"", "-1,5\t-2,5\t-3,5 # 1"})
    for (const char* names : {"", "x;y;z\n", "x\ty\tz\n", "x y z\n"})
      EXPECT_THAT(message("a.txt", std::string("# list\n") + names + line + "\n"),
                  testing::AnyOf(HasSubstr("has decimal commas"), HasSubstr("is not a usable")))
          << names << line;
  for (const char* line : {"1,5;2,5;3,5", "1,5\t2,25\t3,75", "1,5\t2,5", "1,5 2 3"})
    EXPECT_THAT(message("a.csv", std::string("1 2 3\n") + line + "\n"),
                HasSubstr("line 2: has decimal commas; write decimal points: 1.5 instead of 1,5"));
  EXPECT_THAT(message("a.csv", "1,5,2,5,3,5\n"), HasSubstr("line 1: has 6 numbers"));
  EXPECT_THAT(message("a.csv", "x,y,z\n1,5,2,5,3,5\n"), HasSubstr("line 2: has 6 columns"));
  EXPECT_THAT(message("a.cad", "1 0 1,5 2\n"), HasSubstr("decimal commas"));
  EXPECT_THAT(message("a.cad", "1;0;1,5;2,5;3,5\n"), HasSubstr("decimal commas"));
}

TEST(PointList, MoreThanThreeNumbersNeedNames) {
  const TemporaryFolder folder;
  for (const char* name : {"a.xyz", "a.txt", "a.csv", "a.asc"}) {
    for (const char* line : {"1 2 3 4", "1,2,3,4", "1;2;3;4", "1\t2\t3\t255\t0\t0"}) {
      const auto path = folder.write(name, std::string("1 2 3\n") + line + "\n");
      EXPECT_THAT(
          error_of([&] { read_point_list(path); }),
          testing::AllOf(HasSubstr("line 2: has "), HasSubstr(" numbers, and 3 are a point"),
                         HasSubstr("line of names")));
    }
  }
  // Lines may end as those of old Macs.
  EXPECT_EQ(read_point_list(folder.write("a.xyz", "1 2 3\r4 5 6\r")),
            (PointCloud{{1, 2, 3}, {4, 5, 6}}));
}

TEST(PointList, ReadsPlyOfEveryKind) {
  const TemporaryFolder folder;
  const std::string properties =
      "element vertex 2\nproperty float x\nproperty uchar red\nproperty double z\nproperty short "
      "y\nend_header\n";
  const PointCloud expected{{1.5, -2, 0.25}, {3, 4, 5}};
  EXPECT_EQ(read_point_list(folder.write("a.ply", "ply\r\nformat ascii 1.0\r\ncomment x\r\n" +
                                                      properties + "1.5 9 0.25 -2\n3 9 5 4\n")),
            expected);
  const std::string big(
      "\x3F\xC0\0\0\x09\x3F\xD0\0\0\0\0\0\0\xFF\xFE"
      "\x40\x40\0\0\x09\x40\x14\0\0\0\0\0\0\0\x04",
      30);
  EXPECT_EQ(read_point_list(
                folder.write("b.ply", "ply\nformat binary_big_endian 1.0\n" + properties + big)),
            expected);
}

TEST(PointList, ErrorsNameTheLine) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& name, const std::string& bytes) {
    const auto path = folder.write(name, bytes);
    return error_of([&] { read_point_list(path); });
  };
  EXPECT_THAT(message("a.xyz", "1 2 3\n# 4\n5 6\n"), HasSubstr("line 3: has 2 of 3"));
  EXPECT_THAT(message("a.xyz", "1 2 3\n4 five 6\n"), HasSubstr("line 2: 'five'"));
  EXPECT_THAT(message("a.xyz", "1 2 nan\n"), HasSubstr("line 1"));
  EXPECT_THAT(message("a.xyz", "1 2 -inf\n"), HasSubstr("line 1"));
  EXPECT_THAT(message("a.xyz", "1 2 1e400\n"), HasSubstr("line 1"));
  EXPECT_THAT(message("a.xyz", "# nothing\n"), HasSubstr("no points"));
  EXPECT_THAT(message("a.xyz", ""), HasSubstr("empty"));
  EXPECT_THAT(error_of([&] { read_point_list(folder.file("none.xyz")); }), HasSubstr("no such"));
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n";
  EXPECT_THAT(message("a.ply", ply + "end_header\n1\n2\n"), HasSubstr("no property y"));
  EXPECT_THAT(
      message("a.ply", ply + "property float y\nproperty float z\nend_header\n1 2 3\n4 5\n"),
      HasSubstr("number 1"));
  EXPECT_THAT(message("a.ply", ply + "element face 3\n"), HasSubstr("end_header"));
}

TEST(PointList, DamagedPlyAtWorstFails) {
  const TemporaryFolder folder;
  std::mt19937_64 random(2);
  model::write_ply(folder.file("whole.ply"), test::random_cloud(random, 20, 50));
  test::expect_damaged_read_or_refused(
      test::scaled(250), read_file(folder.file("whole.ply")), test::any_byte(),
      [&](const std::string& bytes) {
        EXPECT_FALSE(read_point_list(folder.write("a.ply", bytes)).empty());
      });
}

/// Mutated files of one list; at a scale of 20 there are 10 000.
void expect_mutated_lists(const std::string& name, const std::string& whole) {
  EXPECT_FALSE(model::decode_point_list(name, whole).empty());
  int read = 0;
  test::expect_damaged_read_or_refused(
      test::scaled(500, 200), whole, "0123456789.,;-+eE \t\r\n#xyzXnaif\"" + test::any_byte(),
      [&](const std::string& bytes) {
        for (const auto& p : model::decode_point_list(name, bytes))
          ASSERT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
        ++read;
      });
  EXPECT_GT(read, 0);
}

TEST(PointList, DamagedTextAtWorstFails) {
  expect_mutated_lists("a.xyz", "# list\n1.5 -2 3e0\n4 5 6\n.1 +.2 -.3\n7 8 9");
  expect_mutated_lists("a.txt", "\xEF\xBB\xBFz y x\r\n1.5\t2\t3\r\n4\t5\t6\r\n");
  expect_mutated_lists("a.csv", "name,x_mm,y_mm,z_mm\n\"a\",1,2,3\nb,4,5,6\n,7,8,9\n");
  expect_mutated_lists("a.asc", "1;2;3\n4 ; 5; 6\n7;8;9;\n");
  expect_mutated_lists("a.cad", "1 0 1.5 2 3\n1,1,4,5,6\n0 2 7 8 9\n");
}

}  // namespace
}  // namespace lamplock
