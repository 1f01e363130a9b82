// A virtual board at the other end of an emulated cable, which can be pulled: bytes go by the
// kernel's calls, time is this computer's.
//
// In:  a board, an emulated computer. Out: the board's bytes at its node; plugs and unplugs.
// Who: tests of jobs over libusb.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include "sim/board.hpp"
#include "tests/usb/bulk_device.hpp"
#include "tests/usb/emulated_usb.hpp"

namespace lamplock::usb::test {

class CabledBoard {
 public:
  /// Not plugged in yet. Board and computer must outlive it, and programs close the board before.
  CabledBoard(sim::Board& board, EmulatedUsb& usb);
  ~CabledBoard();
  CabledBoard(const CabledBoard&) = delete;
  CabledBoard& operator=(const CabledBoard&) = delete;

  /// Another address on the bus each time.
  void plug(const std::string& place);
  /// As BulkDevice::unplug() and fail(), then gone from the lists.
  void unplug(int status);
  void fail(int status);
  /// It looks at the cable again after so long.
  void look_away(std::chrono::milliseconds time);
  /// No byte and no time passes from here, so that the board may be looked at.
  void end();

 private:
  void serve();
  void move_bytes();

  sim::Board& board_;
  EmulatedUsb& usb_;
  EmulatedDevice info_;
  std::deque<BulkDevice> devices_;  ///< of every plug: a program may still have the old one open
  std::mutex mutex_;                ///< of what the thread and the owner both touch
  BulkDevice* device_ = nullptr;
  std::chrono::steady_clock::time_point looks_at_{};
  std::vector<std::uint8_t> to_board_, to_host_;
  std::atomic<bool> ended_{false};
  std::jthread thread_;
};

}  // namespace lamplock::usb::test
