// Whole updates: the choice of the board, whether it may be stopped now, and the errors if it does
// not come back.
#include "host/flash/update.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "tests/flash/board_model.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::flash {
namespace {

namespace fs = std::filesystem;
using test::BoardModel;

class UpdateTest : public testing::Test {
 protected:
  UpdateTest() { put(bus_.boards.front(), old_); }

  /// Writes an image directly, as the factory does.
  static void put(BoardModel& board, const FlashImage& image) {
    for (const Sector& sector : image.sectors)
      std::copy(sector.bytes.begin(), sector.bytes.end(),
                board.flash.bytes.begin() + (sector.address - flash_base));
  }
  static std::string version_of(const FlashImage& image) {
    return "1." + std::to_string(image.sectors.front().bytes[251]) + ":";
  }
  UpdateReport update(const std::string& serial = "") {
    return Update({bus_, ports_, roots_, write_through, pull_}, image_, {}).run(serial);
  }
  /// The text of the error that an update must end with.
  std::string refused(Exit exit, const std::string& serial = "") {
    try {
      update(serial);
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), exit) << error.what();
      return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
  }
  BoardModel& board() { return bus_.boards.front(); }
  /// Puts the board in its boot loader with its drive mounted.
  void mount(const std::filesystem::path& drive) {
    std::filesystem::create_directories(drive);
    write_file(drive / "INFO_UF2.TXT", "Board-ID: RPI-RP2\r\n");
    board().drive = drive;
    board().in_loader = true;
  }

  FlashImage old_ = test::noise_image(9'000, 1), image_ = test::noise_image(12'000, 2);
  test::BusModel bus_;
  test::PortsModel ports_{bus_};
  std::vector<std::filesystem::path> roots_;
  std::function<void()> pull_{};
};

TEST_F(UpdateTest, RunningBoardGetsTheImageAndReportsItsVersion) {
  const UpdateReport report = update();
  EXPECT_TRUE(test::holds(board().flash.bytes, image_));
  EXPECT_EQ(report.version_before, version_of(old_));
  EXPECT_EQ(report.version, version_of(image_));
  EXPECT_EQ(report.port, "/dev/port1-4");
  EXPECT_EQ(report.board.serial, "A1");
  ASSERT_TRUE(report.flash.has_value());
  EXPECT_EQ(report.flash->written, 3u);
  EXPECT_EQ(board().heard.front(), "?") << "the board's state must be asked first";
}

TEST_F(UpdateTest, BoardInItsLoaderGetsIt) {
  board().in_loader = true;
  const UpdateReport report = update();
  EXPECT_EQ(report.version_before, "");
  EXPECT_EQ(report.version, version_of(image_));
  // A board with an empty flash gets the image too.
  board() = {};
  EXPECT_EQ(update().version, version_of(image_));
}

/// An image of another board may short outputs. In the loader no board is known.
TEST_F(UpdateTest, TheImageOfAnotherBoardIsRefused) {
  const auto update_for = [&](const std::string& name) {
    return Update({bus_, ports_, roots_, write_through, pull_}, image_, {}).run("", name);
  };
  board().name = "lamplock skr-pico";
  try {
    update_for("pico");
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::bad_input);
    EXPECT_EQ(error.message(),
              "lamplock board A1 (USB 1-4): runs the image of a board skr-pico, not of pico; "
              "flash --for skr-pico; if it is a pico, hold BOOTSEL while plugging it in, then "
              "flash again");
  }
  EXPECT_TRUE(board().heard.empty());
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
  EXPECT_EQ(update_for("skr-pico").version, version_of(image_));
  for (const char* unknown : {"lamplock laser controller", "lamplock later-board", ""}) {
    put(board(), old_);
    board().name = unknown;
    EXPECT_EQ(update_for("pico").version, version_of(image_)) << unknown;
  }
  put(board(), old_);
  board().name = "lamplock skr-pico";
  board().in_loader = true;
  EXPECT_EQ(update_for("pico").version, version_of(image_));
}

TEST_F(UpdateTest, NothingIsDoneWhileTheBoardWorks) {
  for (const char* status : {"Run", "Hold:0", "Door:1", "Jog", "Home", "Check", "Sleep"}) {
    board().status = status;
    board().heard.clear();
    const std::string text = refused(Exit::job_failed);
    const std::string state = std::string(status).substr(0, std::string(status).find(':'));
    EXPECT_NE(text.find("is not idle (" + state + ")"), std::string::npos) << text;
    for (const std::string& heard : board().heard) EXPECT_EQ(heard, "?") << status;
    EXPECT_TRUE(test::holds(board().flash.bytes, old_));
  }
  board().status = "Alarm";
  EXPECT_EQ(update().version, version_of(image_)) << "an alarm does not prevent an update";
}

TEST_F(UpdateTest, ABoardThatRefusesOrIsSilentIsNotChanged) {
  board().boot_error = 8;
  EXPECT_NE(refused(Exit::job_failed).find("error:8"), std::string::npos);
  board().boot_error = 0;
  board().status = "";
  EXPECT_NE(refused(Exit::no_device).find("does not answer"), std::string::npos);
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
}

TEST_F(UpdateTest, NothingIsSentWhileAnotherProgramHasThePulseStream) {
  board().stream_taken = true;
  // While a job runs over it, the firmware does not answer at its serial port.
  for (const char* status : {"", "Idle", "Run"}) {
    board().status = status;
    const std::string text = refused(Exit::job_failed);
    EXPECT_NE(text.find("pulse stream"), std::string::npos) << text;
    EXPECT_EQ(text.find("BOOTSEL"), std::string::npos) << text;
    EXPECT_TRUE(board().heard.empty());
    EXPECT_TRUE(test::holds(board().flash.bytes, old_));
  }
  board().stream_taken = false;
  board().status = "Idle";
  EXPECT_EQ(update().version, version_of(image_));
  EXPECT_TRUE(board().sent_with_stream) << "otherwise a job could begin meanwhile";
  EXPECT_FALSE(board().stream_held);
}

TEST_F(UpdateTest, ARunningBoardIsNotToBeUnplugged) {
  board().status = "";
  EXPECT_EQ(refused(Exit::no_device).find("BOOTSEL"), std::string::npos);
  board().status = "Idle";
  board().boot_error = 8;
  EXPECT_EQ(refused(Exit::job_failed).find("BOOTSEL"), std::string::npos);
}

TEST_F(UpdateTest, WithoutPermissionTheBoardIsNotStopped) {
  board().problem = board().loader_problem = "no permission to use /dev/bus/usb/001/005";
  // No folder where a drive could be mounted.
  const std::string text = refused(Exit::no_device);
  EXPECT_NE(text.find("no permission"), std::string::npos) << text;
  EXPECT_TRUE(board().heard.empty());
  // A second loader whose drive cannot be distinguished from that of the first.
  const lamplock::test::TemporaryFolder folder;
  roots_ = {folder.file("")};
  bus_.boards.resize(2);
  bus_.boards[1].place = "1-5";
  bus_.boards[1].serial = "B1";
  EXPECT_NE(refused(Exit::bad_input, "A1").find("cannot be distinguished"), std::string::npos);
  EXPECT_TRUE(board().heard.empty());
  // The drive does not appear; the error says in which state the board was left.
  bus_.boards.resize(1);
  const std::string waits = refused(Exit::no_device);
  EXPECT_NE(waits.find("waits in its boot loader"), std::string::npos) << waits;
  EXPECT_NE(waits.find("old firmware"), std::string::npos) << waits;
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
}

TEST_F(UpdateTest, AVersionThatIsNotReportedIsNotConfirmed) {
  EXPECT_TRUE(update().confirmed());
  board().tells_version = false;
  board().in_loader = true;
  const UpdateReport report = update();
  EXPECT_FALSE(report.confirmed());
  EXPECT_FALSE(report.version_problem.empty());
}

TEST_F(UpdateTest, SeveralBoardsAreChosenBySerialNumber) {
  bus_.boards.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    bus_.boards[i].place = "1-" + std::to_string(i + 1);
    bus_.boards[i].serial = std::string(1, static_cast<char>('A' + i)) + "1";
    put(bus_.boards[i], old_);
  }
  const std::string several = refused(Exit::bad_input);
  for (const char* word : {"A1 (USB 1-1)", "B1 (USB 1-2)", "C1 (USB 1-3)", "--serial"}) {
    EXPECT_NE(several.find(word), std::string::npos) << several;
  }
  const std::string wrong = refused(Exit::no_device, "D1");
  EXPECT_NE(wrong.find("B1 (USB 1-2)"), std::string::npos) << wrong;
  EXPECT_EQ(update("B1").board.place, "1-2");
  EXPECT_TRUE(test::holds(bus_.boards[0].flash.bytes, old_));
  EXPECT_TRUE(test::holds(bus_.boards[1].flash.bytes, image_));
  EXPECT_TRUE(test::holds(bus_.boards[2].flash.bytes, old_));
  bus_.boards.clear();
  EXPECT_NE(refused(Exit::no_device).find("no board is plugged in"), std::string::npos);
}

TEST_F(UpdateTest, ABoardThatDoesNotComeBackIsAnError) {
  board().firmware_starts = false;
  board().in_loader = true;
  EXPECT_NE(refused(Exit::job_failed).find("does not start it"), std::string::npos);
  // The board is still in its loader; an interrupted write is reported and can be repeated.
  board().firmware_starts = true;
  board().faults.cut_at = 300;
  board().in_loader = true;
  put(board(), old_);
  EXPECT_NE(refused(Exit::no_device).find("unplugged"), std::string::npos);
  board().faults = {};
  EXPECT_EQ(update().version, version_of(image_));
}

/// RUN and BOOTSEL of the first board are wired to GPIO lines of the computer.
class UpdateByLines : public UpdateTest {
 protected:
  UpdateByLines() {
    pull_ = [this] {
      ++pulled_;
      bus_.restart(board(), !bootsel_broken_);
      board().status = "Idle";  // it was the old firmware that was silent
    };
  }
  void unplug() { board().back_at = std::chrono::hours(1); }
  int pulled_ = 0;
  bool bootsel_broken_ = false;
};

TEST_F(UpdateByLines, ABoardThatIsSilentIsResetIntoItsLoader) {
  board().status = "";
  EXPECT_EQ(update().version, version_of(image_));
  EXPECT_EQ(pulled_, 1);
  EXPECT_TRUE(test::holds(board().flash.bytes, image_));
}

TEST_F(UpdateByLines, ABoardThatIsNotOnTheBusIsResetToo) {
  unplug();
  const UpdateReport report = update();
  EXPECT_EQ(report.version, version_of(image_));
  EXPECT_EQ(report.version_before, "");
  EXPECT_EQ(pulled_, 1);
}

TEST_F(UpdateByLines, TheLinesAreNotUsedWhereUnnecessary) {
  update();
  board().in_loader = true;
  update();
  EXPECT_EQ(pulled_, 0);
}

/// A board that answers is not reset by the lines, whether it is working or refuses the update.
TEST_F(UpdateByLines, ABoardThatAnswersIsNeverReset) {
  for (const char* status : {"Run", "Hold:0", "Jog", "Home"}) {
    board().status = status;
    refused(Exit::job_failed);
  }
  board().status = "Idle";
  board().boot_error = 8;
  refused(Exit::job_failed);
  EXPECT_EQ(pulled_, 0);
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
}

/// Silence at the port does not prove a hang while a job may run over the pulse stream: access may
/// be denied, the job's host may just have died, or the port may just have disappeared.
TEST_F(UpdateByLines, ABoardThatMayBeWorkingIsNeverReset) {
  board().status = "";
  board().problem = "no permission to use /dev/bus/usb/001/004";
  const lamplock::test::TemporaryFolder folder;
  roots_ = {folder.file("")};
  refused(Exit::no_device);
  board().problem = "";
  board().status = "Hold:0";
  board().heard_from = bus_.now() + std::chrono::seconds(10);
  refused(Exit::job_failed);
  board().status = "";
  board().port_goes_at = bus_.now() + std::chrono::seconds(1);
  refused(Exit::job_failed);
  EXPECT_EQ(pulled_, 0);
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
}

/// It is unknown which of several boards is wired to the lines, and the other one may be working.
TEST_F(UpdateByLines, TheLinesAreNotUsedIfTheBoardMayBeAnother) {
  bus_.boards.resize(2);
  bus_.boards[1].place = "1-5";
  bus_.boards[1].serial = "B1";
  put(bus_.boards[1], old_);
  bus_.boards[1].status = "";
  EXPECT_NE(refused(Exit::no_device, "B1").find("does not answer"), std::string::npos);
  refused(Exit::bad_input);
  refused(Exit::no_device, "C1");
  bus_.boards.pop_back();
  unplug();
  EXPECT_NE(refused(Exit::no_device, "A1").find("no board is plugged in"), std::string::npos);
  EXPECT_EQ(pulled_, 0);
}

TEST_F(UpdateByLines, ALoaderThatDoesNotAppearIsAnError) {
  bootsel_broken_ = true;
  board().status = "";
  EXPECT_NE(refused(Exit::no_device).find("did not start at USB 1-4"), std::string::npos);
  unplug();
  EXPECT_NE(refused(Exit::no_device).find("boot loader: did not start"), std::string::npos);
  unplug();
  pull_ = [] { throw Error(Exit::no_device, "GPIO24", "is used by another", "end it"); };
  EXPECT_NE(refused(Exit::no_device).find("GPIO24"), std::string::npos);
  pull_ = [] {};
  EXPECT_NE(refused(Exit::no_device).find("no board is plugged in"), std::string::npos);
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
}

TEST_F(UpdateTest, WithoutPermissionTheDriveIsUsedOrTheRemedyIsNamed) {
  const lamplock::test::TemporaryFolder folder;
  roots_ = {folder.file("media")};
  board().loader_problem = "no permission to use /dev/bus/usb/001/005; install 60-lamplock.rules";
  board().in_loader = true;
  const std::string text = refused(Exit::no_device);
  EXPECT_NE(text.find("60-lamplock.rules"), std::string::npos) << text;
  EXPECT_NE(text.find("--drive"), std::string::npos) << text;
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));

  mount(folder.file("media/user/RPI-RP2"));
  const UpdateReport report = update();
  EXPECT_EQ(report.drive, folder.file("media/user/RPI-RP2"));
  EXPECT_FALSE(report.flash.has_value());
  EXPECT_EQ(report.version, version_of(image_));
  EXPECT_TRUE(test::holds(board().flash.bytes, image_));
}

TEST_F(UpdateTest, AGivenDriveNeedsNoBus) {
  const lamplock::test::TemporaryFolder folder;
  mount(folder.file("drive"));
  const UpdateReport report = Update({bus_, ports_}, image_, {}).run_on_drive(folder.file("drive"));
  EXPECT_EQ(report.version, version_of(image_));
  EXPECT_EQ(report.board.place, "1-4");
  // The board does not appear again: the completed copy counts as success.
  mount(folder.file("drive"));
  board().firmware_starts = false;
  const UpdateReport unseen = Update({bus_, ports_}, old_, {}).run_on_drive(folder.file("drive"));
  EXPECT_NE(unseen.version_problem.find("no new board"), std::string::npos);
  EXPECT_TRUE(unseen.confirmed()) << "no board is left to ask";
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
}

/// A board in its loader whose drive is written; at the end the system reports that the drive is
/// gone.
class BrokenCopyTest : public UpdateTest {
 protected:
  BrokenCopyTest() { mount(drive_); }
  static std::error_code gone() { return {EIO, std::generic_category()}; }
  /// Writes only the first `size` bytes.
  static void write_part(const fs::path& file, std::string_view bytes, std::size_t size) {
    EXPECT_FALSE(write_through(file, bytes.substr(0, size)));
  }
  void pull_cable() {
    fs::remove_all(drive_);
    board().back_at = std::chrono::hours(1);
  }
  UpdateReport copy(const WriteFile& write) {
    return Update({bus_, ports_, {}, write}, image_, {}).run_on_drive(drive_);
  }
  /// The same with a drive that is found automatically because USB access to the loader is denied.
  UpdateReport copy_for_want_of_permission(const WriteFile& write) {
    board().loader_problem = "no permission";
    return Update({bus_, ports_, {folder_.file("media")}, write}, image_, {}).run("");
  }
  /// The errors of both ways where a copy must fail.
  std::vector<std::string> both_refused(const WriteFile& write) {
    std::vector<std::string> texts;
    for (const auto way : {&BrokenCopyTest::copy, &BrokenCopyTest::copy_for_want_of_permission}) {
      board() = {};
      put(board(), old_);
      mount(drive_);
      try {
        (this->*way)(write);
        ADD_FAILURE() << "no error";
      } catch (const Error& error) {
        EXPECT_EQ(error.exit(), Exit::job_failed) << error.what();
        texts.emplace_back(error.message());
      }
    }
    return texts;
  }

  lamplock::test::TemporaryFolder folder_;
  const fs::path drive_ = folder_.file("media/RPI-RP2");
};

TEST_F(BrokenCopyTest, IsSuccessIfTheBoardIsSeenAgain) {
  // The board restarts within the last write; all data has arrived.
  const WriteFile restarts = [this](const fs::path& file, std::string_view bytes) {
    write_part(file, bytes, bytes.size());
    bus_.sleep(std::chrono::milliseconds(0));
    EXPECT_FALSE(fs::exists(drive_));
    return gone();
  };
  EXPECT_EQ(copy(restarts).version, version_of(image_));
  board() = {};
  put(board(), old_);
  mount(drive_);
  EXPECT_EQ(copy_for_want_of_permission(restarts).version, version_of(image_));
}

TEST_F(BrokenCopyTest, IsAnErrorIfTheBoardIsNotSeenAgain) {
  for (const std::string& text : both_refused([this](const fs::path&file, std::string_view bytes) {
         write_part(file, bytes, bytes.size() / 2);
         pull_cable();
         return gone();
       })) {
    EXPECT_NE(text.find("broke off"), std::string::npos) << text;
    EXPECT_NE(text.find("BOOTSEL"), std::string::npos) << text;
    EXPECT_EQ(text.find("has the image"), std::string::npos) << text;
  }
}

TEST_F(BrokenCopyTest, IsAnErrorIfTheBoardComesUpInItsLoader) {
  for (const std::string& text : both_refused([this](const fs::path&file, std::string_view bytes) {
         write_part(file, bytes, bytes.size() / 2);
         pull_cable();
         board().back_at = bus_.now() + std::chrono::seconds(1);
         return gone();
       })) {
    EXPECT_NE(text.find("broke off"), std::string::npos) << text;
    EXPECT_EQ(text.find("has the image"), std::string::npos) << text;
  }
}

// Half of the file is written and the drive is still there: the loader waits for the rest.
TEST_F(BrokenCopyTest, IsAnErrorIfTheDriveStays) {
  for (const std::string& text : both_refused([](const fs::path&file, std::string_view bytes) {
         write_part(file, bytes, bytes.size() / 2);
         return gone();
       }))
    EXPECT_NE(text.find("the copy failed"), std::string::npos) << text;
  for (const int why : {EACCES, EROFS, ENOSPC}) {
    const std::error_code error(why, std::generic_category());
    for (const std::string& text :
         both_refused([error](const fs::path&, std::string_view) { return error; })) {
      EXPECT_NE(text.find("cannot write to the drive: " + error.message()), std::string::npos)
          << text;
    }
  }
  EXPECT_TRUE(test::holds(board().flash.bytes, old_));
}

}  // namespace
}  // namespace lamplock::flash
