// docs/pendants.md lists every action and every key with its effect.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/pendant/read_key_map.hpp"
#include "tests/docs/page.hpp"
#include "tests/paths.hpp"

namespace lamplock::pendant {
namespace {

std::string actions_table() {
  std::string text = "| action | what it does |\n|---|---|\n";
  for (const ActionRow& row : action_rows())
    text += fmt::format("| `{}` | {} |\n", row.name, row.about);
  return text;
}

std::string keys_table() {
  std::string text = "| key | action |\n|---|---|\n";
  const KeyMap map = default_key_map();
  for (int i = static_cast<int>(Key::stop); i < static_cast<int>(Key::count); ++i) {
    const auto bound = map.keys.find(static_cast<Key>(i));
    text += fmt::format("| `{}` | {} |\n", key_name(static_cast<Key>(i)),
                        bound == map.keys.end() ? "" : action_name(bound->second.action));
  }
  return text;
}

std::string keyboard_table() {
  std::string text = "| key | action |\n|---|---|\n";
  for (const auto& [name, bound] : default_key_map().keyboard)
    text += fmt::format("| `{}` | {} |\n", name, action_name(bound.action));
  return text;
}

TEST(PendantsPage, HasEveryActionAndEveryKey) {
  const std::string page = test::read_repository_file("docs/pendants.md");
  for (const std::string& table : {actions_table(), keys_table(), keyboard_table()})
    EXPECT_NE(page.find(table), std::string::npos) << table;
}

TEST(PendantsPage, ItsExampleIsValid) {
  const KeyMap map = read_key_map(test::in_repository("examples/pendant.toml"));
  EXPECT_EQ(map.macros.size(), 1u);
}

}  // namespace
}  // namespace lamplock::pendant
