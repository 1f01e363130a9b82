// The USB of a simulated chip, as seen by a program on the computer at the other end of the cable.
//
// In:  requests. Out: answers of the chip's own boot loader or program, in simulated time.
// Who: `flash --board chip`, tests of flashing.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "host/usb/usb.hpp"
#include "sim/chip/chip.hpp"
#include "sim/chip/usb_host/vendor_host.hpp"

namespace lamplock::usb {

/// A bus with the chip only. The chip must outlive the bus; its owner powers it on, and it runs
/// during calls of the bus. A stream makes single transfers.
class SimulatedUsb final : public Bus {
 public:
  /// Runs the chip to a cycle.
  using Run = std::function<void(sim::chip::Cycle)>;

  /// Place of the chip on the bus.
  static constexpr const char* place = "1-1";

  explicit SimulatedUsb(sim::chip::Chip& chip);
  /// `run` may also change the chip.
  SimulatedUsb(sim::chip::Chip& chip, Run run);

  std::vector<DeviceInfo> devices() override;
  std::unique_ptr<Device> open(const DeviceInfo& device) override;
  void sleep(std::chrono::milliseconds time) override;
  std::chrono::milliseconds now() override;

 private:
  bool attach();
  std::string text(std::uint8_t index);

  sim::chip::Chip& chip_;
  sim::chip::VendorHost host_;
  std::optional<DeviceInfo> device_;  ///< enumerated
  std::uint64_t departures_ = 0;      ///< count at its enumeration
};

}  // namespace lamplock::usb
