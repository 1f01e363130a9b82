// The PICOBOOT interface of the boot ROM's USB loader (RP2040 datasheet, 2.8.5): commands, their
// data, their status.
//
// In:  packets of the bulk OUT endpoint; results of flash functions.
// Out: packets of the bulk IN endpoint; calls of the ROM's flash functions; bytes in memory.
// Who: UsbLoader.
//
// A command is 32 bytes; data follow in its direction; an empty packet the other way ends it. As in
// the ROM's source (pico-bootrom-rp2040, usb_boot_device.c and async_task.c): a packet that is not
// a command halts both endpoints until the host clears them; data, checked 256 bytes at a time,
// halt the endpoint of their direction; both leave their reason in the status. A command without
// data is acknowledged whatever its result. EXEC is refused, and reported: the loader's own work on
// core 0 is not Thumb code.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/peripheral.hpp"

namespace lamplock::sim::chip {

/// The loader's access to memory and registers; each access costs time.
class LoaderBus {
 public:
  virtual ~LoaderBus() = default;
  virtual std::uint32_t load(std::uint32_t address, Width width) = 0;
  virtual void store(std::uint32_t address, std::uint32_t value, Width width) = 0;
};

namespace picoboot {

inline constexpr std::uint32_t magic = 0x431f'd10b;
inline constexpr std::size_t command_size = 32;
inline constexpr std::size_t status_size = 16;
inline constexpr std::uint32_t packet_size = 64;

/// bCmdId; bit 7: data go to the host.
enum class Command : std::uint8_t {
  exclusive_access = 0x01,
  reboot = 0x02,
  flash_erase = 0x03,
  write = 0x05,
  exit_xip = 0x06,
  enter_command_xip = 0x07,
  exec = 0x08,
  vectorize_flash = 0x09,
  read = 0x84
};

/// dStatusCode.
enum class Status : std::uint32_t {
  ok,
  unknown_command,
  invalid_command_length,
  invalid_transfer_length,
  invalid_address,
  bad_alignment,
  interleaved_write,
  rebooting,
  unknown_error
};

/// The functions that VECTORIZE_FLASH lets a host replace, in the order of its table.
enum class Service : std::uint8_t {
  enter_command_xip,
  exit_xip,
  erase_sector,
  erase_range,
  page_program,
  page_read
};
inline constexpr std::size_t services = 6;

/// A flash function to call, with r0 and r1.
struct Call {
  Service service = Service::exit_xip;
  std::array<std::uint32_t, 2> arguments{};
};

enum class Pipe : std::uint8_t { in, out };

/// Control of the two bulk endpoints.
class Pipes {
 public:
  virtual ~Pipes() = default;
  virtual void take() = 0;                                      ///< accept an OUT packet
  virtual void give(std::span<const std::uint8_t> packet) = 0;  ///< at most 64 bytes
  virtual void halt(Pipe pipe) = 0;
};

}  // namespace picoboot

/// The state of one interface.
class Picoboot {
 public:
  /// `buffer`: 256 bytes of memory for a page of flash.
  Picoboot(std::uint32_t buffer, NotModelled not_modelled);

  /// The loader starts.
  void start();
  /// The host has configured the device or reset the bus: no command is in progress.
  void reset();
  /// INTERFACE_RESET, or after a halt was cleared: a command in progress is dropped.
  void abandon(picoboot::Pipes& pipes);
  /// An OUT packet has come.
  void received(std::span<const std::uint8_t> packet, LoaderBus& bus, picoboot::Pipes& pipes);
  /// The host has taken the IN packet.
  void given(LoaderBus& bus, picoboot::Pipes& pipes);
  /// The answer to GET_COMMAND_STATUS.
  std::array<std::uint8_t, picoboot::status_size> status() const;

  /// A flash function that waits to be called; returned only once.
  std::optional<picoboot::Call> take_call();
  /// The function has returned (0: success).
  void returned(std::uint32_t result, LoaderBus& bus, picoboot::Pipes& pipes);
  /// Address of the RAM table of VECTORIZE_FLASH; 0: there is none.
  std::uint32_t vectors() const { return vectors_; }
  /// Addresses of the ROM's own functions, for the table.
  void set_functions(const std::array<std::uint32_t, picoboot::services>& functions) {
    functions_ = functions;
  }

 private:
  enum class Step : std::uint8_t { command, data_out, data_in, acknowledge_out, acknowledge_in };
  void begin(std::span<const std::uint8_t> packet, LoaderBus& bus, picoboot::Pipes& pipes);
  picoboot::Status check() const;
  picoboot::Status check_data(bool writes) const;
  bool can_erase() const;
  bool can_hold_vectors() const;
  void execute(LoaderBus& bus, picoboot::Pipes& pipes);
  void refuse(picoboot::Pipes& pipes);
  void refuse_data(picoboot::Status status, picoboot::Pipes& pipes);
  void finish(picoboot::Pipes& pipes);
  void next_in(LoaderBus& bus, picoboot::Pipes& pipes);
  void next_out(picoboot::Pipes& pipes);
  void data(std::span<const std::uint8_t> packet, LoaderBus& bus, picoboot::Pipes& pipes);
  void reboot(LoaderBus& bus);
  void vectorize(LoaderBus& bus);
  void call(picoboot::Service service, std::uint32_t first, std::uint32_t second);

  std::uint32_t buffer_;
  NotModelled not_modelled_;
  std::array<std::uint32_t, picoboot::services> functions_{};
  std::uint32_t vectors_ = 0;

  Step step_ = Step::command;
  picoboot::Command command_{};
  std::uint32_t token_ = 0, transfer_ = 0;
  std::array<std::uint32_t, 4> arguments_{};
  std::uint32_t argument_bytes_ = 0;
  picoboot::Status status_ = picoboot::Status::ok;
  bool in_progress_ = false, rebooting_ = false;
  std::uint32_t address_ = 0, left_ = 0;
  std::uint32_t filled_ = 0;                       ///< bytes of the page in the buffer
  std::uint32_t emptied_ = 0;                      ///< of these, bytes on their way to the host
  picoboot::Status found_ = picoboot::Status::ok;  ///< error in the page being received
  std::optional<picoboot::Call> call_;
  bool calling_ = false, dropped_ = false;
};

}  // namespace lamplock::sim::chip
