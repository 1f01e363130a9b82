// HID devices as pendants need them: which are plugged in, their reports, reports to them.
//
// In:  numbers of known pendants. Out: reports, one at a time; whether the device is still there.
// Who: `lamplock jog`. Behind it stands hidapi with its hidraw back end, which leaves the kernel's
//      driver where it is. A device that goes is an ordinary event and no error.
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
  /// Takes the next report, waiting for it no longer than told; its size, 0 if there is none.
  virtual std::size_t read(std::span<std::uint8_t> report, std::chrono::milliseconds wait) = 0;
  /// Sends a feature report, its id first; false if the device did not take it. May take some ms.
  virtual bool send_feature(std::span<const std::uint8_t> report) = 0;
  /// It was unplugged, or cannot be read any more; it does not come back.
  virtual bool gone() const = 0;
};

/// Longest report of a pendant here, with room.
inline constexpr std::size_t longest_report = 64;

/// A known pendant that is plugged in.
struct HidInfo {
  const PendantId* id = nullptr;
  std::string path;  ///< of its node, "/dev/hidraw3"
};

/// Those that are there now, in the order of their nodes.
std::vector<HidInfo> list_pendants();

/// Throws Error(no_device): no permission, or it has gone.
std::unique_ptr<HidDevice> open_pendant(const HidInfo& info);

}  // namespace lamplock::pendant
