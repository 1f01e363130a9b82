// PICOBOOT, the USB protocol of the boot loader in the ROM of the RP2040.
//
// In:  commands for flash, memory, restart. Out: bytes read; an Error with the reason of a refusal
//      or of a failed transfer.
// Who: Flasher.
// Protocol: RP2040 datasheet, 2.8.5 (commands 2.8.5.4, requests and status 2.8.5.5); status codes
// above 8 are those of the RP2350's loader (datasheet, 5.6.5).
//
// A command is 32 bytes, its data follow in their direction, an empty packet the other way ends it.
// Refusals (raspberrypi/pico-bootrom-rp2040, usb_boot_device.c): an unknown command halts both
// endpoints; data that cannot be transferred halt the endpoint of their direction. A command
// without data is acknowledged even if it failed, so that an erase must be read back. The status
// must be read before the interface is reset, which clears it.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "host/error.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::flash {

/// dStatusCode of a command.
enum class PicobootStatus : std::uint32_t {
  ok,
  unknown_command,
  invalid_command_length,
  invalid_transfer_length,
  invalid_address,
  bad_alignment,
  interleaved_write,
  rebooting,
  unknown_error,
  invalid_state,
  not_permitted,
  invalid_argument,
  buffer_too_small,
  precondition_not_met,
  modified_data,
  invalid_data,
  not_found,
  unsupported_modification
};

/// A command that failed; with its status if the loader reported one.
class PicobootError : public Error {
 public:
  PicobootError(Exit exit, const std::string& what, const std::string& remedy,
                std::optional<PicobootStatus> status = std::nullopt)
      : Error(exit, "boot loader", what, remedy), status_(status) {}
  std::optional<PicobootStatus> status() const { return status_; }

 private:
  std::optional<PicobootStatus> status_;
};

/// One session with a loader. Every function throws PicobootError.
class Picoboot {
 public:
  /// Claims the interface, and ends an unfinished command of an earlier program. `device` must
  /// outlive this.
  Picoboot(usb::Device& device, const usb::DeviceInfo& info);
  Picoboot(const Picoboot&) = delete;
  Picoboot& operator=(const Picoboot&) = delete;

  /// Prevents writes by other programs: the drive RPI-RP2 refuses them meanwhile.
  void take_exclusive_access();
  /// Makes flash ready for the commands that follow.
  void exit_xip();
  /// Erases whole sectors. The loader's acknowledgement does not mean that it succeeded.
  void erase(std::uint32_t address, std::uint32_t size);
  /// Writes erased flash, from the begin of a page on.
  void write(std::uint32_t address, std::span<const std::uint8_t> bytes);
  void read(std::uint32_t address, std::span<std::uint8_t> bytes);
  /// Starts the program in flash after `delay`; the device then leaves the bus.
  void reboot(std::chrono::milliseconds delay);

 private:
  enum class Command : std::uint8_t;
  struct Order;
  struct Status;

  void find_interface(const usb::DeviceInfo& info);
  void send(const Order& order);
  void run(const Order& order, std::chrono::milliseconds patience);
  void take_empty(std::chrono::milliseconds patience, const Order& order);
  void check(const usb::Transfer& transfer, std::size_t size, const Order& order);
  [[noreturn]] void fail(const usb::Transfer& transfer, const Order& order);
  [[noreturn]] void fail_unanswered(const Order& order);
  [[noreturn]] void fail_refused(const Order& order, const std::optional<Status>& answer);
  std::optional<Status> status();
  void recover();
  bool halted(std::uint8_t endpoint);

  usb::Device& device_;
  std::uint8_t interface_ = 0, out_ = 0, in_ = 0;
  std::uint32_t token_ = 0;
};

}  // namespace lamplock::flash
