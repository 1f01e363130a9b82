// A pendant that is plugged in: its device and its language together.
//
// In:  an open device; what its display shall show. Out: events, in order; its loss.
// Who: `lamplock jog`. Never waits. A display takes several reports, each a transfer of some ms:
// one
//      goes out with each round, so that nobody waits for a display while the machine moves.
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "host/pendant/board_talk.hpp"
#include "host/pendant/decoder.hpp"
#include "host/pendant/hid.hpp"

namespace lamplock::pendant {

class Pendant {
 public:
  Pendant(const PendantId& id, std::unique_ptr<HidDevice> device, const Variant& variant)
      : device_(std::move(device)), decoder_(make_decoder(id.kind, variant)) {}

  /// What has happened since the last call.
  Events poll();
  /// Shows this, if it has changed, ten times a second at most; `now` is any clock's.
  void show(const Display& display, Time now);
  bool gone() const { return device_->gone(); }
  bool has_switch() const { return decoder_->has_switch(); }

 private:
  std::unique_ptr<HidDevice> device_;
  std::unique_ptr<Decoder> decoder_;
  std::optional<Display> shown_;
  Time shown_at_{};
  std::deque<FeatureReport> to_show_;
};

/// Those that may be used: all, or those of this option ("hb04"), in the order of list_pendants().
std::vector<HidInfo> find_pendants(const std::string& option);

}  // namespace lamplock::pendant
