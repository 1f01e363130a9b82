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
