// The pendant XHC HB04: wireless, 16 or 18 keys, a wheel, a display of six coordinates.
//
// In:  input reports of six bytes: id 4, two key codes, axis switch, clicks of the wheel, checksum.
//      Out: events; six feature reports for a display.
// Who: make_decoder(). Source: LinuxCNC's driver xhc-hb04 and its key tables layout1 and layout2.
//
// The two models have the same USB numbers and different keys: 01 is "stop" on the model with 16
// keys and "go to zero" on that with 18. Until the model is known (from the key map, or from its
// key 16), 01 is "stop" and keys that differ are ambiguous.
//
// The checksum depends on the seed of the display and is not checked. A report of zeros means that
// the pendant goes to sleep; in all others the checksum is not zero, or the switch is not off.
#pragma once

#include "host/pendant/decoder.hpp"
#include "host/pendant/held_keys.hpp"

namespace lamplock::pendant {

class XhcHb04 final : public Decoder {
 public:
  /// `keys`: 16 or 18; 0: unknown.
  explicit XhcHb04(int keys = 0) : key_count_(keys) {}
  Events take(std::span<const std::uint8_t> report) override;
  std::vector<FeatureReport> display(const Display& shown) const override;

 private:
  void fall_asleep(Events& events);
  Key key_of(std::uint8_t code) const;

  int key_count_;
  HeldKeys keys_;
  Selector selector_ = Selector::off;
  bool asleep_ = false;
};

}  // namespace lamplock::pendant
