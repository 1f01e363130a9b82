#include "sim/world/world.hpp"

namespace lamplock::sim {
namespace {

/// Active-low wires have a pull-up at the drive: none is active before a board drives it.
PinBus& pulled_up(PinBus& bus, const DriveConfig& drives) {
  for (int axis = 0; axis < max_axes; ++axis) {
    if (drives.first_active_low[index(axis)]) bus.set(step_pin(axis), true, 0);
    if (drives.second_active_low[index(axis)]) bus.set(dir_pin(axis), true, 0);
  }
  return bus;
}

}  // namespace

World::World(const WorldConfig& config, PinBus& bus)
    : bus_(bus),
      lamp_(config.lamp, bus),
      drives_(config.drives, pulled_up(bus, config.drives)),
      switches_(config.switches, bus, drives_),
      has_switches_(!config.switches.empty()),
      shutters_(config.shutters, bus),
      laser_(bus, lamp_, drives_, shutters_),
      beam_(bus),
      photosensors_(config.photosensors, bus, shutters_) {
  for (int axis = 0; axis < max_axes; ++axis)
    if (const auto& servo = config.servos[index(axis)])
      servos_[index(axis)].emplace(*servo, axis, drives_);
  const auto is_probe = [](const WireConfig& wire) { return wire.pin == Pin::probe; };
  if (std::none_of(config.switches.begin(), config.switches.end(), is_probe))
    bus.set(Pin::probe, true, 0);
  bus.set(Pin::aux_in, true, 0);
  if (config.feeder) feeder_.emplace(*config.feeder, bus);
  if (config.heat) heat_.emplace(*config.heat, bus, drives_);
}

void World::schedule(Pin pin, bool level, Picoseconds at) {
  scheduled_.push({std::max(at, now_), calls_++, pin, level});
  next_scheduled_ = scheduled_.top().at;
}

void World::make_changes(Picoseconds to) {
  for (Picoseconds at = next_event(); at <= to; at = next_event()) {
    if (next_scheduled_ <= at)
      make_scheduled();
    else if (switches_.next_event() <= at)
      switches_.advance(at);
    else if (feeder_ && feeder_->next_event() <= at)
      feeder_->advance(at);
    else if (heat_ && heat_->next_event() <= at)
      heat_->advance(at);
    else if (photosensors_.next_event() <= at)
      photosensors_.advance(at);
    else
      lamp_.advance(bus_, at);
  }
}

void World::make_scheduled() {
  const Change change = scheduled_.top();
  scheduled_.pop();
  next_scheduled_ = scheduled_.empty() ? never : scheduled_.top().at;
  bus_.set(change.pin, change.level, change.at);
}

}  // namespace lamplock::sim
