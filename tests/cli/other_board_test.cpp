// A job, a program or settings for another board than the one at the port are refused before
// anything moves; the message names both boards.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

class OtherBoard : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(pico_.wait_for("Ctrl-C")); }
  /// A command for the board at the port with the profile of a PicoBOB.
  void expect_refused(std::vector<std::string> command, const std::string& what) {
    command.insert(command.end(), {"--board", folder_ / "port", "--yes"});
    const Finished ended = run(command);
    EXPECT_EQ(ended.status, 2) << command[0] << ": " << ended.out;
    EXPECT_THAT(ended.err, MatchesRegex("(.*\n)*error: [^\n]+: [^\n]+; [^\n]+\n")) << command[0];
    EXPECT_THAT(ended.err, HasSubstr(what)) << command[0];
  }

  Folder folder_;
  const std::string points_ = folder_.write("p.xyz", "0 0 0\n1 1 0\n2 0 0\n");
  const std::string profile_ =
      folder_.write("picobob.toml", "pin_map = 3\nlamp_mode = 1\nlaser_mode = false\n");
  Running pico_{{"sim", "--pty", folder_ / "port", "--shots", folder_ / "shots.csv", "--json"}};
};

TEST_F(OtherBoard, IsRefusedByEachCommandThatSends) {
  const std::string pins = "pin_map = 3 (board picobob), the board has 0 (board pico)";
  expect_refused({"engrave", points_, "--machine", profile_}, pins);
  const std::string job = folder_ / "p.llj";
  ASSERT_EQ(run({"job", points_, "--machine", profile_, "-o", job}).status, 0);
  expect_refused({"send", job}, pins);
  const std::string of_profile =
      "is for the board picobob (pin_map = 3), the connected one is pico (pin_map = 0)";
  const std::string program = folder_.write("p.ngc", "G21 G91\nG1 X1 F600\n");
  expect_refused({"send", program, "--machine", profile_}, of_profile);
  const std::string drawing = folder_.write(
      "p.svg",
      "<svg xmlns='http://www.w3.org/2000/svg' width='10mm' height='10mm' viewBox='0 0 10 10'>"
      "<path d='M1 1H5V5H1Z'/></svg>");
  const std::string continuous =
      folder_.write("cut.toml", "pin_map = 3\nlamp_mode = 0\nlaser_mode = true\n");
  expect_refused({"cut", drawing, "--machine", continuous, "--feed", "600", "--power", "50"},
                 of_profile);
  pico_.interrupt();
  const Finished ended = pico_.finish();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\"shots\": 0"));
}

#ifdef LAMPLOCK_HAS_FIRMWARE
TEST(ImageOfABoard, IsNotSimulatedInTheWiringOfAnother) {
  const Folder folder;
  const std::string program = folder.write("p.ngc", "G21 G91\nG1 X1 F600\n");
  for (const char* kind : {".elf", ".uf2", ".bin"}) {
    const Finished ended =
        run({"send", program, "--board", "chip", "--image",
             lamplock::test::in_build(std::string("lamplock-grblhal-pico") + kind)});
    EXPECT_EQ(ended.status, 2) << kind;
    EXPECT_THAT(ended.err, HasSubstr("is for the board grblhal-pico, and the simulated one is a "
                                     "pico (pin_map = 0); give --machine with pin_map = 4\n"))
        << kind;
  }
  EXPECT_EQ(run({"send", program, "--board", "chip", "--image",
                 lamplock::test::in_build("lamplock-rp2040.bin")})
                .status,
            0);
}
#endif

}  // namespace
}  // namespace lamplock::cli::test
