// A virtual board at the end of an emulated cable, which can be unplugged: bytes pass through the
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
  /// Not plugged in yet. Board and computer must outlive it; programs must close the board before.
  CabledBoard(sim::Board& board, EmulatedUsb& usb);
  ~CabledBoard();
  CabledBoard(const CabledBoard&) = delete;
  CabledBoard& operator=(const CabledBoard&) = delete;

  /// Uses another address on the bus each time.
  void plug(const std::string& place);
  /// Like BulkDevice::unplug() and fail(), then removes the device from the lists.
  void unplug(int status);
  void fail(int status);
  /// Ignores the cable for this time.
  void ignore_cable(std::chrono::milliseconds time);
  /// Stops bytes and time, so that the board may be inspected.
  void end();

 private:
  void serve();
  void move_bytes();

  sim::Board& board_;
  EmulatedUsb& usb_;
  EmulatedDevice info_;
  std::deque<BulkDevice> devices_;  ///< one for each plug: a program may still have an old one open
  std::mutex mutex_;                ///< protects data shared by thread and owner
  BulkDevice* device_ = nullptr;
  std::chrono::steady_clock::time_point ignores_until_{};
  std::vector<std::uint8_t> to_board_, to_host_;
  std::atomic<bool> ended_{false};
  std::jthread thread_;
};

}  // namespace lamplock::usb::test
