// `--spot`: the temperature loop on a simulated board, and what happens to a program without a user
// when its sensor is missing.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// 3 s with light, and a board whose loop is on.
class Spot : public testing::Test {
 protected:
  Finished sent(std::vector<std::string> more, const std::string& board = "virtual") const {
    std::vector<std::string> all{"send",      program_, "--board", board,
                                 "--machine", machine_, "--yes"};
    all.insert(all.end(), more.begin(), more.end());
    return run(all);
  }

  const Folder folder_;
  const std::string program_ = folder_.write("line.ngc", "G21 G90\nM3 S600\nG1 X10 F200\nM5\nM2\n");
  const std::string machine_ = folder_.write(
      "cutter.toml",
      "pin_map = 4\nlamp_mode = 0\nlaser_mode = 1\nmax_spindle_speed = 1000\nloop = 1\n"
      "loop_set_point = 2000\nloop_kp = 1.235\nloop_ki = 65.354\nsensor_scale = 200\n"
      "sensor_min = 200\n");
};

TEST_F(Spot, IsSeenByTheLoop) {
  const Finished done = sent({"--spot", "500,0.05,200,0.5"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.out + done.err, Not(HasSubstr("out of range")));
}

TEST_F(Spot, AProgramThatAFaultHasHeldEndsWithoutAUser) {
  const Finished done = sent({});
  EXPECT_EQ(done.status, 1);
  EXPECT_THAT(done.out + done.err, HasSubstr("SENSOR out of range"));
  EXPECT_THAT(done.out + done.err, HasSubstr("no terminal input to resume the program"));
  EXPECT_THAT(done.out + done.err, Not(HasSubstr("continuing")));
}

TEST_F(Spot, NumbersWithoutAMeaningAreRefused) {
  for (const char* numbers : {"0,0.05,200,0.5", "500,0,200,0.5", "500,0.05,0,0.5", "500,0.05,200,4",
                              "500,0.05,200", "nan,1,1,1"}) {
    const Finished done = sent({"--spot", numbers});
    EXPECT_EQ(done.status, 2) << numbers;
    EXPECT_THAT(done.err, HasSubstr("--spot")) << numbers;
  }
  EXPECT_THAT(sent({"--spot", "500,0.05,200,0.5"}, "/dev/none").err,
              HasSubstr("simulated boards only"));
}

}  // namespace
}  // namespace lamplock::cli::test
