// A USB host without class drivers: control and bulk transfers one at a time, as a program makes
// them through libusb.
//
// In:  transfers; a function that lets the chip run.
// Out: their results, after as much simulated time as they took.
// Who: the simulated USB of the host program (host/usb/simulated_usb.hpp), tests of the boot ROM.
//
// Frames of 1 ms begin with SOF; a transaction that is refused (NAK) is repeated until the time for
// the transfer is over. A stalled endpoint stays stalled until clear_halt().
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/usb/wire.hpp"
#include "sim/chip/usb_host/transactions.hpp"

namespace lamplock::sim::chip {

/// The host. `run` lets the chip run to a cycle, or slightly further.
class VendorHost final : private usb::HostEnd {
 public:
  using Bytes = std::vector<std::uint8_t>;
  enum class End : std::uint8_t { done, stalled, silent, timed_out };
  struct Transfer {
    End end = End::done;
    Bytes data;             ///< received
    std::size_t moved = 0;  ///< bytes, either way
    bool done() const { return end == End::done; }
  };

  VendorHost(TimeWheel& wheel, usb::DeviceEnd& device, std::function<void(Cycle)> run);
  ~VendorHost() override;
  VendorHost(const VendorHost&) = delete;
  VendorHost& operator=(const VendorHost&) = delete;

  /// Lets time pass, with frames.
  void wait(Picoseconds time);
  /// Waits for a device, resets it, gives it address 1 and configuration 1, reads its descriptors.
  /// False: none came, or it did not answer.
  bool enumerate(Picoseconds patience = 1'000 * ps_per_ms);
  /// A device is connected.
  bool connected() const { return device_.pull_up(); }
  /// Number of disconnections: a device that was enumerated before one is another device now.
  std::uint64_t departures() const { return departures_; }
  const Bytes& device_descriptor() const { return device_descriptor_; }
  const Bytes& configuration_descriptor() const { return configuration_descriptor_; }

  Transfer control(const std::array<std::uint8_t, 8>& setup,
                   std::span<const std::uint8_t> data = {});
  /// Packets of 64 bytes; an empty transfer is one empty packet.
  Transfer bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> data);
  /// Receives until `size` bytes have come, or a short packet.
  Transfer bulk_in(std::uint8_t endpoint, std::size_t size);
  /// CLEAR_FEATURE(ENDPOINT_HALT); `endpoint` with bit 7 for IN.
  bool clear_halt(std::uint8_t endpoint);
  /// Sets the time-out of bulk transfers.
  void set_timeout(Picoseconds timeout) { timeout_ = timeout; }

 private:
  void run_to(Picoseconds time);
  void reset();
  /// One transaction, repeated while it is refused.
  usb::Result transact(const usb::Transaction& transaction, Picoseconds timeout);
  static End end_of(const usb::Result& result);
  bool read_descriptor(std::uint8_t type, std::size_t size, Bytes& bytes);

  void pull_up_changed(bool on, Picoseconds at) override;
  void remote_wakeup(Picoseconds) override {}

  TimeWheel& wheel_;
  usb::DeviceEnd& device_;
  std::function<void(Cycle)> run_;
  usb::TransactionEngine engine_;
  std::optional<usb::Result> result_;
  std::uint8_t address_ = 0;
  std::map<std::uint8_t, bool> data1_;  ///< of the endpoint's next packet
  Picoseconds bus_free_ = 0;
  Picoseconds next_frame_ = -1;  ///< -1: no frames
  std::uint16_t frame_ = 0;
  std::uint64_t departures_ = 0;
  Picoseconds timeout_ = 10'000 * ps_per_ms;
  Bytes device_descriptor_, configuration_descriptor_;
};

}  // namespace lamplock::sim::chip
