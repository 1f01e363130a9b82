// The pendants XHC WHB04B-4 and WHB04B-6: wireless, 16 keys with a second row behind Fn, switches
// of axes and of speeds, a wheel, a display of three coordinates.
//
// In:  input reports of eight bytes: id 4, a random byte, two key codes, switch of speeds, switch
// of
//      axes, clicks of the wheel, check sum. Out: events; three feature reports for a display.
// Who: make_decoder(). Facts: LinuxCNC's driver xhc-whb04b-6 and the notes on the protocol in it.
//
// The check sum follows no rule that is known for reports with keys: it is not looked at. Before
// the pendant goes to sleep it sends a report whose fields are all zero, and one more, which means
// nothing and is dropped. It does not tell its switches when it wakes: until one moves the axis is
// unknown, and nothing moves. The last place of the switch of speeds, "lead", is 1c on some, 9b on
// others (LinuxCNC issue 3485).
#pragma once

#include <optional>

#include "host/pendant/decoder.hpp"
#include "host/pendant/held_keys.hpp"

namespace lamplock::pendant {

class XhcWhb04b final : public Decoder {
 public:
  Events take(std::span<const std::uint8_t> report) override;
  std::vector<FeatureReport> display(const Display& shown) const override;

 private:
  void fall_asleep(Events& events);
  void take_switches(std::span<const std::uint8_t> report, Events& events);

  HeldKeys keys_;
  Selector selector_ = Selector::off;
  std::optional<Rate> rate_;
  bool asleep_ = false, drop_next_ = false;
};

}  // namespace lamplock::pendant
