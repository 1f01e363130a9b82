// The pendant XHC HB04: wireless, 16 or 18 keys, a wheel, a display of six coordinates.
//
// In:  input reports of six bytes: id 4, two key codes, switch of axes, clicks of the wheel, check
//      sum. Out: events; six feature reports for a display.
// Who: make_decoder(). Facts: LinuxCNC's driver xhc-hb04 and its key tables layout1 and layout2.
//
// The two models have the same USB numbers and different keys: 01 is "stop" on the one of 16 keys
// and "go to zero" on that of 18. Until it is known which one it is (said, or shown by its key 16),
// 01 is "stop" and keys that differ are ambiguous.
//
// The check sum depends on the seed of the display and is not looked at. A report of zeros says
// that the pendant goes to sleep; in all others the check sum is not zero, or the switch is not
// off.
#pragma once

#include "host/pendant/decoder.hpp"
#include "host/pendant/held_keys.hpp"

namespace lamplock::pendant {

class XhcHb04 final : public Decoder {
 public:
  /// `keys`: 16 or 18; 0: not known.
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
