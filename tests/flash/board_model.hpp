// A board on a bus, from its firmware to its boot loader and back, in time that passes only while
// the program waits.
//
// In:  the program's calls to bus and port. Out: a board that runs lamplock if its flash starts, a
//      loader otherwise or after `$BOOT`.
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

struct BoardModel {
  std::string place = "1-4", serial = "A1";
  std::string name{};  ///< the product's text
  FlashModel flash{};
  LoaderFaults faults{};                    ///< faults of its loader
  std::string status = "Idle";              ///< its answer to '?'; empty: no answer
  std::chrono::milliseconds heard_from{0};  ///< no answer before this time
  std::chrono::milliseconds port_goes_at = std::chrono::milliseconds::max();
  int boot_error = 0;             ///< its answer to `$BOOT`; 0: enters the loader
  std::string problem{};          ///< error of opening the board
  std::string loader_problem{};   ///< error of opening the loader
  bool stream_taken = false;      ///< another program has its pulse stream
  bool stream_held = false;       ///< the program under test has it
  bool sent_with_stream = false;  ///< the program had it when it sent `$BOOT`
  bool tells_version = true;
  bool firmware_starts = true;  ///< false: the image detects damage and enters the loader

  std::filesystem::path drive{};  ///< where the loader's drive is mounted; empty: nowhere

  bool in_loader = false;
  std::chrono::milliseconds back_at{0};  ///< not on the bus before this time
  std::vector<std::string> heard{};      ///< received lines and real-time bytes

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

class PortsModel final : public BoardPorts {
 public:
  explicit PortsModel(BusModel& bus) : bus_(bus) {}
  std::string name(const usb::DeviceInfo& board) override { return "/dev/port" + board.place; }
  std::unique_ptr<link::Transport> open(const usb::DeviceInfo& board) override;

 private:
  BusModel& bus_;
};

}  // namespace lamplock::flash::test
