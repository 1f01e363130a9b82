// docs/gcode.md lists exactly the codes that the interpreter supports, and its errors.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "firmware/program/interpreter.hpp"
#include "shared/gcode_errors.hpp"
#include "tests/docs/page.hpp"

namespace lamplock::program {
namespace {

std::string section(const std::string& heading) {
  const std::string page = test::read_repository_file("docs/gcode.md");
  const std::size_t from = page.find("\n## " + heading + "\n");
  if (from == std::string::npos) return {};
  return page.substr(from, page.find("\n## ", from + 1) - from);
}

/// Every supported G and M code up to a number.
std::set<std::string> known_codes() {
  Parameters parameters;
  Options options;
  options.probe = true;
  options.outputs = options.inputs = 1;
  std::set<std::string> known;
  const auto try_code = [&](const std::string& code) {
    Interpreter interpreter(parameters, options);
    EXPECT_FALSE(interpreter.run("M70"));  // saves the state that M72 restores
    if (interpreter.run(code).error != GcodeError::unsupported) known.insert(code);
  };
  for (int tenth = 0; tenth < 2000; ++tenth)
    try_code(tenth % 10 == 0 ? fmt::format("G{}", tenth / 10)
                             : fmt::format("G{}.{}", tenth / 10, tenth % 10));
  for (int code = 0; code < 1000; ++code) try_code(fmt::format("M{}", code));
  return known;
}

TEST(GcodePage, ListsTheSupportedCodes) {
  std::set<std::string> listed;
  const std::string text = section("Codes");
  // The first cell of each row.
  const std::regex row("\n\\| ([GM][^|]*) \\|"), code("[GM][0-9.]+");
  for (std::sregex_iterator r(text.begin(), text.end(), row), end; r != end; ++r) {
    const std::string cell = (*r)[1];
    for (std::sregex_iterator c(cell.begin(), cell.end(), code); c != end; ++c)
      EXPECT_TRUE(listed.insert(c->str()).second) << c->str() << " twice";
  }
  EXPECT_EQ(listed, known_codes());
}

TEST(GcodePage, ListsTheErrors) {
  std::string wanted = "|---|---|\n";
  for (const GcodeErrorRow& row : gcode_errors)
    wanted += fmt::format("| {} | {} |\n", static_cast<int>(row.error), row.text);
  EXPECT_NE(section("Errors").find(wanted), std::string::npos);
}

}  // namespace
}  // namespace lamplock::program
