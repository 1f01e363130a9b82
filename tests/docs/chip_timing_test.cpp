// docs/chip-timing.md lists every assumed value of the chip simulator's parameters.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "tests/docs/page.hpp"

namespace lamplock {
namespace {

using testing::HasSubstr;

TEST(ChipTiming, ThePageHasEveryParameter) {
  const std::string page = test::read_repository_file("docs/chip-timing.md");
  const std::string parameters = test::read_repository_file("sim/chip/fabric/timing.hpp");
  const std::regex member("std::uint32_t (\\w+) =");
  int count = 0;
  for (std::sregex_iterator it(parameters.begin(), parameters.end(), member), end; it != end;
       ++it) {
    EXPECT_THAT(page, HasSubstr("`Timing::" + (*it)[1].str() + "`"));
    ++count;
  }
  EXPECT_GE(count, 6);
}

}  // namespace
}  // namespace lamplock
