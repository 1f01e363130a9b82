// A full-speed device with one bulk endpoint each way, and the kernel's side of its transfers: they
// are queued, wait for the device, and are returned in order, as in usbfs
// (Documentation/driver-api/usb/usb.rst and drivers/usb/core/devio.c of Linux).
//
// In:  ioctls of the program that has the node open; bytes that the device reads and sends. Out:
//      ended transfers, and a node that can be polled. Who: tests of libusb_stream.
//
// umockdev forwards the ioctls, but its node is a plain file, at which poll() never waits. The node
// is a terminal instead: stopped, it is not ready for writing, as usbfs while no transfer has
// ended, and hung up, it reports the POLLERR of a device that is gone.
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

/// One device from plugging in to unplugging. Calls of the device's side may come from any thread.
class BulkDevice final : public CallHandler {
 public:
  BulkDevice();
  ~BulkDevice() override;
  BulkDevice(const BulkDevice&) = delete;
  BulkDevice& operator=(const BulkDevice&) = delete;

  const std::string& node() const { return node_; }
  std::optional<int> call(unsigned long request, void* argument) override;

  // The device's side.
  /// Reads bytes from the host, if any; returns their number. A transfer ends with its last byte.
  std::size_t take(std::span<std::uint8_t> bytes);
  /// Sends bytes to the host in packets while the host has transfers waiting; returns the number of
  /// bytes sent. A full last packet is followed by an empty one, as on boards.
  std::size_t give(std::span<const std::uint8_t> bytes);
  /// From now on transfers of one direction end with this status: -EPIPE, the endpoint answers with
  /// STALL; 0, normal operation.
  void halt(bool in, int status);
  /// Waiting transfers end with this status, a negative errno of the kernel; later ones are
  /// refused.
  void unplug(int status);
  /// Transfers both ways end with this status before the kernel knows that the device is gone.
  void fail(int status);
  /// Another program has the interface.
  void set_busy(bool busy);

  // The host's side.
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
  std::size_t taken_ = 0;               ///< bytes read from the first OUT transfer
  int in_status_ = 0, out_status_ = 0;  ///< status of future transfers, if not 0
  bool gone_ = false, busy_ = false, claimed_ = false, empty_packet_due_ = false;
  std::size_t polls_ = 0;
};

}  // namespace lamplock::usb::test
