// The pendants XHC WHB04B-4 and WHB04B-6: wireless, 16 keys with second functions by Fn, an axis
// switch, a speed switch, a wheel, a display of three coordinates.
//
// In:  input reports of eight bytes: id 4, a random byte, two key codes, speed switch, axis switch,
//      clicks of the wheel, checksum. Out: events; three feature reports for a display.
// Who: make_decoder(). Source: LinuxCNC's driver xhc-whb04b-6 and its notes on the protocol.
//
// The rule of the checksum is unknown for reports with keys: it is not checked. Before the pendant
// goes to sleep it sends a report whose fields are all zero, and another one without meaning, which
// is dropped. It does not report its switches when it wakes: until one is turned, the axis is
// unknown and no axis moves. The last position of the speed switch, "lead", is 1c on some models,
// 9b on others (LinuxCNC issue 3485).
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
