// RUN and BOOTSEL: the order of events at the pins, and that they are released.
#include "host/gpio/board_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <thread>

#include "host/error.hpp"
#include "tests/error_of.hpp"
#include "tests/gpio/model_lines.hpp"

namespace lamplock::gpio {
namespace {

using namespace std::chrono_literals;
using test::ModelLines;
using test::ModelPins;
using testing::ElementsAre;
using testing::HasSubstr;

LineTable both_pins() {
  LineTable table;
  table.run = LineRequest{.place = "RUN", .active_low = true, .drive = Drive::open_drain};
  table.bootsel = LineRequest{.place = "BOOT", .active_low = true, .drive = Drive::open_drain};
  return table;
}

/// A board with two pulled-up pins, and a log of events at them.
struct Board {
  Board() {
    pins->pins["RUN"].level = pins->pins["BOOT"].level = true;
    pins->on_output = [this](const std::string& place, bool level) {
      log.push_back(place + (level ? " up" : " down"));
    };
  }
  Sleep sleep() {
    return [this](std::chrono::milliseconds time) {
      log.push_back(std::to_string(time.count()) + " ms");
      if (--naps_until_unplugged == 0) pins->unplug("RUN");
    };
  }

  std::shared_ptr<ModelPins> pins = std::make_shared<ModelPins>();
  ModelLines lines{pins};
  std::vector<std::string> log{};
  int naps_until_unplugged = 0;
};

TEST(BoardLines, ResetPulsesRun) {
  Board board;
  reset_board(board.lines, both_pins(), board.sleep());
  EXPECT_THAT(board.log, ElementsAre("RUN down", "20 ms", "RUN up"));
  EXPECT_FALSE(board.pins->requested("RUN"));
}

TEST(BoardLines, TheLoaderIsEnteredWithBootselLowDuringTheReset) {
  Board board;
  enter_loader(board.lines, both_pins(), board.sleep());
  EXPECT_THAT(board.log,
              ElementsAre("BOOT down", "RUN down", "20 ms", "RUN up", "500 ms", "BOOT up"));
  EXPECT_FALSE(board.pins->requested("BOOT"));
}

TEST(BoardLines, ALostLineIsReportedAndTheOtherIsReleased) {
  Board board;
  board.naps_until_unplugged = 1;
  EXPECT_THROW(enter_loader(board.lines, both_pins(), board.sleep()), Error);
  EXPECT_THAT(board.log, ElementsAre("BOOT down", "RUN down", "20 ms", "BOOT up"));
}

/// Signals by which a terminal, a shell or the system ends or stops a program, in any thread.
constexpr std::array outside{SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP, SIGPIPE};

/// The handler in force before and after: records the levels of the pins when the signal arrives.
std::atomic<int> got_through{0};
std::atomic<bool> run_was_up{false};
ModelPins* watched_pins = nullptr;
void get_through(int) {
  ++got_through;
  run_was_up = watched_pins->level("RUN") && watched_pins->level("BOOT");
}

TEST(BoardLines, SignalsWaitUntilThePinsAreReleased) {
  for (const int signal : outside) {
    for (const auto pull : {reset_board, enter_loader}) {
      Board board;
      watched_pins = board.pins.get();
      got_through = 0;
      const auto before = std::signal(signal, get_through);
      pull(board.lines, both_pins(), [&](std::chrono::milliseconds) {
        EXPECT_FALSE(board.pins->level("RUN") && board.pins->level("BOOT"));
        std::thread([signal] { ::raise(signal); }).join();
        ::raise(signal);
        EXPECT_EQ(got_through, 0) << signal;
      });
      EXPECT_EQ(got_through, 1) << signal;
      EXPECT_TRUE(run_was_up) << signal;
      ::raise(signal);
      EXPECT_EQ(got_through, 2) << "the old handler is restored";
      std::signal(signal, before);
    }
  }
}

TEST(BoardLines, AnErrorAfterASignalReleasesThePins) {
  Board board;
  watched_pins = board.pins.get();
  got_through = 0;
  const auto before = std::signal(SIGTERM, get_through);
  const Sleep fails = [](std::chrono::milliseconds) {
    ::raise(SIGTERM);
    throw Error(Exit::no_device, "test", "fails", "nothing");
  };
  EXPECT_THROW(enter_loader(board.lines, both_pins(), fails), Error);
  EXPECT_EQ(got_through, 1);
  EXPECT_TRUE(run_was_up);
  std::signal(SIGTERM, before);
}

TEST(BoardLines, AnIgnoredSignalStaysIgnored) {
  Board board;
  const auto before = std::signal(SIGHUP, SIG_IGN);
  reset_board(board.lines, both_pins(), [](std::chrono::milliseconds) { ::raise(SIGHUP); });
  EXPECT_EQ(std::signal(SIGHUP, before), SIG_IGN);
}

/// Without a handler the program ends, but only after the pulse.
TEST(BoardLinesDeathTest, TheProgramEndsWhenTheBoardIsOutOfReset) {
  const auto reset_and_kill = [](int signal) {
    Board board;
    board.pins->on_output = [](const std::string& place, bool level) {
      std::fprintf(stderr, "%s %s, ", place.c_str(), level ? "up" : "down");
    };
    std::signal(signal, SIG_DFL);
    enter_loader(board.lines, both_pins(),
                 [signal](std::chrono::milliseconds) { ::kill(::getpid(), signal); });
    ::_exit(0);
  };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(reset_and_kill(signal), testing::KilledBySignal(signal),
                "BOOT down, RUN down, RUN up, BOOT up");
  }
}

TEST(BoardLines, NoPinIsDrivenWithoutBothPins) {
  Board board;
  LineTable table = both_pins();
  table.run.reset();
  EXPECT_THAT(test::error_of([&] { enter_loader(board.lines, table, board.sleep()); }),
              HasSubstr("RUN pin; wire one and add [run]"));
  table = both_pins();
  table.bootsel.reset();
  EXPECT_THAT(test::error_of([&] { enter_loader(board.lines, table, board.sleep()); }),
              HasSubstr("[bootsel]"));
  EXPECT_TRUE(board.log.empty());
  board.pins->unplug("RUN");
  EXPECT_THROW(reset_board(board.lines, both_pins(), board.sleep()), Error);
}

}  // namespace
}  // namespace lamplock::gpio
