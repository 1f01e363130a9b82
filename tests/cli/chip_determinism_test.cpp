// Runs of the flash image in `lamplock chip` are the same to the byte: repeated, with and without
// traces and profiles, and with PIO and DMA run in every clock, as are runs of the small images.
// tests/gdb/session tests runs with a debugger.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/cli/program.hpp"
#include "tests/paths.hpp"

#ifdef LAMPLOCK_HAS_FIRMWARE

namespace lamplock::cli::test {
namespace {

/// Boot, USB, a lamp at 1 kHz on LAMP SYNC, a question over USB in the middle of it.
constexpr const char* busy_script =
    "wait usb within 1s\n"
    "pulse gpio8 10us every 1ms times 1000\n"
    "after 20ms usb send \"$I\\n\"\n"
    "expect usb \"ok\\r\\n\" within 20ms\n"
    "expect gpio25 frequency 1MHz +-0.1% in 1ms\n"
    "end\n";

/// Without USB, whose host is slow, for slow runs: boot, the lamp, steps of time. The run ends
/// before clashes of both cores and the DMA on one bank of SRAM: they are judged in the order of
/// the simulation (sim/chip/fabric/arbiter.hpp), which differs with every clock stepped, and then
/// code takes some clocks more or less.
constexpr const char* short_script =
    "at 170ms pulse gpio8 10us every 1ms times 3\n"
    "at 173500us\n"
    "end\n";

/// Output of a run.
struct Left {
  std::string summary, said, vcd, profile;
};

/// Number of end times tried for one image.
constexpr int test_ends = 16;

class ChipDeterminism : public testing::Test {
 protected:
  Left left(const std::vector<std::string>& more) { return left(busy_, more); }
  Left left(const std::string& script, const std::vector<std::string>& more) {
    return left(lamplock::test::in_build("lamplock-rp2040.uf2"), script, more);
  }
  /// Runs the image; an empty `script` means none.
  Left left(const std::string& image, const std::string& script,
            const std::vector<std::string>& more) {
    std::vector<std::string> all{"chip", image, "--json"};
    if (!script.empty()) all.insert(all.end(), {"--script", script});
    all.insert(all.end(), more.begin(), more.end());
    const Finished done = run(all);
    EXPECT_EQ(done.status, 0) << done.err;
    Left result;
    // The first line has the wall-clock time.
    result.said = done.err.substr(std::min(done.err.size(), done.err.find('\n')));
    nlohmann::json summary = nlohmann::json::parse(done.out);
    summary.erase("wall");
    result.summary = summary.dump(2);
    if (const std::string file = folder_ / "trace.vcd"; std::filesystem::exists(file)) {
      result.vcd = read(file);
      std::filesystem::remove(file);
    }
    if (const std::string file = folder_ / "profile.txt"; std::filesystem::exists(file)) {
      result.profile = read(file);
      std::filesystem::remove(file);
    }
    return result;
  }

  const Folder folder_;
  const std::string busy_ = folder_.write("busy.script", busy_script);
  const std::string short_ = folder_.write("short.script", short_script);
  const std::vector<std::string> vcd_{"--vcd", folder_ / "trace.vcd"};
  const std::vector<std::string> profile_{"--profile", folder_ / "profile.txt"};
};

/// Compares without printing megabytes of VCD.
void expect_same(const std::string& one, const std::string& two, const char* what) {
  EXPECT_FALSE(one.empty()) << what;
  EXPECT_TRUE(one == two) << what << ": " << one.size() << " and " << two.size() << " bytes";
}

TEST_F(ChipDeterminism, two_runs_of_the_firmware_are_the_same_with_any_trace) {
  const Left traced = left(vcd_);
  expect_same(traced.vcd, left(vcd_).vcd, "two traces");
  std::vector<std::string> both = vcd_;
  both.insert(both.end(), profile_.begin(), profile_.end());
  const Left watched = left(both);
  expect_same(traced.vcd, watched.vcd, "trace with a profile");
  expect_same(watched.profile, left(profile_).profile, "profile without a trace");
  EXPECT_EQ(left({}).summary, traced.summary);
  EXPECT_EQ(watched.summary, traced.summary);
}

TEST_F(ChipDeterminism, skipping_clocks_changes_nothing) {
  std::vector<std::string> stepped = vcd_;
  stepped.emplace_back("--step-every-clock");
  const Left sleeping = left(short_, vcd_), stepping = left(short_, stepped);
  expect_same(sleeping.vcd, stepping.vcd, "trace with every clock stepped");
  EXPECT_EQ(sleeping.summary, stepping.summary);
}

/// The small images with their scripts: each tests one part of the chip.
class ChipImages : public ChipDeterminism {
 protected:
  static std::vector<std::filesystem::path> scripts() {
    std::vector<std::filesystem::path> found;
    for (const auto& entry :
         std::filesystem::directory_iterator(lamplock::test::in_repository("tests/chip_images")))
      if (entry.path().extension() == ".script") found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
  }
  Left left_of(const std::filesystem::path& script, const std::vector<std::string>& more) {
    const std::filesystem::path image = std::filesystem::path(lamplock::test::in_build("images")) /
                                        script.stem().replace_extension(".uf2");
    std::vector<std::string> options{"--until", "2s"};
    for (const auto& each : {vcd_, profile_, more})
      options.insert(options.end(), each.begin(), each.end());
    return left(image, script, options);
  }
};

TEST_F(ChipImages, SteppingEveryClockLeavesTheSameFiles) {
  const std::vector<std::filesystem::path> all = scripts();
  EXPECT_GE(all.size(), 20u);
  for (const std::filesystem::path& script : all) {
    SCOPED_TRACE(script.stem().string());
    const Left skipping = left_of(script, {}), stepping = left_of(script, {"--step-every-clock"});
    expect_same(skipping.vcd, stepping.vcd, "trace with every clock stepped");
    expect_same(skipping.profile, stepping.profile, "profile with every clock stepped");
    EXPECT_EQ(skipping.summary, stepping.summary);
    EXPECT_EQ(skipping.said, stepping.said);
  }
}

// Runs without a script end at any given time.
TEST_F(ChipImages, EndInTheSameCycleAtAnyEndTime) {
  for (int i = 0; i < test_ends; ++i) {
    const std::string until = std::to_string(10'600'000 + 937 * i) + "ns";
    const std::filesystem::path image =
        std::filesystem::path(lamplock::test::in_build("images")) / "nested.uf2";
    std::vector<std::string> options{"--until", until};
    options.insert(options.end(), vcd_.begin(), vcd_.end());
    const Left skipping = left(image, {}, options);
    options.emplace_back("--step-every-clock");
    const Left stepping = left(image, {}, options);
    SCOPED_TRACE(until);
    expect_same(skipping.vcd, stepping.vcd, "trace with every clock stepped");
    EXPECT_EQ(skipping.summary, stepping.summary);
  }
}

}  // namespace
}  // namespace lamplock::cli::test

#endif  // LAMPLOCK_HAS_FIRMWARE
