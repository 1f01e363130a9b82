// Switches that the machine works itself: limit and home switches, probes; also such that a hand
// works, if they are to bounce or to break.
//
// In:  each step of the drives; what a hand does; when a wire breaks.
// Out: the wires' levels, each change at its exact time: that of the step that took the load over
//      the place, and the lag of the drive. A contact rattles for a while then (bounce.hpp).
// A wire is one input of the board, with a pull-up, and contacts to ground: normally closed ones in
// series (docs/wiring.md: high = engaged or a broken wire), or normally open ones in parallel (a
// probe: low = touches).
// Who: the drives call load_moves() for each step of an axis that a contact looks at; World asks
//      next_event() and calls advance(). A board that puts out steps in slices, axis after axis,
//      ends its slice at next_look(), so that it sees a change within a step of its cause.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <vector>

#include "sim/world/bounce.hpp"
#include "sim/world/drives.hpp"
#include "sim/world/pins.hpp"

namespace lamplock::sim {

/// Places of an axis in steps, both ends included.
struct StepRange {
  std::int32_t low = std::numeric_limits<std::int32_t>::min();
  std::int32_t high = std::numeric_limits<std::int32_t>::max();
  bool everywhere() const { return *this == StepRange{}; }
  /// Inside, or so far outside.
  bool holds(std::int32_t place, std::int32_t outside = 0) const {
    return std::int64_t{place} >= std::int64_t{low} - outside &&
           std::int64_t{place} <= std::int64_t{high} + outside;
  }
  friend bool operator==(const StepRange&, const StepRange&) = default;
};

/// One contact. It is engaged while the load of every axis is within its range: a limit switch
/// looks at one axis, a probe at Z alone (a plane) or at several (the top of a box). With no range
/// at all a hand works it.
struct ContactConfig {
  PerAxis<StepRange> place{};
  std::int32_t hysteresis_steps = 0;  ///< let go only so far outside
  BounceConfig bounce{};
  Picoseconds bridged_from = never;  ///< short across it: it conducts, whatever happens

  /// Engages from a place on upwards, or downwards.
  static ContactConfig above(int axis, std::int32_t from, std::int32_t hysteresis_steps = 0);
  static ContactConfig below(int axis, std::int32_t from, std::int32_t hysteresis_steps = 0);
};

/// One input of the board.
struct WireConfig {
  Pin pin = Pin::limit_x;
  std::vector<ContactConfig> contacts;
  bool normally_closed = true;       ///< else open, in parallel
  Picoseconds broken_from = never;   ///< open circuit for good
  Picoseconds shorted_from = never;  ///< connected to ground for good, unless broken
};

/// All of them; must live as long as the drives.
class Switches final : public LoadListener {
 public:
  /// Throws std::invalid_argument if a wire has no contact, shares its pin, or a number is no
  /// number of a switch. Levels that are not those of rest are made at time 0.
  Switches(const std::vector<WireConfig>& wires, PinBus& bus, Drives& drives);
  Switches(const Switches&) = delete;
  Switches& operator=(const Switches&) = delete;

  /// `never` if nothing is due.
  Picoseconds next_event() const { return events_.empty() ? never : events_.top().at; }
  void advance(Picoseconds to);

  /// Until then no step that comes after `now` can reach a contact, except the last one before it.
  Picoseconds next_look(Picoseconds now) const;

  /// A hand works the contacts of a wire that have no place.
  void work_by_hand(Pin pin, bool engaged, Picoseconds at);
  void break_wire(Pin pin, Picoseconds at);
  void short_wire(Pin pin, Picoseconds at);

  /// As it is pressed, without bouncing and broken wires.
  bool engaged(Pin pin) const;

  void load_moves(int axis, std::int32_t place, Picoseconds at) override;

 private:
  /// Is an axis within its range, is it within the range and the hysteresis?
  struct Nearness {
    bool inside = true;
    bool near = true;
    friend bool operator==(const Nearness&, const Nearness&) = default;
  };
  struct Contact {
    ContactConfig config;
    std::size_t wire;
    BounceMaker bounce;
    bool by_hand;
    bool pressed = false;        ///< by the hand
    PerAxis<Nearness> coming{};  ///< after all steps so far
    PerAxis<Nearness> now{};
    bool engaged = false;
    bool conducts = false;
    std::uint32_t burst = 0;  ///< of bounces; what is left of an older one is not made
  };
  struct Wire {
    WireConfig config;
    std::size_t first, end;  ///< of its contacts
  };
  enum class Kind : std::uint8_t { look, moved, hand, bounced };
  struct Event {
    Picoseconds at = 0;
    std::uint64_t order = 0;
    Kind kind = Kind::look;
    std::size_t contact = 0;
    int axis = 0;
    Nearness nearness{};  ///< moved
    bool level = false;   ///< hand: engaged; bounced: conducts
    std::uint32_t burst = 0;
    friend bool operator>(const Event& a, const Event& b) {
      return a.at != b.at ? a.at > b.at : a.order > b.order;
    }
  };

  void add(const WireConfig& config);
  void add_contact(const ContactConfig& config, bool normally_closed);
  Nearness nearness(const Contact& contact, int axis, std::int32_t place) const;
  void push(Event event);
  void apply(const Event& event);
  static bool is_engaged(const Contact& contact);
  void settle(std::size_t contact, Picoseconds at);
  bool level(const Wire& wire, Picoseconds at) const;
  Wire& wire_of(Pin pin);

  PinBus& bus_;
  Picoseconds min_period_;
  std::vector<Wire> wires_;
  std::vector<Contact> contacts_;
  PerAxis<std::int32_t> place_{};  ///< after all steps so far
  std::uint64_t pushed_ = 0;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
};

}  // namespace lamplock::sim
