// docs/api.md has the table of the methods of the server.
#include <gtest/gtest.h>

#include "host/serve/method.hpp"
#include "tests/docs/page.hpp"

namespace lamplock::serve {
namespace {

TEST(ApiPage, HasTheTableOfMethods) {
  EXPECT_NE(test::read_repository_file("docs/api.md").find(methods_table()), std::string::npos)
      << methods_table();
}

}  // namespace
}  // namespace lamplock::serve
