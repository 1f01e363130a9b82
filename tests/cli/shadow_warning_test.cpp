// Lists that are engraved in their own order although earlier points shadow later ones.
#include <gmock/gmock.h>

#include <string>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(ShadowWarning, NamesTheFirstPairOfAListInItsOwnOrder) {
  const Folder folder;
  const std::string from_above = folder.write("a.xyz", "5 5 1\n2 2 6\n2 2 5\n2 2 4\n");
  const std::string from_below = folder.write("b.xyz", "2 2 4\n2 2 5\n2 2 6\n5 5 1\n");
  const auto order = [&](const std::string& list, const std::string& name) {
    return run({"order", list, "--order", name, "-o", folder / "o.xyz"}).out;
  };
  EXPECT_THAT(order(from_above, "given"),
              AllOf(HasSubstr("warning  "), HasSubstr("point 2 at (2, 2, 6) mm"),
                    HasSubstr("order than 'given'")));
  EXPECT_THAT(order(from_below, "given"), Not(HasSubstr("warning")));
  EXPECT_THAT(order(from_above, "layers"), Not(HasSubstr("warning")));
  // A list is engraved in its own order by default.
  EXPECT_THAT(run({"engrave", from_above}).out, HasSubstr("shadow"));
  EXPECT_THAT(run({"engrave", from_below}).out, Not(HasSubstr("shadow")));
  EXPECT_THAT(run({"engrave", from_above, "--order", "best"}).out, Not(HasSubstr("shadow")));
}

}  // namespace
}  // namespace lamplock::cli::test
