#include "sim/world/world.hpp"

namespace lamplock::sim {

World::World(const WorldConfig& config, PinBus& bus)
    : bus_(bus),
      lamp_(config.lamp, bus),
      drives_(config.drives, bus),
      shutters_(config.shutters, bus),
      laser_(bus, lamp_, drives_, shutters_),
      beam_(bus),
      photosensors_(config.photosensors, bus, shutters_) {}

void World::schedule(Pin pin, bool level, Picoseconds at) {
  switches_.push({std::max(at, now_), scheduled_++, pin, level});
  next_switch_ = switches_.top().at;
}

void World::make_changes(Picoseconds to) {
  for (Picoseconds at = next_event(); at <= to; at = next_event()) {
    if (next_switch_ <= at)
      make_switch();
    else if (photosensors_.next_event() <= at)
      photosensors_.advance(at);
    else
      lamp_.advance(bus_, at);
  }
}

void World::make_switch() {
  const Switch change = switches_.top();
  switches_.pop();
  next_switch_ = switches_.empty() ? never : switches_.top().at;
  bus_.set(change.pin, change.level, change.at);
}

}  // namespace lamplock::sim
