// Switches that the machine works itself: limit and home switches, probes; also those worked by
// hand, if they bounce or break.
//
// In:  each step of the drives; actions of a hand; the times at which wires break.
// Out: the wires' levels, each change at its exact time: that of the step that took the load over
//      the switching point, plus the lag of the drive. A contact then bounces for a while
//      (bounce.hpp).
// A wire is one input of the board, with a pull-up, and contacts to ground: normally closed ones in
// series (docs/wiring.md: high = engaged or a broken wire), or normally open ones in parallel (a
// probe: low = touches).
// Who: the drives call load_moves() for each step of an axis that a contact depends on; World calls
//      next_event() and advance(). A board that puts out steps in slices, axis after axis, ends its
//      slice at next_look(), so that it sees a change within a step of its cause.
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

/// A range of positions of an axis in steps, both ends included.
struct StepRange {
  std::int32_t low = std::numeric_limits<std::int32_t>::min();
  std::int32_t high = std::numeric_limits<std::int32_t>::max();
  bool everywhere() const { return *this == StepRange{}; }
  /// Inside the range, or at most `outside` steps outside.
  bool holds(std::int32_t place, std::int32_t outside = 0) const {
    return std::int64_t{place} >= std::int64_t{low} - outside &&
           std::int64_t{place} <= std::int64_t{high} + outside;
  }
  friend bool operator==(const StepRange&, const StepRange&) = default;
};

/// One contact. It is engaged while the load of every axis is within its range: a limit switch
/// depends on one axis, a probe on Z alone (a plane) or on several (the top of a box). A contact
/// without a range is worked by hand.
struct ContactConfig {
  PerAxis<StepRange> place{};
  std::int32_t hysteresis_steps = 0;  ///< released only this far outside
  BounceConfig bounce{};
  Picoseconds bridged_from = never;  ///< shorted: it always conducts from then on

  /// Engages from a position on upwards, or downwards.
  static ContactConfig above(int axis, std::int32_t from, std::int32_t hysteresis_steps = 0);
  static ContactConfig below(int axis, std::int32_t from, std::int32_t hysteresis_steps = 0);
};

/// One input of the board.
struct WireConfig {
  Pin pin = Pin::limit_x;
  std::vector<ContactConfig> contacts;
  bool normally_closed = true;       ///< else open, in parallel
  Picoseconds broken_from = never;   ///< permanently open circuit
  Picoseconds shorted_from = never;  ///< permanently connected to ground, unless broken
};

/// All switches; must live as long as the drives.
class Switches final : public LoadListener {
 public:
  /// Throws std::invalid_argument if a wire has no contact, shares its pin, or a number is out of
  /// its range. Levels that differ from those at rest are set at time 0.
  Switches(const std::vector<WireConfig>& wires, PinBus& bus, Drives& drives);
  Switches(const Switches&) = delete;
  Switches& operator=(const Switches&) = delete;

  /// `never` if nothing is due.
  Picoseconds next_event() const { return events_.empty() ? never : events_.top().at; }
  void advance(Picoseconds to);

  /// Until then no step after `now` can reach a contact, except the last one before it.
  Picoseconds next_look(Picoseconds now) const;

  /// Works by hand the contacts of a wire that have no range.
  void work_by_hand(Pin pin, bool engaged, Picoseconds at);
  void break_wire(Pin pin, Picoseconds at);
  void short_wire(Pin pin, Picoseconds at);

  /// True if pressed, ignoring bounces and broken wires.
  bool engaged(Pin pin) const;

  void load_moves(int axis, std::int32_t place, Picoseconds at) override;

 private:
  /// Whether an axis is within its range, and whether it is within the range plus hysteresis.
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
    std::uint32_t burst = 0;  ///< of bounces; the rest of an older one is dropped
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
