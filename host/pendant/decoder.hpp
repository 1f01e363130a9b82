// A pendant's protocol: converts its reports to events, and display contents to its reports.
//
// In:  input reports from the HID layer. Out: events; feature reports for its display.
// Who: `lamplock jog`. Pure: no device, no clock. Reports of another size or with another id are
//      ignored: noise must not move a machine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/pendant/display.hpp"
#include "host/pendant/event.hpp"
#include "host/pendant/pendant_ids.hpp"

namespace lamplock::pendant {

/// Keeps the last report to detect changes: one object per connected pendant.
class Decoder {
 public:
  virtual ~Decoder() = default;
  /// The changes in this report.
  virtual Events take(std::span<const std::uint8_t> report) = 0;
  /// Feature reports that show this; none if the pendant has no display.
  virtual std::vector<FeatureReport> display(const Display&) const { return {}; }
  /// True if it has a switch of axes; without one, keys choose the axis of its wheel.
  virtual bool has_switch() const { return true; }
};

/// Properties of a pendant that USB does not report.
struct Variant {
  int hb04_keys = 0;  ///< 16 or 18; 0: not known
};

std::unique_ptr<Decoder> make_decoder(Kind kind, const Variant& variant = {});

}  // namespace lamplock::pendant
