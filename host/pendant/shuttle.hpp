// Contour's ShuttleXpress and ShuttlePRO v2: a dial inside a ring with a spring, 5 or 15 buttons.
//
// In:  input reports of five bytes, without an id: position of the ring -7..7, a counter of the
//      dial that wraps, an unused byte, buttons in 16 bits, little endian. Out: events.
// Who: make_decoder(). Source: LinuxCNC's driver shuttle.
//
// The counter starts at any value: the first report gives no event for it. There is no axis switch;
// the key map has buttons that select the axis.
#pragma once

#include <optional>

#include "host/pendant/decoder.hpp"

namespace lamplock::pendant {

class Shuttle final : public Decoder {
 public:
  enum class Model : std::uint8_t { xpress, pro };
  explicit Shuttle(Model model) : model_(model) {}

  Events take(std::span<const std::uint8_t> report) override;
  bool has_switch() const override { return false; }

 private:
  Model model_;
  std::uint16_t buttons_ = 0;
  int spring_ = 0;
  std::optional<std::uint8_t> dial_;
};

}  // namespace lamplock::pendant
