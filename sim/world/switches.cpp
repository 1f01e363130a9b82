#include "sim/world/switches.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace lamplock::sim {
namespace {

/// For drives without a minimum period.
constexpr Picoseconds min_poll_period = 100 * ps_per_ns;

bool is_bounce(double us) { return us >= 0 && us <= 1e6; }

void check(const ContactConfig& contact) {
  if (contact.hysteresis_steps < 0) throw std::invalid_argument("negative hysteresis of a switch");
  if (!is_bounce(contact.bounce.make_us) || !is_bounce(contact.bounce.break_us))
    throw std::invalid_argument("a switch bounces for 0 to 1 s");
  for (const StepRange& range : contact.place)
    if (range.low > range.high) throw std::invalid_argument("a switch without a place");
}

bool worked_by_hand(const ContactConfig& contact) {
  return std::all_of(contact.place.begin(), contact.place.end(),
                     [](const StepRange& range) { return range.everywhere(); });
}

/// Steps until the position crosses an end of the range, at least 1; many if it has no end.
std::int64_t steps_to_edge(const StepRange& range, std::int32_t outside, std::int32_t place) {
  constexpr std::int64_t far = std::numeric_limits<std::int32_t>::max();
  const auto to = [place](std::int64_t below, std::int64_t above) {
    return place <= below ? above - place : place - below;
  };
  std::int64_t nearest = far;
  for (const std::int64_t wider : {std::int64_t{0}, std::int64_t{outside}}) {
    if (range.low != StepRange{}.low)
      nearest = std::min(nearest, to(range.low - wider - 1, range.low - wider));
    if (range.high != StepRange{}.high)
      nearest = std::min(nearest, to(range.high + wider, range.high + wider + 1));
  }
  return nearest;
}

}  // namespace

ContactConfig ContactConfig::above(int axis, std::int32_t from, std::int32_t hysteresis_steps) {
  ContactConfig contact{.hysteresis_steps = hysteresis_steps};
  contact.place[index(axis)].low = from;
  return contact;
}

ContactConfig ContactConfig::below(int axis, std::int32_t from, std::int32_t hysteresis_steps) {
  ContactConfig contact{.hysteresis_steps = hysteresis_steps};
  contact.place[index(axis)].high = from;
  return contact;
}

Switches::Switches(const std::vector<WireConfig>& wires, PinBus& bus, Drives& drives)
    : bus_(bus),
      min_period_(std::max(drives.min_period(), min_poll_period)),
      place_(drives.position()) {
  for (const WireConfig& wire : wires) add(wire);
  for (int axis = 0; axis < max_axes; ++axis)
    if (std::any_of(contacts_.begin(), contacts_.end(), [axis](const Contact& contact) {
          return !contact.config.place[index(axis)].everywhere();
        }))
      drives.listen(axis, *this);
}

void Switches::add(const WireConfig& config) {
  if (config.contacts.empty()) throw std::invalid_argument("a wire without a switch");
  for (const Wire& wire : wires_)
    if (wire.config.pin == config.pin) throw std::invalid_argument("two wires on one pin");
  const std::size_t first = contacts_.size();
  for (const ContactConfig& contact : config.contacts) add_contact(contact, config.normally_closed);
  const bool at_rest = !config.normally_closed;
  bus_.set(config.pin, at_rest, 0);
  wires_.push_back({config, first, contacts_.size()});
  if (level(wires_.back(), 0) != at_rest) push({.at = 0});
  for (const Picoseconds at : {config.broken_from, config.shorted_from})
    if (at > 0 && at != never) push({.at = at});
}

/// Adds a contact to the wire that is being added.
void Switches::add_contact(const ContactConfig& config, bool normally_closed) {
  check(config);
  Contact contact{.config = config,
                  .wire = wires_.size(),
                  .bounce = BounceMaker(config.bounce),
                  .by_hand = worked_by_hand(config)};
  for (int axis = 0; axis < max_axes; ++axis)
    contact.coming[index(axis)] = nearness(contact, axis, place_[index(axis)]);
  contact.now = contact.coming;
  contact.engaged = is_engaged(contact);
  contact.conducts = contact.engaged != normally_closed;
  contacts_.push_back(std::move(contact));
  if (config.bridged_from > 0 && config.bridged_from != never) push({.at = config.bridged_from});
}

Switches::Nearness Switches::nearness(const Contact& contact, int axis, std::int32_t place) const {
  const StepRange& range = contact.config.place[index(axis)];
  return {range.holds(place), range.holds(place, contact.config.hysteresis_steps)};
}

void Switches::push(Event event) {
  event.order = pushed_++;
  events_.push(event);
}

void Switches::load_moves(int axis, std::int32_t place, Picoseconds at) {
  place_[index(axis)] = place;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    Contact& contact = contacts_[i];
    const Nearness after = nearness(contact, axis, place);
    if (after == contact.coming[index(axis)]) continue;
    contact.coming[index(axis)] = after;
    push({.at = at, .kind = Kind::moved, .contact = i, .axis = axis, .nearness = after});
  }
}

void Switches::work_by_hand(Pin pin, bool engaged, Picoseconds at) {
  const Wire& wire = wire_of(pin);
  for (std::size_t i = wire.first; i < wire.end; ++i)
    if (contacts_[i].by_hand) push({.at = at, .kind = Kind::hand, .contact = i, .level = engaged});
}

void Switches::break_wire(Pin pin, Picoseconds at) {
  wire_of(pin).config.broken_from = at;
  push({.at = at});
}

void Switches::short_wire(Pin pin, Picoseconds at) {
  wire_of(pin).config.shorted_from = at;
  push({.at = at});
}

Switches::Wire& Switches::wire_of(Pin pin) {
  for (Wire& wire : wires_)
    if (wire.config.pin == pin) return wire;
  throw std::invalid_argument("no switch on this pin");
}

bool Switches::engaged(Pin pin) const {
  return std::any_of(contacts_.begin(), contacts_.end(), [this, pin](const Contact& contact) {
    return wires_[contact.wire].config.pin == pin && contact.engaged;
  });
}

/// Events at one time are applied together: two axes may step at once.
void Switches::advance(Picoseconds to) {
  while (next_event() <= to) {
    const Picoseconds at = next_event();
    while (next_event() == at) {
      const Event event = events_.top();
      events_.pop();
      apply(event);
    }
    for (std::size_t i = 0; i < contacts_.size(); ++i) settle(i, at);
    for (const Wire& wire : wires_) bus_.set(wire.config.pin, level(wire, at), at);
  }
}

void Switches::apply(const Event& event) {
  Contact& contact = contacts_[event.contact];
  switch (event.kind) {
    case Kind::look:
      break;
    case Kind::moved:
      contact.now[index(event.axis)] = event.nearness;
      break;
    case Kind::hand:
      contact.pressed = event.level;
      break;
    case Kind::bounced:
      if (event.burst == contact.burst) contact.conducts = event.level;
      break;
  }
}

bool Switches::is_engaged(const Contact& contact) {
  if (contact.by_hand) return contact.pressed;
  return std::all_of(contact.now.begin(), contact.now.end(), [&](const Nearness& axis) {
    return contact.engaged ? axis.near : axis.inside;
  });
}

/// A contact that was engaged or released changes at once and bounces afterwards.
void Switches::settle(std::size_t number, Picoseconds at) {
  Contact& contact = contacts_[number];
  const bool engaged = is_engaged(contact);
  if (engaged == contact.engaged) return;
  contact.engaged = engaged;
  contact.conducts = engaged != wires_[contact.wire].config.normally_closed;
  ++contact.burst;
  bool conducts = contact.conducts;
  for (const Picoseconds time : contact.bounce.burst(contact.conducts, at)) {
    conducts = !conducts;
    push({.at = time,
          .kind = Kind::bounced,
          .contact = number,
          .level = conducts,
          .burst = contact.burst});
  }
}

bool Switches::level(const Wire& wire, Picoseconds at) const {
  if (at >= wire.config.broken_from) return true;
  if (at >= wire.config.shorted_from) return false;
  const auto conducts = [at](const Contact& contact) {
    return contact.conducts || at >= contact.config.bridged_from;
  };
  const auto first = contacts_.begin() + static_cast<std::ptrdiff_t>(wire.first);
  const auto end = contacts_.begin() + static_cast<std::ptrdiff_t>(wire.end);
  return wire.config.normally_closed ? !std::all_of(first, end, conducts)
                                     : std::none_of(first, end, conducts);
}

Picoseconds Switches::next_look(Picoseconds now) const {
  std::int64_t nearest = std::numeric_limits<std::int32_t>::max();
  for (const Contact& contact : contacts_) {
    if (contact.by_hand) continue;
    for (std::size_t axis = 0; axis < place_.size(); ++axis)
      nearest = std::min(nearest, steps_to_edge(contact.config.place[axis],
                                                contact.config.hysteresis_steps, place_[axis]));
  }
  return now + nearest * min_period_;
}

}  // namespace lamplock::sim
