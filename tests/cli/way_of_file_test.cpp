// A file that is given to the wrong command, or is empty or broken: the error says what it is and
// names a command that takes it.
#include <gmock/gmock.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test::way_of_file {
namespace {

using Arguments = std::vector<std::string>;
using testing::HasSubstr;

class WayOfFile : public testing::Test {
 protected:
  WayOfFile() {
    folder_.write("ball.stl", octahedron_stl());
    folder_.write("disc.bmp", disc_bmp(8));
    folder_.write("list.xyz", xyz(walk(9, 1)));
    folder_.write("part.ngc", "G21\nG1 X1 F600\nM2\n");
    folder_.write("job.toml", "[[object]]\nfile = \"ball.stl\"\n");
    EXPECT_EQ(run({"job", folder_ / "list.xyz", "-o", folder_ / "job.llj"}).status, 0);
    for (const char* const name : {"e.llj", "e.xyz", "e.ngc", "e.stl"}) folder_.write(name, "");
  }
  /// The words with "@name" as a file of the folder.
  Arguments filled(Arguments words) const {
    for (std::string& word : words)
      if (word.starts_with('@')) word = folder_ / word.substr(1);
    return words;
  }
  std::string refusal(const Arguments& words) const {
    const Finished refused = run(filled(words));
    EXPECT_EQ(refused.status, 2) << words[0] << " " << words[1];
    EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_EQ(refused.out, "");
    return refused.err;
  }
  const Folder folder_;
};

TEST_F(WayOfFile, OfAJob) {
  for (const Arguments& words :
       {Arguments{"engrave", "@job.llj"}, Arguments{"points", "@job.llj", "-o", "@o.xyz"},
        Arguments{"job", "@job.llj", "-o", "@o.llj"}, Arguments{"frame", "@job.llj"},
        Arguments{"order", "@job.llj", "-o", "@o.xyz"}, Arguments{"check", "@job.llj"},
        Arguments{"diagnose", "@job.llj"},
        Arguments{"raster", "@job.llj", "--feed", "900", "--gcode", "@o.ngc"}})
    EXPECT_THAT(refusal(words), testing::AllOf(HasSubstr("is a job, not a"),
                                               HasSubstr("lamplock send " + (folder_ / "job.llj"))))
        << words[0];
  EXPECT_EQ(run({"send", folder_ / "job.llj"}).status, 0);
}

TEST_F(WayOfFile, OfAProgram) {
  for (const Arguments& words :
       {Arguments{"engrave", "@part.ngc"}, Arguments{"job", "--show", "@part.ngc"},
        Arguments{"order", "@part.ngc", "-o", "@o.xyz"},
        Arguments{"raster", "@part.ngc", "--feed", "900", "--gcode", "@o.ngc"}})
    EXPECT_THAT(refusal(words),
                testing::AllOf(HasSubstr("is a program of G-code, not a"),
                               HasSubstr("lamplock check " + (folder_ / "part.ngc"))))
        << words[0];
}

TEST_F(WayOfFile, OfAModelOrAPicture) {
  EXPECT_THAT(
      refusal({"check", "@disc.bmp"}),
      testing::AllOf(HasSubstr("is a picture, not a program"), HasSubstr("lamplock raster")));
  EXPECT_THAT(refusal({"check", "@ball.stl"}), HasSubstr("is a mesh, not a program"));
  EXPECT_THAT(refusal({"job", "--show", "@list.xyz"}),
              HasSubstr("lamplock job " + (folder_ / "list.xyz")));
  EXPECT_THAT(refusal({"raster", "@ball.stl", "--feed", "900", "--gcode", "@o.ngc"}),
              HasSubstr("is a mesh, not a picture"));
  for (const char* const name : {"@ball.stl", "@job.toml"}) {
    const std::string message = refusal({"order", name, "-o", "@o.xyz"});
    EXPECT_THAT(message, HasSubstr("is not a point list; make one of it: lamplock points "));
  }
}

TEST_F(WayOfFile, ThatIsEmptyOrBroken) {
  EXPECT_THAT(refusal({"job", "--show", "@e.llj"}), HasSubstr("lamplock job MODEL -o "));
  EXPECT_THAT(refusal({"send", "@e.llj"}), HasSubstr("lamplock raster PICTURE"));
  EXPECT_THAT(refusal({"order", "@e.xyz", "-o", "@o.xyz"}), HasSubstr("x y z in mm"));
  EXPECT_THAT(refusal({"send", "@e.ngc"}), HasSubstr("write G-code to it"));
  EXPECT_THAT(refusal({"engrave", "@e.stl"}), HasSubstr("export it again"));
  const std::string bytes = read(folder_ / "job.llj");
  folder_.write("cut.llj", bytes.substr(0, bytes.size() / 2));
  for (const Arguments& words :
       {Arguments{"send", "@cut.llj"}, Arguments{"job", "--show", "@cut.llj"}})
    EXPECT_THAT(refusal(words), HasSubstr("is truncated or corrupt; make the job again with "
                                          "lamplock job (points) or lamplock raster (rows)"));
}

}  // namespace
}  // namespace lamplock::cli::test::way_of_file
