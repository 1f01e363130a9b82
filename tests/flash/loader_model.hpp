// A boot loader according to the RP2040 datasheet (2.8.5), fast, with faults at any place: power
// cuts, refusals, silence, worn flash. It refuses like the ROM's source (pico-bootrom-rp2040,
// usb_boot_device.c and async_task.c): an invalid command halts both endpoints; invalid data,
// judged in pieces of 256 bytes, halt that of their direction; the result of a command without data
// is not reported.
//
// In:  transfers. Out: a board's answers to them; the resulting flash.
// Who: tests of PICOBOOT, of the flasher, of whole updates. chip_flash_test uses the loader of the
// chip simulator instead, which was written independently and takes simulated time.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include "host/usb/usb.hpp"

namespace lamplock::flash::test {

/// NOR flash of 1 MiB: programming clears bits, erasing sets them.
struct FlashModel {
  static constexpr std::size_t size = 1 << 20;
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(size, 0xff);
  std::vector<std::uint32_t> erased_sectors{};  ///< offsets, in the order of the commands
  std::vector<std::uint32_t> programmed_pages{};
  std::set<std::uint32_t> stuck{};  ///< bytes that stay 0 when they are programmed
};

inline constexpr std::size_t never = std::numeric_limits<std::size_t>::max();

/// Where a command is refused. A command without data is acknowledged but not executed.
enum class RefusedAt : std::uint8_t { packet, first_data, last_data };

/// Faults, counted from the beginning of the session.
struct LoaderFaults {
  std::size_t cut_at = never;  ///< in packets and flash operations
  std::size_t refused_command = never;
  RefusedAt refused_at = RefusedAt::packet;
  std::uint32_t status = 0;            ///< of the refusal
  bool status_fails = false;           ///< the reason of the refusal cannot be read
  std::size_t silent_command = never;  ///< it never ends
  bool erases_nothing = false;         ///< an erase has no effect but is acknowledged
  bool claimed_by_other = false;
};

/// The loader, as one open device. The flash must outlive it.
class LoaderModel final : public usb::Device {
 public:
  static constexpr std::uint8_t out = 0x03, in = 0x84;

  explicit LoaderModel(FlashModel& flash, LoaderFaults faults = {}, std::uint64_t seed = 1)
      : flash_(flash), faults_(faults), random_(seed) {}

  /// Interfaces as in the ROM: mass storage first, or PICOBOOT alone.
  static usb::DeviceInfo info(bool with_drive);

  usb::TransferEnd claim(std::uint8_t interface_number) override;
  usb::Transfer control(const usb::Setup& setup, std::span<std::uint8_t> data,
                        std::chrono::milliseconds time) override;
  usb::Transfer bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                         std::chrono::milliseconds time) override;
  usb::Transfer bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                        std::chrono::milliseconds time) override;
  usb::TransferEnd clear_halt(std::uint8_t endpoint) override;
  std::unique_ptr<usb::Stream> stream(std::uint8_t, std::uint8_t) override { return nullptr; }

  std::size_t steps() const { return steps_; }
  std::size_t commands() const { return commands_; }
  std::size_t resets() const { return resets_; }
  bool exclusive() const { return exclusive_; }
  bool rebooted() const { return rebooted_; }
  bool gone() const { return gone_; }
  /// True if an endpoint is halted.
  bool halted() const { return !halted_.empty(); }
  /// True if one was halted at the latest interface reset: halts must be cleared one by one before.
  bool halted_at_reset() const { return halted_at_reset_; }

 private:
  /// `dropped`: neither reads nor sends until the OUT endpoint or the interface is reset.
  enum class State : std::uint8_t { command, data_out, data_in, end_in, end_out, dropped };
  bool step();
  void begin(std::span<const std::uint8_t> packet);
  std::uint32_t judge() const;
  std::uint32_t judge_data(std::uint32_t done) const;
  void execute();
  void refuse(std::uint32_t status);
  void refuse_data(std::uint32_t status, std::uint8_t endpoint);
  void take_page();
  std::size_t place() const;
  void erase();
  void program(std::span<const std::uint8_t> page);

  FlashModel& flash_;
  LoaderFaults faults_;
  std::mt19937_64 random_;
  std::size_t steps_ = 0, commands_ = 0, resets_ = 0;
  bool exclusive_ = false, xip_left_ = false, rebooted_ = false, gone_ = false, silent_ = false;
  bool halted_at_reset_ = false, refused_ = false;
  std::set<std::uint8_t> halted_;
  State state_ = State::command;
  std::uint8_t command_ = 0, argument_bytes_ = 0;
  std::uint32_t token_ = 0, status_ = 0, transfer_ = 0;
  std::array<std::uint32_t, 4> arguments_{};
  std::uint32_t address_ = 0, left_ = 0;
  std::vector<std::uint8_t> page_;
};

}  // namespace lamplock::flash::test
