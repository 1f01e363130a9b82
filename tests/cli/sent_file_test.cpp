// Jobs and programs are recognised by their contents, and written under names
// of their own.
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/run_json.hpp"

namespace lamplock::cli::test::sent_file {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class SentFile : public testing::Test {
 protected:
  SentFile() {
    EXPECT_EQ(run({"job", list_, "-o", job_}).status, 0);
    EXPECT_EQ(run(raster({"-o", rows_})).status, 0);
  }
  std::vector<std::string> raster(const std::vector<std::string>& more) const {
    std::vector<std::string> all{"raster", picture_, "--feed", "6000", "--machine", laser_};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void expect_refused(const std::vector<std::string>& arguments, const std::string& what) const {
    const Finished refused = run(arguments);
    EXPECT_EQ(refused.status, 2) << arguments[1];
    EXPECT_THAT(refused.err, testing::MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_THAT(refused.err, HasSubstr(what));
  }

  Folder folder_;
  std::string list_ = folder_.write("p.xyz", xyz(walk(12, 1)));
  std::string picture_ = folder_.write("disc.bmp", disc_bmp(8));
  std::string laser_ = folder_.write("laser.toml", "laser_mode = 1\n");
  std::string job_ = folder_ / "j.llj", rows_ = folder_ / "rows.llj";
  std::vector<std::string> names_{"a.ngc", "a.gcode", "a.txt", "a.stl", "a", "a.LLJ", "a.llj.bak"};
};

TEST_F(SentFile, IsAJobUnderAnyName) {
  const Json estimate = run_json({"estimate", job_});
  for (const std::string& name : names_) {
    const std::string file = folder_.write(name, read(job_));
    EXPECT_EQ(run_json({"send", file})["points_fired"], 12) << name;
    EXPECT_EQ(run_json({"estimate", file})["beats"], estimate["beats"]) << name;
    expect_refused({"check", file}, "is a job, not a program");
    expect_refused({"diagnose", file}, "is a job, not a program");
  }
  EXPECT_TRUE(run_json({"send", folder_.write("rows.nc", read(rows_))}).contains("lines"));
}

TEST_F(SentFile, IsAProgramUnderAnyNameButThatOfAJob) {
  for (const std::string text :
       {"G21 G91\nG1 X1 F6000\nM2\n", "%\n(a comment)\n\n/G1X.5F6000\ng1 x-1 ; back\n%\n",
        "\xEF\xBB\xBF; made by a slicer\r\nG0 X1\r\nM30\r\n", "$G\nG4 P0\n"})
    for (const std::string& name : names_) {
      if (fs::path(name).extension() == ".LLJ") continue;
      EXPECT_EQ(run_json({"send", folder_.write(name, text)})["end"], "done") << name << text;
    }
  // A program with an error keeps its name and the line.
  expect_refused({"send", folder_.write("wrong.ngc", "hello\n")}, "wrong.ngc:1");
}

TEST_F(SentFile, IsRefusedIfItIsNeither) {
  for (const std::string& text :
       {octahedron_stl(), xyz(walk(5, 1)), std::string("x,y,z\n1,2,3\n"), disc_bmp(4),
        std::string("v 1 2 3\nf 1 2 3\n"), std::string("<svg/>"), std::string("speed = 1\n"),
        std::string("; a comment alone\n")})
    for (const std::string name : {"b.txt", "b.stl", "b"})
      expect_refused({"send", folder_.write(name, text)}, "is neither a job nor a program");
  expect_refused({"send", folder_.write("b.llj", "G1 X1\n")}, "is not a lamplock job file");
  // A text without a number may be a program; one with numbers may be a list of points.
  expect_refused({"send", folder_.write("c.txt", "hello\n")}, "which lamplock check");
  expect_refused({"send", folder_.write("c.txt", "x y z\n1 2 3\n")}, "lamplock job");
}

TEST_F(SentFile, IsWrittenUnderANameOfItsKind) {
  const auto before = folder_.files();
  for (const char* const name : {"k.ngc", "k.txt", "k", "k.llj.txt"}) {
    expect_refused({"job", list_, "-o", folder_ / name}, "name that ends in .llj");
    expect_refused(raster({"-o", folder_ / name}), ".llj");
  }
  expect_refused(raster({"--gcode", folder_ / "k.llj"}), ".ngc");
  EXPECT_EQ(folder_.files(), before);
  EXPECT_EQ(run({"job", list_, "-o", folder_ / "K.LLJ"}).status, 0);
  EXPECT_EQ(run({"job", list_, "-o", "/dev/null"}).status, 0);
}

}  // namespace
}  // namespace lamplock::cli::test::sent_file
