// Reports to a pendant's display, written beside the loop that moves the machine.
//
// In:  the reports of a display, newest last. Out: feature reports to the device.
// Who: a pendant; nothing here waits for the device.
//
// A feature report is a control transfer, for which the kernel waits up to 5 s at a device that
// hangs. In that time somebody may press stop: so a thread of its own writes, through an own
// handle.
#pragma once

#include <memory>
#include <vector>

#include "host/pendant/display.hpp"
#include "host/pendant/hid.hpp"

namespace lamplock::pendant {

class DisplayWriter {
 public:
  explicit DisplayWriter(std::unique_ptr<HidDevice> device);
  /// A batch that has begun is written to its end; what waits behind it is not.
  ~DisplayWriter();
  DisplayWriter(const DisplayWriter&) = delete;
  DisplayWriter& operator=(const DisplayWriter&) = delete;

  /// Writes these, in order. What a display does not take is not tried again.
  void write(std::vector<FeatureReport> reports);
  /// Everything has been written.
  bool idle() const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< the thread's too: it may outlive this inside a transfer
};

}  // namespace lamplock::pendant
