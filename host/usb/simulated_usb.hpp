// The USB of a simulated chip, as a program on the computer at the other end of the cable has it.
//
// In:  requests. Out: what the chip's own boot loader or program answers, in simulated time.
// Who: `flash --board chip`, tests of flashing.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "host/usb/usb.hpp"
#include "sim/chip/chip.hpp"
#include "sim/chip/usb_host/vendor_host.hpp"

namespace lamplock::usb {

/// A bus with the chip and nothing else. The chip, which must outlive the bus and is powered on by
/// whoever owns it, runs while somebody waits here. A stream moves single transfers.
class SimulatedUsb final : public Bus {
 public:
  /// Runs the chip to a cycle.
  using Run = std::function<void(sim::chip::Cycle)>;

  /// Where the chip is plugged in.
  static constexpr const char* place = "1-1";

  explicit SimulatedUsb(sim::chip::Chip& chip);
  /// `run` may do something to the chip on its way.
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
  std::uint64_t departures_ = 0;      ///< before it was
};

}  // namespace lamplock::usb
