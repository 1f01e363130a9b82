// One program for all materials: `check` and `send` with --material.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;

constexpr const char* square =
    "G21 G90\nG0 X1 Y1\n(PRINT, %d#<_material_passes>)\no1 repeat [#<_material_passes>]\n"
    "G1 X3 F[#<_material_feed> * 10]\nX1\no1 endrepeat\nM2\n";

TEST(Process, OneProgramServesAllMaterials) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", square), library = folder / "a.db";
  double last_mm = 0;
  for (const auto& [name, passes] : {std::pair{"ox-leather", 3}, std::pair{"fibreboard", 15}}) {
    const double thickness = passes == 3 ? 3 : 5;
    const std::vector<std::string> choice{"--material", name,          "--library",
                                          library,      "--thickness", std::to_string(thickness)};
    std::vector<std::string> check{"check", file}, send{"send", file, "--board", "virtual"};
    check.insert(check.end(), choice.begin(), choice.end());
    send.insert(send.end(), choice.begin(), choice.end());
    const Json checked = run_json(check);
    EXPECT_NEAR(checked["feed_mm"], 4 * passes, 1e-9);
    EXPECT_NE(checked["feed_mm"], last_mm);
    last_mm = checked["feed_mm"];
    const Finished sent = run(send);
    EXPECT_EQ(sent.status, 0) << sent.err;
    EXPECT_THAT(sent.err, HasSubstr("machine: " + std::to_string(passes)));
    EXPECT_THAT(sent.out, HasSubstr(std::string("material  ") + name));
  }
}

/// A choice that the program does not read.
TEST(Process, AnUnusedChoiceIsANote) {
  const Folder folder;
  const std::string library = folder / "a.db";
  folder.write("tip.ngc", "o<tip> sub\nG1 X1 F#<_material_feed>\no<tip> endsub\n");
  const std::string note =
      "the program reads no value of the material, so --material has no effect";
  const auto expect = [&](const std::string& text, bool has_note) {
    const std::string file = folder.write("p.ngc", text);
    for (std::vector<std::string> command :
         {std::vector<std::string>{"check", file},
          std::vector<std::string>{"send", file, "--board", "virtual"}}) {
      command.insert(command.end(), {"--material", "ox-leather", "--thickness", "3", "--library",
                                     library, "--json"});
      const Finished done = run(command);
      EXPECT_EQ(done.status, 0) << done.err;
      EXPECT_EQ(done.err.find(note) != std::string::npos, has_note) << text << done.err;
    }
  };
  expect("G21\nG1 X1 F100 (_material_feed)\n", true);
  expect("o1 repeat [2]\nG1 X1 F100\no1 endrepeat\n", true);
  expect("G21\nG1 X1 F#<_material_feed>\n", false);
  expect("G21\no<tip> call\n", false);
}

TEST(Process, ProgramsNeedAChoiceAndJobsNone) {
  const Folder folder;
  const std::string file = folder.write("p.ngc", square), library = folder / "a.db";
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"check", file},
        std::vector<std::string>{"send", file, "--board", "virtual"}}) {
    const Finished none = run(command);
    EXPECT_EQ(none.status, 2);
    EXPECT_THAT(none.err, HasSubstr(file + ":3:11: '#<_material_passes>': no material is chosen"));
    std::vector<std::string> alone = command;
    alone.insert(alone.end(), {"--thickness", "3"});
    EXPECT_THAT(run(alone).err, HasSubstr("--thickness: is part of the choice of a material"));
    std::vector<std::string> unknown = command;
    unknown.insert(unknown.end(), {"--material", "plywod", "--library", library});
    EXPECT_THAT(run(unknown).err, HasSubstr("did you mean 'plywood'?"));
  }
  const std::string job = folder.write("a.llj", "x");
  EXPECT_THAT(run({"send", job, "--board", "virtual", "--material", "plywood"}).err,
              HasSubstr("--material: is for programs of G-code, not for jobs; leave it out"));
}

}  // namespace
}  // namespace lamplock::cli::test
