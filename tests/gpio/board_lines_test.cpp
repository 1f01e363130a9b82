// RUN and BOOTSEL: the order of what happens at the pins, and that they are let go.
#include "host/gpio/board_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

/// A board at two pins that are pulled up, and what happens to them.
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

TEST(BoardLines, TheLoaderIsEnteredWithBootselDownRoundTheReset) {
  Board board;
  enter_loader(board.lines, both_pins(), board.sleep());
  EXPECT_THAT(board.log,
              ElementsAre("BOOT down", "RUN down", "20 ms", "RUN up", "500 ms", "BOOT up"));
  EXPECT_FALSE(board.pins->requested("BOOT"));
}

TEST(BoardLines, ALineThatIsLostIsToldAndTheOtherIsLetGo) {
  Board board;
  board.naps_until_unplugged = 1;
  EXPECT_THROW(enter_loader(board.lines, both_pins(), board.sleep()), Error);
  EXPECT_THAT(board.log, ElementsAre("BOOT down", "RUN down", "20 ms", "BOOT up"));
}

TEST(BoardLines, NothingIsPulledWithoutBothPins) {
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
