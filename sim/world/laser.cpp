#include "sim/world/laser.hpp"

namespace lamplock::sim {

Laser::Laser(PinBus& bus, const Lamp& lamp, const Drives& drives, const Shutters& shutters)
    : lamp_(lamp), drives_(drives), shutters_(shutters), bus_(bus) {
  bus.listen(Pin::q_switch, *this);
}

void Laser::pin_changed(Pin /*pin*/, bool level, Picoseconds at) {
  if (!level) {
    if (shots_.empty()) return;
    Shot& shot = shots_.back();
    shot.width = at - shot.at;
    if (shot.width <= narrowest_q_switch) ++narrow_;
    return;
  }
  const Lamp::Flash flash = lamp_.flash_before(at);
  if (flash.number == 0)
    ++unlit_;
  else if (at - flash.at > latest_q_switch)
    ++late_;
  if (!shutters_.clear(at)) ++stray_;
  shots_.push_back({.index = static_cast<std::uint32_t>(shots_.size()),
                    .channel = shutters_.channel(),
                    .beat = flash.number,
                    .at = at,
                    .steps = drives_.position_at(at),
                    .width = 0,
                    .energy = bus_.attenuator()});
}

void Laser::settle_shots(Picoseconds complete_to) {
  for (std::size_t i = unsettled_; i < shots_.size(); ++i)
    shots_[i].steps = drives_.position_at(shots_[i].at);
  while (unsettled_ < shots_.size() && shots_[unsettled_].at <= complete_to) ++unsettled_;
}

}  // namespace lamplock::sim
