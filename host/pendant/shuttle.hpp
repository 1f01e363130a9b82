// Contour's ShuttleXpress and ShuttlePRO v2: a dial inside a ring with a spring, 5 or 15 buttons.
//
// In:  input reports of five bytes, without an id: place of the ring -7..7, a counter of the dial
//      that wraps, one that is not used, buttons in 16 bits, little endian. Out: events.
// Who: make_decoder(). Facts: LinuxCNC's driver shuttle.
//
// The counter starts anywhere: the first report only tells where. There is no switch of axes; the
// key map has buttons that choose one.
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
