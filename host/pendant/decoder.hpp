// One pendant's language: its reports to events, a display to its reports.
//
// In:  input reports as the HID layer gives them. Out: events; feature reports for its display.
// Who: `lamplock jog`. Pure: no device, no clock. Reports of another size or with another id say
//      nothing: noise must not move a machine.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/pendant/display.hpp"
#include "host/pendant/event.hpp"
#include "host/pendant/pendant_ids.hpp"

namespace lamplock::pendant {

/// Keeps what is needed to see changes: one object per pendant that is plugged in.
class Decoder {
 public:
  virtual ~Decoder() = default;
  /// What has changed with this report.
  virtual Events take(std::span<const std::uint8_t> report) = 0;
  /// Reports that make the pendant show this; none if it has no display.
  virtual std::vector<FeatureReport> display(const Display&) const { return {}; }
  /// True if it has a switch of axes; without one, keys choose the axis of its wheel.
  virtual bool has_switch() const { return true; }
};

/// What USB does not tell about a pendant.
struct Variant {
  int hb04_keys = 0;  ///< 16 or 18; 0: not known
};

std::unique_ptr<Decoder> make_decoder(Kind kind, const Variant& variant = {});

}  // namespace lamplock::pendant
