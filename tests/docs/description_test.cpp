// docs/glass.md documents every key of a description.
#include "host/glass/description.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <string>
#include <type_traits>

#include "tests/docs/page.hpp"

namespace lamplock::glass {
namespace {

std::string values_of(const Parameter& parameter) {
  if (!parameter.names.empty()) return fmt::format("{}", fmt::join(parameter.names, ", "));
  return parameter.unit.empty() ? "true, false" : parameter.unit;
}

std::string default_text(double value) { return fmt::format("{}", value); }
std::string default_text(int value) { return fmt::format("{}", value); }
std::string default_text(bool value) { return value ? "true" : "false"; }
std::string default_text(const std::string& value) { return value; }
/// The default of a parameter that depends on others, as text.
template <class Value>
std::string default_text(const Value&) {
  return "";
}

std::string table_of(const std::string& section, const std::vector<Parameter>& parameters) {
  std::string text = fmt::format(
      "### {}\n\n| key | option | value | default | meaning |\n|---|---|---|---|---|\n", section);
  for (const Parameter& p : parameters)
    text += fmt::format("| `{}` | `{}` | {} | {} | {} |\n", p.key, p.option, values_of(p),
                        std::visit([](const auto* place) { return default_text(*place); }, p.place),
                        p.about);
  return text + "\n";
}

TEST(GlassPage, HasEveryKey) {
  const std::string page = test::read_repository_file("docs/glass.md");
  Description d;
  d.objects.resize(1);
  for (const std::string& wanted :
       {table_of("[machine]", parameters(d.machine)), table_of("[glass]", parameters(d.glass)),
        table_of("[[object]]", parameters(d.objects.front())),
        table_of("[order]", parameters(d.order)), table_of("[pause]", parameters(d.pause)),
        table_of("[output]", parameters(d.output))})
    EXPECT_NE(page.find(wanted), std::string::npos) << wanted;
}

}  // namespace
}  // namespace lamplock::glass
