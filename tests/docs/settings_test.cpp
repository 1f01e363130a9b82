// docs/settings.md equals the table of settings, row by row.
#include "shared/settings_table.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "shared/wire/job_header.hpp"
#include "tests/docs/page.hpp"

namespace lamplock::settings {
namespace {

/// A value as printed by the machine.
std::string number(std::int32_t milli, bool whole) {
  return whole ? fmt::format("{}", milli / 1000) : fmt::format("{:.3f}", milli / 1000.0);
}

TEST(SettingsPage, HasTheTableOfTheCode) {
  std::string wanted;
  for (const Row& row : table)
    wanted +=
        fmt::format("| ${} | `{}` | {} | {} | {} | {} | {} |\n", row.number, row.name, row.unit,
                    number(row.min_milli, row.whole), number(row.max_milli, row.whole),
                    number(row.default_milli, row.whole), row.description);
  const std::string page = test::read_repository_file("docs/settings.md");
  const std::string head = "|---|---|---|---|---|---|---|\n";
  const std::size_t at = page.find(head);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(page.substr(at + head.size()), wanted);
}

TEST(WireFormatPage, HasTheNumberOfOverrides) {
  EXPECT_NE(test::read_repository_file("docs/wire-format.md")
                .find(fmt::format("number of overrides n, 0..{}:", wire::max_overrides)),
            std::string::npos);
}

}  // namespace
}  // namespace lamplock::settings
