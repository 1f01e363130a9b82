// A board on a bus, from its firmware to its boot loader and back, in time that only waiting moves.
//
// In:  what the program asks of bus and port. Out: a board that runs lamplock while its flash
// starts,
//      a loader while it does not, or after `$BOOT`.
// Who: tests of whole updates.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host/flash/board_ports.hpp"
#include "host/usb/usb.hpp"
#include "tests/flash/images.hpp"
#include "tests/flash/loader_model.hpp"

namespace lamplock::flash::test {

/// One board and its flash.
struct BoardModel {
  std::string place = "1-4", serial = "A1";
  FlashModel flash{};
  LoaderFaults faults{};                    ///< of its loader
  std::string status = "Idle";              ///< what it answers to '?'; empty: nothing
  std::chrono::milliseconds heard_from{0};  ///< it answers nothing before
  std::chrono::milliseconds port_goes_at = std::chrono::milliseconds::max();
  int boot_error = 0;             ///< its answer to `$BOOT`; 0: goes
  std::string problem{};          ///< the board may not be opened
  std::string loader_problem{};   ///< the loader may not be opened
  bool stream_taken = false;      ///< another program has its pulse stream
  bool stream_held = false;       ///< the program that flashes has it
  bool sent_with_stream = false;  ///< it had it when it sent the board to its loader
  bool tells_version = true;
  bool firmware_starts = true;  ///< otherwise the image finds itself broken and enters the loader

  std::filesystem::path drive{};  ///< where the loader's drive is mounted; empty: nowhere

  bool in_loader = false;
  std::chrono::milliseconds back_at{0};  ///< not on the bus before
  std::vector<std::string> heard{};      ///< lines and real-time bytes

  bool runs() const { return !in_loader && firmware_starts && starts(flash.bytes); }
};

/// A bus with boards. Restarts take 300 ms.
class BusModel final : public usb::Bus {
 public:
  std::vector<BoardModel> boards = std::vector<BoardModel>(1);

  std::vector<usb::DeviceInfo> devices() override;
  std::unique_ptr<usb::Device> open(const usb::DeviceInfo& device) override;
  void sleep(std::chrono::milliseconds time) override;
  std::chrono::milliseconds now() override { return now_; }

  BoardModel& at(const std::string& place);
  void restart(BoardModel& board, bool into_loader);

 private:
  std::chrono::milliseconds now_{0};
};

/// The ports of its boards.
class PortsModel final : public BoardPorts {
 public:
  explicit PortsModel(BusModel& bus) : bus_(bus) {}
  std::string name(const usb::DeviceInfo& board) override { return "/dev/port" + board.place; }
  std::unique_ptr<link::Transport> open(const usb::DeviceInfo& board) override;

 private:
  BusModel& bus_;
};

}  // namespace lamplock::flash::test
