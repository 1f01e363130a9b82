// Programs of `lamplock cut` in tests: where they are written, and how a command is refused.
#pragma once

#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/program.hpp"
#include "tests/drawings.hpp"

namespace lamplock::cli::test {

using Arguments = std::vector<std::string>;

class CutProgram : public testing::Test {
 protected:
  /// A drawing in mm.
  std::string drawing(const std::string& entities, int units = 4) const {
    return folder_.write("part.dxf", lamplock::test::dxf_drawing(entities, units));
  }
  /// The one line of a refusal; nothing is written.
  std::string refused(const Finished& wrong) const {
    EXPECT_EQ(wrong.status, 2) << wrong.out << wrong.err;
    std::string error;
    for (const std::string& line : lines(wrong.err))
      if (line.starts_with("error: ")) error += line;
    EXPECT_THAT(error, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+"));
    EXPECT_FALSE(std::filesystem::exists(program_));
    return error;
  }

  Folder folder_;
  const std::string program_ = folder_ / "part.ngc";
};

/// Of one drawing: a rectangle with a hole.
class CutPart : public CutProgram {
 protected:
  /// `cut` with these options; the test adds what all its programs have.
  Finished cut_part(Arguments options, const Arguments& more) const {
    options.insert(options.begin(), {"cut", part_});
    options.insert(options.end(), more.begin(), more.end());
    return run(options);
  }

  const std::string part_ =
      drawing(lamplock::test::dxf_rectangle(5, 5, 25, 20) + lamplock::test::dxf_circle(15, 12, 3));
};

}  // namespace lamplock::cli::test
