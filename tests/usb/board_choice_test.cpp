// `--board auto` and `usb` on an emulated computer: the chosen connection and the messages.
#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <string>

#include "host/error.hpp"
#include "host/link/serial_transport.hpp"
#include "host/link/usb_transport.hpp"
#include "host/run/board_port.hpp"
#include "tests/usb/as_nobody.hpp"
#include "tests/usb/bulk_device.hpp"
#include "tests/usb/emulated_usb.hpp"

namespace lamplock::usb {
namespace {

using test::BulkDevice;
using test::EmulatedDevice;
using test::EmulatedUsb;
using testing::AllOf;
using testing::HasSubstr;
using testing::MatchesRegex;

enum class Way { stream, port, none };

struct Choice {
  Way way = Way::none;
  Exit exit = Exit::done;
  std::string said{};  ///< output on stderr, or the error
};

Choice choose(const std::string& board) {
  Choice choice;
  testing::internal::CaptureStderr();
  try {
    const auto transport = run::open_board(board);
    if (dynamic_cast<link::UsbTransport*>(transport.get()) != nullptr) choice.way = Way::stream;
    if (dynamic_cast<link::SerialTransport*>(transport.get()) != nullptr) choice.way = Way::port;
    choice.said = testing::internal::GetCapturedStderr();
  } catch (const Error& error) {
    testing::internal::GetCapturedStderr();
    choice.exit = error.exit();
    choice.said = std::string(error.what()) + "\n";
  }
  return choice;
}

class BoardChoiceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::can_be_emulated()) GTEST_SKIP() << "umockdev's library is not preloaded";
    usb_ = std::make_unique<EmulatedUsb>();
  }
  void plug(const EmulatedDevice& board, BulkDevice& device) {
    usb_->attach(board, device);
    usb_->add(board);
    usb_->set_node(board, device.node());
    std::filesystem::permissions(usb_->real_path(node), std::filesystem::perms::all);
  }
  void add_port(const EmulatedDevice& board) {
    usb_->add_below(board, 0, "tty", "tty/ttyACM0", "ttyACM0");
    std::filesystem::permissions(usb_->real_path(port), std::filesystem::perms::all);
  }

  static constexpr const char* node = "/dev/bus/usb/001/006";
  static constexpr const char* port = "/dev/ttyACM0";
  BulkDevice device_, other_;
  std::unique_ptr<EmulatedUsb> usb_;
};

TEST_F(BoardChoiceTest, ThePulseStreamIsUsedWherePermitted) {
  const EmulatedDevice board = test::emulated_board();
  plug(board, device_);
  for (const bool with_port : {false, true}) {
    if (with_port) add_port(board);
    const Choice choice = choose("auto");
    EXPECT_EQ(choice.way, Way::stream) << choice.said;
    EXPECT_THAT(choice.said, MatchesRegex("[^\n]+\n")) << "one line";
    EXPECT_THAT(choice.said, AllOf(HasSubstr(board.serial), HasSubstr("pulse stream")));
    EXPECT_FALSE(device_.claimed()) << "the interface was not released";
  }
  EXPECT_EQ(choose("usb").way, Way::stream);
  EXPECT_EQ(choose("usb:" + board.serial).way, Way::stream);
  EXPECT_EQ(choose("usb").said, "");
}

TEST_F(BoardChoiceTest, OldFirmwareIsReachedOverItsPort) {
  const EmulatedDevice board = test::emulated_old_board();
  plug(board, device_);
  EXPECT_THAT(choose("auto").said, HasSubstr("no pulse stream interface"))
      << "there is no port either";
  add_port(board);
  const Choice choice = choose("auto");
  EXPECT_EQ(choice.way, Way::port) << choice.said;
  EXPECT_THAT(choice.said, MatchesRegex("warning: [^\n]+\n"));
  EXPECT_THAT(choice.said,
              AllOf(HasSubstr("no pulse stream interface"), HasSubstr("lamplock flash"),
                    HasSubstr("talking over /dev/ttyACM0")));
  const Choice named = choose("usb");
  EXPECT_EQ(named.way, Way::none) << "usb excludes the port";
  EXPECT_EQ(named.exit, Exit::no_device);
}

TEST_F(BoardChoiceTest, AMissingNodeLeavesThePort) {
  const EmulatedDevice board = test::emulated_board();
  plug(board, device_);
  add_port(board);
  std::filesystem::remove(usb_->real_path(node));
  const Choice choice = choose("auto");
  EXPECT_EQ(choice.way, Way::port) << choice.said;
  EXPECT_THAT(choice.said, MatchesRegex("warning: [^\n]+\n"));
  EXPECT_THAT(choice.said, AllOf(HasSubstr(node), HasSubstr("talking over /dev/ttyACM0")));
  std::filesystem::remove(usb_->real_path(port));
  const Choice neither = choose("auto");
  EXPECT_EQ(neither.way, Way::none);
  EXPECT_EQ(neither.exit, Exit::no_device);
}

TEST_F(BoardChoiceTest, WithoutPermissionThePortIsUsed) {
  const EmulatedDevice board = test::emulated_board();
  usb_->add(board);  // its calls need no handler
  add_port(board);
  std::filesystem::permissions(usb_->real_path(node), std::filesystem::perms::none);
  // 0: as expected; otherwise the number of the first failed check.
  EXPECT_EQ(test::as_nobody([] {
              const Choice choice = choose("auto");
              if (choice.way != Way::port) return 1;
              if (choice.said.find("no permission to use") == std::string::npos) return 2;
              if (choice.said.find("60-lamplock.rules") == std::string::npos) return 3;
              return choice.said.find("talking over /dev/ttyACM0") == std::string::npos ? 4 : 0;
            }),
            0);
  EXPECT_EQ(test::as_nobody([] {
              const Choice choice = choose("usb");
              if (choice.way != Way::none || choice.exit != Exit::no_device) return 1;
              return choice.said.find("60-lamplock.rules") == std::string::npos ? 2 : 0;
            }),
            0);
}

/// A job may be running over the stream, so the program must not use the port meanwhile.
TEST_F(BoardChoiceTest, AStreamInUseByAnotherProgramIsAnError) {
  const EmulatedDevice board = test::emulated_board();
  plug(board, device_);
  add_port(board);
  device_.set_busy(true);
  const Choice choice = choose("auto");
  EXPECT_EQ(choice.way, Way::none);
  EXPECT_EQ(choice.exit, Exit::no_device);
  EXPECT_THAT(choice.said, MatchesRegex("error: [^\n]+; [^\n]+\n"));
  EXPECT_THAT(choice.said, HasSubstr("another program"));
  device_.set_busy(false);
  EXPECT_EQ(choose("auto").way, Way::stream);
}

TEST_F(BoardChoiceTest, OneOfSeveralBoardsHasToBeNamed) {
  EXPECT_THAT(choose("auto").said, HasSubstr("there is no board"));
  const EmulatedDevice first = test::emulated_board();
  EmulatedDevice second = first;
  second.place = "1-3";
  second.address = 9;
  second.serial = "E661640843322A2C";
  plug(first, device_);
  plug(second, other_);
  for (const std::string name : {"auto", "usb"}) {
    const Choice choice = choose(name);
    EXPECT_EQ(choice.way, Way::none);
    EXPECT_EQ(choice.exit, Exit::bad_input);
    EXPECT_THAT(choice.said, AllOf(HasSubstr(first.serial), HasSubstr(second.serial),
                                   HasSubstr("--board usb:SERIAL")));
  }
  EXPECT_EQ(choose("usb:" + second.serial).way, Way::stream);
  EXPECT_EQ(choose("usb:E6").exit, Exit::no_device);
}

}  // namespace
}  // namespace lamplock::usb
