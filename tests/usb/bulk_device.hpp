// A full-speed device with one bulk endpoint each way, and the kernel's side of its transfers: they
// are queued, wait for the device, and come back in their order, as usbfs has it
// (Documentation/driver-api/usb/usb.rst and drivers/usb/core/devio.c of Linux).
//
// In:  ioctls of whoever has the node open; bytes the device takes and gives. Out: transfers that
//      have ended, and a node that can be polled. Who: tests of libusb_stream.
//
// umockdev brings the ioctls, but its node is a plain file, at which poll() never waits. The node
// is a terminal instead: held up it is not ready for writing, which is how usbfs says that no
// transfer has ended, and hung up it shows the POLLERR of a device that is gone.
#pragma once

#include <linux/usbdevice_fs.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <string>

#include "tests/usb/emulated_usb.hpp"

namespace lamplock::usb::test {

/// One device while it is plugged in; plugged in again it is another one. Calls of the device's
/// side may come from any thread.
class BulkDevice final : public CallHandler {
 public:
  BulkDevice();
  ~BulkDevice() override;
  BulkDevice(const BulkDevice&) = delete;
  BulkDevice& operator=(const BulkDevice&) = delete;

  /// The file that is its node.
  const std::string& node() const { return node_; }
  std::optional<int> call(unsigned long request, void* argument) override;

  // What the device does.
  /// Bytes from the host, as far as there are any; returns how many. A transfer ends with its last.
  std::size_t take(std::span<std::uint8_t> bytes);
  /// Bytes to the host in packets, as far as the host has transfers waiting for them; returns how
  /// many went. A last packet that is full is followed by an empty one, as boards do.
  std::size_t give(std::span<const std::uint8_t> bytes);
  /// Transfers of one direction come back with this status from now on: -EPIPE, the endpoint
  /// answers with STALL; 0, all is well again.
  void halt(bool in, int status);
  /// Transfers that wait come back with this status, a negative errno of the kernel; a later one is
  /// refused.
  void unplug(int status);
  /// Transfers both ways do, while the kernel does not know yet that the device is gone.
  void fail(int status);
  /// Another program has the interface.
  void set_busy(bool busy);

  // What the host has done.
  std::size_t waiting_in() const;
  std::size_t waiting_out() const;
  /// Submitted and not reaped.
  std::size_t owed() const;
  bool claimed() const;
  std::size_t polls() const;  ///< reaps that found nothing

 private:
  using Urbs = std::deque<usbdevfs_urb*>;
  std::optional<int> call_locked(unsigned long request, void* argument);
  int submit(usbdevfs_urb& urb);
  int reap(void** place);
  int discard(const void* urb);
  void finish(Urbs& from, Urbs::iterator at, int status);
  void finish_all(int status);
  bool give_packet(std::span<const std::uint8_t> packet);
  void show_readiness();

  mutable std::mutex mutex_;
  int master_ = -1, terminal_ = -1;
  std::string node_;
  Urbs in_, out_, done_;
  std::size_t taken_ = 0;               ///< of the first OUT transfer
  int in_status_ = 0, out_status_ = 0;  ///< of transfers from now on, if not 0
  bool gone_ = false, busy_ = false, claimed_ = false, empty_packet_due_ = false;
  std::size_t polls_ = 0;
};

}  // namespace lamplock::usb::test
