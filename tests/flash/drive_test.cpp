// The drive of the boot loader, simulated by folders.
#include "host/flash/drive.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <iterator>
#include <string>

#include "host/error.hpp"
#include "tests/temporary_folder.hpp"

namespace lamplock::flash {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// The file of an RP2040's ROM (datasheet, 2.8.4.1) and of another chip's.
constexpr const char* info =
    "UF2 Bootloader v3.0\r\nModel: Raspberry Pi RP2\r\nBoard-ID: RPI-RP2\r\n";
constexpr const char* other_info =
    "UF2 Bootloader v1.0\r\nModel: Raspberry Pi RP2350\r\nBoard-ID: RP2350\r\n";

class DriveTest : public testing::Test {
 protected:
  fs::path drive(const std::string& name, const char* text = info) {
    fs::create_directories(folder_.file(name));
    folder_.write(name + "/INFO_UF2.TXT", text);
    return folder_.file(name);
  }
  /// Time advances by sleeping; `write` as given.
  DriveActions actions(std::error_code (*write)(const fs::path&, std::string_view)) {
    DriveActions made;
    made.write = write;
    made.sleep = [this](milliseconds time) {
      now_ += time;
      if (now_ >= leaves_at_) fs::remove_all(folder_.file("media"));
    };
    made.now = [this] { return now_; };
    made.board_is_back = [this] { return now_ >= back_at_; };
    return made;
  }
  std::string refused(Exit exit, const fs::path& folder, const DriveActions& with) {
    try {
      static_cast<void>(copy_to_drive(folder, "uf2", with));
    } catch (const Error& error) {
      EXPECT_EQ(error.exit(), exit);
      return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
  }

  lamplock::test::TemporaryFolder folder_;
  milliseconds now_{0}, leaves_at_{1'000'000}, back_at_{1'000'000};
};

TEST_F(DriveTest, AreFoundBelowTheRootsAndOneFolderFurther) {
  const fs::path direct = drive("mnt/pico"), user = drive("media/user/RPI-RP2");
  drive("media/user/STICK", "Board-ID: STICK\n");
  drive("media/user/RP2350", other_info);
  drive("media/user/deep/down/RPI-RP2");
  fs::create_directories(folder_.file("media/user/empty"));
  EXPECT_EQ(find_loader_drives({folder_.file("media"), folder_.file("mnt"), folder_.file("none")}),
            (std::vector<fs::path>{user, direct}));
}

TEST_F(DriveTest, CopyIsDoneWhenTheDriveHasGone) {
  const fs::path to = drive("media/RPI-RP2");
  leaves_at_ = milliseconds(700);
  std::string copied;
  DriveActions with = actions(write_through);
  with.sleep = [&](milliseconds time) {
    std::ifstream file(to / "LAMPLOCK.UF2", std::ios::binary);
    if (copied.empty()) copied.assign(std::istreambuf_iterator<char>(file), {});
    now_ += time;
    if (now_ >= leaves_at_) fs::remove_all(to);
  };
  EXPECT_FALSE(copy_to_drive(to, "the image", with));
  EXPECT_EQ(copied, "the image");
  EXPECT_GE(now_, leaves_at_);
}

TEST_F(DriveTest, RestartInTheMiddleOfTheLastWriteIsSuccess) {
  const fs::path to = drive("media/RPI-RP2");
  leaves_at_ = milliseconds(300);
  // A cable pulled during the copy looks the same; the caller that waits for the board is notified.
  EXPECT_EQ(copy_to_drive(to, "uf2", actions([](const fs::path&, std::string_view) {
                            return std::error_code(EIO, std::generic_category());
                          })),
            std::errc::io_error);
  // A drive that was mounted by hand may still appear to be present.
  const fs::path stale = drive("mnt/RPI-RP2");
  now_ = milliseconds(0);
  back_at_ = milliseconds(2'000);
  EXPECT_EQ(copy_to_drive(stale, "uf2", actions([](const fs::path&, std::string_view) {
                            return std::error_code(ENODEV, std::generic_category());
                          })),
            std::errc::no_such_device);
  EXPECT_GE(now_, back_at_);
}

TEST_F(DriveTest, ADriveThatStaysIsAnError) {
  const fs::path to = drive("media/RPI-RP2");
  EXPECT_NE(refused(Exit::job_failed, to, actions(write_through)).find("did not restart"),
            std::string::npos);
  const auto broken = [](const fs::path&, std::string_view) {
    return std::error_code(EIO, std::generic_category());
  };
  EXPECT_NE(refused(Exit::job_failed, to, actions(broken)).find("copy failed"), std::string::npos);
  const auto full = [](const fs::path&, std::string_view) {
    return std::error_code(EROFS, std::generic_category());
  };
  EXPECT_NE(refused(Exit::job_failed, to, actions(full)).find("mounted for writing"),
            std::string::npos);
  EXPECT_NE(refused(Exit::no_device, folder_.file("media"), actions(write_through))
                .find("is not the drive"),
            std::string::npos);
}

TEST(WriteThrough, ReturnsTheSystemsError) {
  EXPECT_EQ(write_through("/dev/full", "uf2").value(), ENOSPC);
  EXPECT_EQ(write_through("/nowhere/at/all", "uf2").value(), ENOENT);
  const lamplock::test::TemporaryFolder folder;
  EXPECT_EQ(write_through(folder.file(""), "uf2").value(), EISDIR);
}

/// Limits the size of files meanwhile; the write across the limit is a short one (setrlimit(2),
/// write(2)).
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit now{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FileLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(WriteThrough, AShortWriteIsAnError) {
  const lamplock::test::TemporaryFolder folder;
  std::error_code failure;
  {
    const FileLimit limit(1000);
    failure = write_through(folder.file("file"), std::string(3000, 'x'));
  }
  EXPECT_EQ(failure.value(), EFBIG);
  EXPECT_EQ(fs::file_size(folder.file("file")), 1000u);
}

}  // namespace
}  // namespace lamplock::flash
