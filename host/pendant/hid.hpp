// HID devices for pendants: lists connected ones, reads and writes their reports.
//
// In:  numbers of known pendants. Out: reports, one at a time; whether the device is connected.
// Who: `lamplock jog`. Uses hidapi with its hidraw back end, which leaves the kernel's driver
//      attached. The loss of a device is an ordinary event and no error.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/pendant/pendant_ids.hpp"

namespace lamplock::pendant {

/// A device that has been opened.
class HidDevice {
 public:
  virtual ~HidDevice() = default;
  /// Reads the next report, after a wait of at most `wait`; returns its size, 0 if there is none.
  virtual std::size_t read(std::span<std::uint8_t> report, std::chrono::milliseconds wait) = 0;
  /// Sends a feature report, its id first; false if the device did not take it. May take some ms.
  virtual bool send_feature(std::span<const std::uint8_t> report) = 0;
  /// The device was unplugged or cannot be read any more; it must be opened again.
  virtual bool gone() const = 0;
};

/// Length of the longest report of a known pendant, with margin.
inline constexpr std::size_t max_report_size = 64;

/// A connected pendant of a known model.
struct HidInfo {
  const PendantId* id = nullptr;
  std::string path;  ///< of its node, "/dev/hidraw3"
};

/// The connected pendants, in the order of their nodes.
std::vector<HidInfo> list_pendants();

/// Throws Error(no_device): no permission, or unplugged.
std::unique_ptr<HidDevice> open_pendant(const HidInfo& info);

}  // namespace lamplock::pendant
