// A connected pendant: its device and its decoder.
//
// In:  an open device; the contents of its display. Out: events, in order; its loss.
// Who: `lamplock jog`. Never blocks; a thread writes the display (display_writer.hpp).
#pragma once

#include <memory>
#include <optional>

#include "host/pendant/board_dialog.hpp"
#include "host/pendant/decoder.hpp"
#include "host/pendant/display_writer.hpp"
#include "host/pendant/hid.hpp"

namespace lamplock::pendant {

class Pendant {
 public:
  /// Reads `device`; writes `display`, a second handle of the same device.
  Pendant(const PendantId& id, std::unique_ptr<HidDevice> device,
          std::unique_ptr<HidDevice> display, const Variant& variant)
      : device_(std::move(device)),
        decoder_(make_decoder(id.kind, variant)),
        writer_(std::move(display)) {}

  /// The events since the last call.
  Events poll();
  /// Shows this, if it has changed, ten times a second at most and after the previous contents were
  /// written; `now` may be of any clock.
  void show(const Display& display, Time now);
  bool gone() const { return device_->gone(); }
  bool has_switch() const { return decoder_->has_switch(); }

 private:
  std::unique_ptr<HidDevice> device_;
  std::unique_ptr<Decoder> decoder_;
  std::optional<Display> shown_;
  Time shown_at_{};
  DisplayWriter writer_;
};

/// Pendants to use: all, or those of this option ("hb04"), in the order of list_pendants().
std::vector<HidInfo> find_pendants(const std::string& option);

}  // namespace lamplock::pendant
