// Writes reports to a pendant's display in a thread of its own.
//
// In:  the reports of a display, newest last. Out: feature reports to the device.
// Who: a pendant; no call waits for the device.
//
// A feature report is a control transfer, for which the kernel waits up to 5 s if the device hangs.
// The stop key must work during that time, so the thread has its own handle of the device.
#pragma once

#include <memory>
#include <vector>

#include "host/pendant/display.hpp"
#include "host/pendant/hid.hpp"

namespace lamplock::pendant {

class DisplayWriter {
 public:
  explicit DisplayWriter(std::unique_ptr<HidDevice> device);
  /// A batch that has begun is written to its end; the next one is dropped.
  ~DisplayWriter();
  DisplayWriter(const DisplayWriter&) = delete;
  DisplayWriter& operator=(const DisplayWriter&) = delete;

  /// Writes these, in order. A failed report is not repeated.
  void write(std::vector<FeatureReport> reports);
  /// All reports have been written.
  bool idle() const;

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;  ///< with the thread, which may outlive this in a transfer
};

}  // namespace lamplock::pendant
