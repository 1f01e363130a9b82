// `flash` and `devices` as a user runs them. Nothing here may reach a board that happens to be
// plugged in: the chip is simulated, serial numbers are none.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "host/flash/uf2.hpp"
#include "tests/cli/program.hpp"
#include "tests/flash/images.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

constexpr const char* no_serial = "no board has this";

TEST(FlashCommand, ExplainsItself) {
  for (const char* command : {"flash", "devices"}) {
    const Finished help = run({command, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.out, HasSubstr(std::string("Example:\n  lamplock ") + command));
    EXPECT_THAT(run({"--help"}).out, HasSubstr(command));
  }
  EXPECT_THAT(run({"flash", "--help"}).out, HasSubstr("--board usb|chip=usb "));
}

TEST(FlashCommand, ImagesAreRefusedBeforeAnyBoardIsLookedFor) {
  const Folder folder;
  const std::string good = flash::write_uf2(flash::test::noise_image(9'000, 1));
  const std::vector<std::pair<std::string, std::string>> all = {
      {folder / "missing.uf2", "missing.uf2"},
      {folder.write("half.uf2", good.substr(0, good.size() - 100)), "whole UF2 blocks"},
      {folder.write("lost.uf2", good.substr(0, good.size() - 512)), "block 0: announces"},
      {folder.write("text.uf2", "no image at all"), "ELF"},
      {folder.write("empty.uf2", ""), "empty"}};
  for (const auto& [file, words] : all) {
    const Finished refused = run({"flash", file, "--serial", no_serial});
    EXPECT_EQ(refused.status, 2) << file;
    EXPECT_EQ(refused.out, "");
    EXPECT_THAT(refused.err, MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_THAT(refused.err, HasSubstr(words));
  }
}

TEST(FlashCommand, NoBoardIsStatus3AndWrongUsageStatus2) {
  const Folder folder;
  const std::string image =
      folder.write("good.uf2", flash::write_uf2(flash::test::noise_image(9'000, 1)));
  const Finished none = run({"flash", image, "--serial", no_serial});
  EXPECT_EQ(none.status, 3) << none.err;
  const Finished drive = run({"flash", image, "--drive", folder.path().string()});
  EXPECT_EQ(drive.status, 3);
  EXPECT_THAT(drive.err, HasSubstr("is not the drive"));
  EXPECT_EQ(run({"flash", image, "--drive", "x", "--serial", no_serial}).status, 2);
  EXPECT_EQ(run({"flash", image, "--drive", "x", "--board", "chip"}).status, 2);
  EXPECT_EQ(run({"flash", image, "--board", "virtual"}).status, 2);
}

TEST(DevicesCommand, GivesAListToPrograms) {
  const Finished list = run({"devices", "--json"});
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_TRUE(nlohmann::json::parse(list.out).is_array());
}

#ifdef LAMPLOCK_UF2
TEST(FlashCommand, SimulatedChipGetsTheFirmwareOfThisBuild) {
  for (const std::string image : {"", LAMPLOCK_UF2}) {
    std::vector<std::string> arguments = {"flash", "--board", "chip", "--json"};
    if (!image.empty()) arguments.push_back(image);
    const Finished flashed = run(arguments);
    ASSERT_EQ(flashed.status, 0) << flashed.err;
    const auto report = nlohmann::json::parse(flashed.out);
    EXPECT_EQ(report["way"], "usb");
    EXPECT_GT(report["sectors"], 10);
    EXPECT_EQ(report["written"], report["sectors"]);
    EXPECT_THAT(report["version"].get<std::string>(), HasSubstr("lamplock"));
    EXPECT_TRUE(report["version_before"].is_null());
    EXPECT_THAT(report["serial"].get<std::string>(), MatchesRegex("[0-9A-F]{16}"));
  }
}
#endif

}  // namespace
}  // namespace lamplock::cli::test
