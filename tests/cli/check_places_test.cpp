// `lamplock check --json` names the place and the number of an error in a program with O-words.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

/// The only problem of a program, and what `send` says about it.
struct SeenProblem {
  nlohmann::json json;
  std::string sent, checked;
};

SeenProblem problem_of(const Folder& folder, const std::string& program) {
  const std::string file = folder.write("p.ngc", program);
  const Finished done = run({"check", file, "--json"});
  EXPECT_EQ(done.status, 2) << program;
  const nlohmann::json document = nlohmann::json::parse(done.out, nullptr, false);
  EXPECT_TRUE(document.is_object()) << done.out;
  if (!document.is_object() || document["problems"].size() != 1) return {};
  const Finished plain = run({"check", file});
  return {document["problems"][0], run({"send", file, "--board", "virtual"}).err,
          plain.out + plain.err};
}

/// Of lines with and without values; columns are those of the file, with comments and blanks.
TEST(CheckPlaces, OfLinesBetweenOWordsAreThoseOfTheFile) {
  const struct {
    const char* line;
    int column;
  } rows[] = {{"G1 X5 Q3", 7},
              {"  G1 (a) X5 Q3", 13},
              {"G1 X[2 + 3] (b) Q3", 17},
              {"#5=3 G1 X#5 Q[1+2]", 13},
              {"G1 X[SIN[30]] Q3 (c)", 15}};
  for (const auto& row : rows) {
    const Folder folder;
    const SeenProblem seen =
        problem_of(folder, std::string("o1 if [1]\nG1 F100 X2\n") + row.line + "\no1 endif\n");
    ASSERT_TRUE(seen.json.is_object()) << row.line;
    EXPECT_EQ(seen.json["line"], 3) << row.line;
    EXPECT_EQ(seen.json["column"], row.column) << row.line;
    EXPECT_EQ(seen.json["error"], 36) << row.line;
    const std::string place = "p.ngc:3:" + std::to_string(row.column) + ": error:36 ";
    EXPECT_THAT(seen.sent, HasSubstr(place));
    EXPECT_THAT(seen.checked, HasSubstr(place));
  }
}

TEST(CheckPlaces, OfValuesHaveTheNumberOfTheError) {
  const Folder folder;
  const SeenProblem seen =
      problem_of(folder, "o1 sub\n G1 X[1/#1] F100\no1 endsub\no1 call [0]\nM2\n");
  EXPECT_EQ(seen.json["line"], 2);
  EXPECT_EQ(seen.json["column"], 8);
  EXPECT_EQ(seen.json["error"], 72);
  EXPECT_EQ(seen.json["text"], "division by zero");
  EXPECT_THAT(seen.sent, HasSubstr("p.ngc:2:8: error:72 division by zero; "));
}

/// Their line is that of the call, as the lines of that file have it.
TEST(CheckPlaces, OfAnotherFileAreInTheText) {
  const Folder folder;
  const std::string program = "G21\no<slot> call [0]\nM2\n";
  const auto slot = [&](const std::string& line) {
    folder.write("slot.ngc", "o<slot> sub\n" + line + "\no<slot> endsub\n");
    return problem_of(folder, program);
  };
  SeenProblem seen = slot("G1 X[1/#1] F100");
  EXPECT_EQ(seen.json["line"], 2);
  EXPECT_EQ(seen.json["column"], 0);
  EXPECT_EQ(seen.json["error"], 72);
  EXPECT_THAT(seen.json["text"].get<std::string>(), HasSubstr("slot.ngc:2:7: division by zero"));
  EXPECT_THAT(seen.sent, HasSubstr("slot.ngc:2:7: error:72 division by zero"));
  seen = slot("(a) G1 F100 Q[1+2]");
  EXPECT_EQ(seen.json["line"], 2);
  EXPECT_EQ(seen.json["error"], 36);
  EXPECT_THAT(seen.json["text"].get<std::string>(), HasSubstr("slot.ngc:2:13: 'Q3': "));
  EXPECT_THAT(seen.sent, HasSubstr("slot.ngc:2:13: 'Q3': "));
  for (const char* line : {"o1 endif", "o1 gosub", "o<slot> sub", "G1 \x18", "o1 if 5"}) {
    seen = slot(line);
    EXPECT_EQ(seen.json["line"], 2) << line;
    EXPECT_THAT(seen.json["text"].get<std::string>(), HasSubstr("slot.ngc:2: ")) << line;
  }
  folder.write("slot.ngc", "G1 X1\n");
  seen = problem_of(folder, program);
  EXPECT_EQ(seen.json["line"], 2);
  EXPECT_THAT(seen.json["text"].get<std::string>(), HasSubstr("slot.ngc: has no sub o<slot>"));
}

TEST(CheckPlaces, OfProcessParametersHaveTheirColumn) {
  const Folder folder;
  for (const std::string begin : {"", "o1 if [1]\no1 endif\n"}) {
    const SeenProblem seen = problem_of(folder, begin + "G1 X1 F#<_material_feed>\n");
    EXPECT_EQ(seen.json["line"], begin.empty() ? 1 : 3);
    EXPECT_EQ(seen.json["column"], 8);
    EXPECT_THAT(seen.json["text"].get<std::string>(), HasSubstr("no material is chosen"));
    EXPECT_THAT(seen.json["remedy"].get<std::string>(), HasSubstr("--material"));
  }
}

TEST(CheckPlaces, OfABytesLineHaveItsLine) {
  const Folder folder;
  const SeenProblem seen = problem_of(folder, "o1 if [1]\nG1 \x18\no1 endif\n");
  EXPECT_EQ(seen.json["line"], 2);
  EXPECT_THAT(seen.json["text"].get<std::string>(), HasSubstr("the byte 0x18"));
}

}  // namespace
}  // namespace lamplock::cli::test
