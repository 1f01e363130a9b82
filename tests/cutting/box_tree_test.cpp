// The tree of boxes finds the same boxes as a comparison with every box.
#include "host/cutting/box_tree.hpp"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace lamplock::test::box_tree_test {
namespace {

using cutting::Box;
using cutting::BoxTree;
using cutting::Vec;

TEST(BoxTree, FindsAllThatMeetAnother) {
  std::mt19937 random(11);
  const auto below = [&](double end) { return std::uniform_real_distribution(0.0, end)(random); };
  for (const std::size_t count : {0u, 1u, 2u, 8u, 9u, 64u, 65u, 700u, 5000u}) {
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i) {
      // Some are long and thin, some have no size, some are the same.
      const Vec low{below(1000), below(10)};
      const bool is_long = i % 7 == 0;
      boxes.push_back({low, low + Vec{is_long ? below(900) : below(3), i % 5 == 0 ? 0 : below(1)}});
      if (i % 11 == 0) boxes.back() = boxes.front();
    }
    const BoxTree tree(boxes);
    for (int query = 0; query < 200; ++query) {
      const Vec low{below(1000), below(10)};
      const Box about{low, low + Vec{below(50), below(2)}};
      std::set<std::size_t> found, expected;
      tree.visit(about, [&](std::size_t i) { EXPECT_TRUE(found.insert(i).second); });
      for (std::size_t i = 0; i < count; ++i)
        if (boxes[i].meets(about)) expected.insert(i);
      EXPECT_EQ(found, expected) << count;
    }
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(tree.box(i).low, boxes[i].low);
      EXPECT_TRUE(tree.extent().contains(boxes[i]));
    }
  }
}

}  // namespace
}  // namespace lamplock::test::box_tree_test
