// `flash` and `devices` as a user runs them. These tests must not reach a board that happens to be
// plugged in: the chip is simulated, and the serial numbers do not exist.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "host/flash/uf2.hpp"
#include "tests/cli/program.hpp"
#include "tests/flash/images.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

constexpr const char* no_serial = "no board has this";

TEST(FlashCommand, HasAHelpText) {
  for (const char* command : {"flash", "devices"}) {
    const Finished help = run({command, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.out, HasSubstr(std::string("Example:\n  lamplock ") + command));
    EXPECT_THAT(run({"--help"}).out, HasSubstr(command));
  }
  EXPECT_THAT(run({"flash", "--help"}).out,
              testing::ContainsRegex("--board usb\\|chip +usb: a real board"));
}

/// A valid image, with the bytes that the flash has.
std::string flash_begin() {
  const auto bytes = flash::test::noise_image(4'096, 1).sectors.front().bytes;
  return {bytes.begin(), bytes.end()};
}

TEST(FlashCommand, ImagesAreRefusedBeforeTheSearchForBoards) {
  const Folder folder;
  const std::string good = flash::write_uf2(flash::test::noise_image(9'000, 1));
  const std::vector<std::pair<std::string, std::string>> all = {
      {folder / "missing.uf2", "missing.uf2"},
      {folder.write("half.uf2", good.substr(0, good.size() - 100)), "whole UF2 blocks"},
      {folder.write("lost.uf2", good.substr(0, good.size() - 512)), "block 0: announces"},
      {folder.write("text.uf2", "no image at all"), "neither a UF2 nor an ELF file; give"},
      {folder.write("plain.bin", flash_begin()), "neither a UF2 nor an ELF file; give"},
      {folder.write("empty.uf2", ""), "empty"}};
  for (const auto& [file, words] : all) {
    const Finished refused = run({"flash", file, "--serial", no_serial});
    EXPECT_EQ(refused.status, 2) << file;
    EXPECT_EQ(refused.out, "");
    EXPECT_THAT(refused.err, MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
    EXPECT_THAT(refused.err, HasSubstr(words));
    EXPECT_EQ(refused.err.find("or .bin"), std::string::npos) << refused.err;
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
  EXPECT_EQ(run({"flash", image, "--lines", "x", "--board", "chip"}).status, 2);
  EXPECT_EQ(run({"flash", image, "--board", "virtual"}).status, 2);
}

/// The file is read first.
TEST(FlashCommand, LinesAreValidPinsOrRefused) {
  const Folder folder;
  const std::string image =
      folder.write("good.uf2", flash::write_uf2(flash::test::noise_image(9'000, 1)));
  const std::string none = folder.write("none.toml", "[estop]\nline = \"GPIO17\"\n");
  const Finished missing = run({"flash", image, "--serial", no_serial, "--lines", none});
  EXPECT_EQ(missing.status, 2);
  EXPECT_THAT(missing.err, HasSubstr("names no line for the board's RUN pin"));
  const std::string half = folder.write("half.toml", "[run]\nline = \"GPIO24\"\n");
  EXPECT_THAT(run({"flash", image, "--serial", no_serial, "--lines", half}).err,
              HasSubstr("BOOTSEL pin"));
  EXPECT_EQ(run({"flash", image, "--lines", half, "--drive", "x"}).status, 2);
  const std::string both =
      folder.write("both.toml", "[run]\nline = \"GPIO24\"\n[bootsel]\nline = \"GPIO25\"\n");
  // With a serial number no line is driven for another board.
  EXPECT_EQ(run({"flash", image, "--serial", no_serial, "--lines", both}).status, 3);
}

/// An image of another board may short its outputs.
TEST(FlashCommand, AsksForTheBoardAndNeverGuesses) {
  const Finished unnamed = run({"flash", "--board", "chip"});
  EXPECT_EQ(unnamed.status, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("--for: the board is not named; use one of: pico, picobob"));
  const Finished unknown = run({"flash", "--board", "chip", "--for", "picobob2"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_THAT(unknown.err, HasSubstr("there is no board 'picobob2'; did you mean 'picobob'?"));
  EXPECT_THAT(run({"flash", "--for", "pica"}).err, HasSubstr("did you mean 'pico'?"));
  EXPECT_THAT(run({"flash", "--for", "zz"}).err, HasSubstr("use one of: pico, picobob"));
  EXPECT_EQ(run({"flash", "new.uf2", "--for", "pico"}).status, 2);
}

TEST(DevicesCommand, GivesAListToPrograms) {
  const Finished list = run({"devices", "--json"});
  EXPECT_EQ(list.status, 0) << list.err;
  EXPECT_TRUE(nlohmann::json::parse(list.out).is_array());
}

#ifdef LAMPLOCK_HAS_FIRMWARE
TEST(FlashCommand, SimulatedChipGetsTheFirmwareOfThisBuild) {
  for (const std::string& image :
       {std::string(), lamplock::test::in_build("lamplock-rp2040.uf2")}) {
    std::vector<std::string> arguments = {"flash", "--board", "chip", "--json"};
    if (image.empty())
      arguments.insert(arguments.end(), {"--for", "pico"});
    else
      arguments.push_back(image);
    const Finished flashed = run(arguments);
    ASSERT_EQ(flashed.status, 0) << flashed.err;
    const auto report = nlohmann::json::parse(flashed.out);
    EXPECT_EQ(report["board"], "pico");
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
