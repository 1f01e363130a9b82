// A boot loader as the RP2040 datasheet describes it (2.8.5), fast, with faults at any place: a cut
// of the power, refusals, silence, worn flash. It refuses as the ROM's source does (pico-bootrom-
// rp2040, usb_boot_device.c and async_task.c): a command that is none halts both endpoints; data,
// 256 bytes of which are judged at a time, halt that of their direction; what becomes of a command
// without data is not told.
//
// In:  transfers. Out: what a board would do to them; the flash that is left.
// Who: tests of PICOBOOT, of the flasher, of whole updates. The loader of the chip simulator, which
// others wrote and which takes simulated time, is the other one (chip_flash_test).
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

/// Where a command is refused. One without data is, by its data, acknowledged and not done.
enum class RefusedAt : std::uint8_t { packet, first_data, last_data };

/// What goes wrong, counted from the begin of the session.
struct LoaderFaults {
  std::size_t cut_at = never;  ///< packets and flash operations
  std::size_t refused_command = never;
  RefusedAt refused_at = RefusedAt::packet;
  std::uint32_t status = 0;            ///< of the refusal
  bool status_fails = false;           ///< its reason cannot be read
  std::size_t silent_command = never;  ///< its end never comes
  bool erases_nothing = false;         ///< but acknowledges every erase
  bool claimed_by_other = false;
};

/// The loader, as one open device. The flash outlives it.
class LoaderModel final : public usb::Device {
 public:
  static constexpr std::uint8_t out = 0x03, in = 0x84;

  explicit LoaderModel(FlashModel& flash, LoaderFaults faults = {}, std::uint64_t seed = 1)
      : flash_(flash), faults_(faults), random_(seed) {}

  /// As the ROM has it: mass storage first, or PICOBOOT alone.
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
  /// A halt is left.
  bool halted() const { return !halted_.empty(); }
  /// Some were when the interface was reset last: they are to be cleared one by one before.
  bool halted_at_reset() const { return halted_at_reset_; }

 private:
  /// `dropped`: neither takes nor gives, until the OUT endpoint or the interface is reset.
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
