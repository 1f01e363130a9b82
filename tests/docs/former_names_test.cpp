// Former names of settings and options: each present name exists, no former one does, and
// docs/settings.md lists them.
#include "host/former_names.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "host/cli/program.hpp"
#include "shared/settings_table.hpp"
#include "tests/docs/page.hpp"

namespace lamplock {
namespace {

void add_names(std::set<std::string>& names, const cli::Command& command) {
  for (const cli::Option& option : command.options())
    for (const std::string& name : option.typed_names()) names.insert(name);
  for (const cli::Command& inner : command.commands()) add_names(names, inner);
}

/// Names of all settings and options.
std::set<std::string> present_names() {
  std::set<std::string> names;
  for (const settings::Row& row : settings::table) names.emplace(row.name);
  add_names(names, *cli::make_program());
  return names;
}

TEST(FormerNames, LeadToPresentOnes) {
  const std::set<std::string> present = present_names();
  for (const FormerName& name : former_names) {
    EXPECT_TRUE(present.contains(std::string(name.present))) << name.present;
    EXPECT_FALSE(present.contains(std::string(name.former))) << name.former;
    EXPECT_EQ(present_name(name.former), name.present);
    EXPECT_EQ(present_name(name.present), name.present);
  }
}

TEST(FormerNames, AreListedInTheDocument) {
  std::string table = "| former name | name |\n|---|---|\n";
  for (const FormerName& name : former_names)
    table += fmt::format("| `{}` | `{}` |\n", name.former, name.present);
  EXPECT_NE(test::read_repository_file("docs/settings.md").find(table), std::string::npos) << table;
}

}  // namespace
}  // namespace lamplock
