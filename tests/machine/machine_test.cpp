// The table of states: what holds for every state, activity, event and condition.
#include "firmware/machine/machine.hpp"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "tests/scale.hpp"

namespace lamplock::test::machine_test {
namespace {

using machine::Activity;
using machine::Conditions;
using machine::Event;
using machine::State;
using wire::HoldReason;
using enum machine::State;

constexpr Conditions every_condition = 1u << machine::condition_count;

struct Cell {
  State state;
  Activity activity;
  friend auto operator<=>(const Cell&, const Cell&) = default;
};
std::ostream& operator<<(std::ostream& out, const Cell& cell) {
  return out << "state " << static_cast<int>(cell.state) << " of activity "
             << static_cast<int>(cell.activity);
}

const machine::Transition* row_of(const Cell& cell, Event event, Conditions conditions) {
  return machine::find_transition(event, cell.state, cell.activity, conditions);
}

Cell after(const Cell& cell, Event event, Conditions conditions) {
  const machine::Transition* row = row_of(cell, event, conditions);
  if (row == nullptr) return cell;
  return {row->next == machine::same_state ? cell.state : row->next,
          row->next_activity == machine::same_activity ? cell.activity : row->next_activity};
}

using Visit = std::function<void(const Cell&, Event, Conditions, const Cell& next)>;

/// Calls `visit` for every event and condition in a cell.
void each_event(const Cell& cell, const Visit& visit) {
  for (int e = 0; e < machine::event_count; ++e)
    for (Conditions c = 0; c < every_condition; ++c)
      visit(cell, static_cast<Event>(e), c, after(cell, static_cast<Event>(e), c));
}

/// Every cell that events reach from one.
std::set<Cell> reached_from(const Cell& begin) {
  std::set<Cell> found{begin};
  std::deque<Cell> open{begin};
  for (; !open.empty(); open.pop_front())
    each_event(open.front(), [&](const Cell&, Event, Conditions, const Cell& next) {
      if (found.insert(next).second) open.push_back(next);
    });
  return found;
}

const std::set<Cell>& cells() {
  static const std::set<Cell> all = reached_from({idle, Activity::none});
  return all;
}

void each(const Visit& visit) {
  for (const Cell& cell : cells()) {
    SCOPED_TRACE(testing::Message() << cell);
    each_event(cell, visit);
  }
}

bool ends(const Cell& cell) {
  return cell.state == stopping || cell.state == resetting || cell.state == aborting;
}

TEST(Machine, ReachesOnlyStatesThatMeanSomething) {
  using enum Activity;
  const std::map<State, std::set<Activity>> meant{
      {idle, {none}},
      {check, {none}},
      {sleep, {none}},
      {alarm, {none}},
      {estop, {none}},
      {running, {points, rows, program, jog, homing, tool_change}},
      {holding, {none, points, rows, program, tool_change}},
      {door, {none, points, rows, program, tool_change}},
      {stopping, {points, rows, program, jog, homing, tool_change}},
      {resetting, {none, points, rows, program, jog, tool_change}},
      {aborting, {none, program, jog, homing, tool_change}}};
  std::map<State, std::set<Activity>> reached;
  for (const Cell& cell : cells()) reached[cell.state].insert(cell.activity);
  EXPECT_EQ(reached, meant);
}

TEST(Machine, EveryRowOfTheTableIsUsedByEachOfItsEvents) {
  std::map<const machine::Transition*, machine::EventSet> used;
  each([&](const Cell& cell, Event event, Conditions conditions, const Cell&) {
    if (const machine::Transition* row = row_of(cell, event, conditions))
      used[row] |= machine::events(event);
  });
  for (const machine::Transition& row : machine::transitions())
    EXPECT_EQ(used[&row], row.on) << "row " << &row - machine::transitions().data();
}

/// Events that lead the same way are in one row.
TEST(Machine, NoRowIsInTheTableTwice) {
  std::set<std::array<unsigned, 8>> rows;
  for (const machine::Transition& row : machine::transitions()) {
    const auto number = [](auto value) { return static_cast<unsigned>(value); };
    const bool is_new =
        rows.insert({row.from, row.of, row.needs, row.excludes, number(row.next),
                     number(row.next_activity), number(row.effect), number(row.reason)})
            .second;
    EXPECT_TRUE(is_new) << "row " << &row - machine::transitions().data();
  }
}

TEST(Machine, ComesBackToIdleFromEverywhere) {
  for (const Cell& cell : cells())
    EXPECT_TRUE(reached_from(cell).contains({idle, Activity::none})) << cell;
}

TEST(Machine, IsLockedWhileTheEStopIsPressed) {
  each([](const Cell& cell, Event event, Conditions, const Cell& next) {
    if (event == Event::estop_pressed) {
      EXPECT_EQ(next.state, estop);
    } else if (cell.state == estop && event != Event::estop_released) {
      EXPECT_EQ(next, cell);
    } else {
      EXPECT_TRUE(next.state != estop || cell.state == estop);
    }
  });
}

TEST(Machine, LeavesAnAlarmOnlyByItsUser) {
  const std::set<Event> of_user{Event::unlock, Event::begin_homing, Event::go_to_sleep,
                                Event::estop_pressed};
  each([&](const Cell& cell, Event event, Conditions conditions, const Cell& next) {
    if (cell.state != alarm || next == cell) return;
    EXPECT_TRUE(of_user.contains(event)) << static_cast<int>(event);
    EXPECT_FALSE(event == Event::unlock && (conditions & machine::door_is_open) != 0);
  });
}

TEST(Machine, WhatEndsDoesNotContinue) {
  each([](const Cell& cell, Event, Conditions conditions, const Cell& next) {
    if (!ends(cell)) return;
    // The jog has ended; the program that waits for a tool has not.
    const bool of_tool_change = cell.activity == Activity::jog &&
                                (conditions & machine::tool_is_awaited) != 0 &&
                                next.activity == Activity::tool_change;
    if (of_tool_change) return;
    EXPECT_TRUE(ends(next) || next.activity == Activity::none);
    EXPECT_NE(next.state, running);
    EXPECT_NE(next.state, holding);
    EXPECT_NE(next.state, door);
  });
}

TEST(Machine, StopsEveryActivity) {
  each([](const Cell& cell, Event event, Conditions, const Cell& next) {
    const bool active = cell.state == running || cell.state == holding || cell.state == door;
    if (event == Event::stop && active) {
      EXPECT_EQ(next.state, stopping);
    }
    if (event == Event::fault && cell.state != estop) {
      EXPECT_EQ(next.state, alarm);
    }
  });
}

TEST(Machine, HoldsOrEndsWhatRuns) {
  const std::set<Event> holds{Event::hold_byte, Event::hold, Event::door_byte, Event::door_opened,
                              Event::reset};
  each([&](const Cell& cell, Event event, Conditions, const Cell& next) {
    if (cell.state == running && holds.contains(event)) {
      EXPECT_NE(next.state, running);
    }
    if (event == Event::door_opened && cell.state == holding) {
      EXPECT_EQ(next.state, door);
    }
    if (event == Event::hold_byte && cell.state == idle) {
      EXPECT_EQ(next.state, holding);
    }
  });
}

/// A program continues only by a resume, with the door shut, or ends; what interrupts the tool
/// change leads back to it.
TEST(Machine, AToolChangeEndsOnlyByItsUserOrAStop) {
  each([](const Cell& cell, Event event, Conditions conditions, const Cell& next) {
    if (cell.activity != Activity::tool_change || next == cell) return;
    if (next.activity == Activity::program) {
      EXPECT_EQ(event, Event::resume);
      EXPECT_EQ(cell.state, running);
      EXPECT_EQ(conditions & (machine::users_line_runs | machine::is_moving), 0);
    } else if (next.activity == Activity::jog) {
      EXPECT_EQ(event, Event::begin_jog);
    } else if (next.activity == Activity::none) {
      EXPECT_TRUE(ends(cell) || next.state == alarm || next.state == estop);
    } else {
      EXPECT_EQ(next.activity, Activity::tool_change);
    }
    if (event == Event::resume && next.state == running) {
      EXPECT_TRUE(cell.state == running || (conditions & machine::door_is_open) == 0);
    }
  });
}

TEST(Machine, BeginsOnlyWhenNothingElseIsUnderWay) {
  each([](const Cell& cell, Event event, Conditions conditions, const Cell& next) {
    if (next.state != running || cell.state == running) return;
    if (event == Event::resume) {
      EXPECT_TRUE(cell.state == holding || cell.state == door);
      EXPECT_EQ(next.activity, cell.activity);
      EXPECT_EQ(conditions & machine::door_is_open, 0);
    } else {
      if (cell.state == stopping) {
        EXPECT_EQ(cell.activity, Activity::jog);
        EXPECT_EQ(next.activity, Activity::tool_change);
        EXPECT_EQ(conditions & machine::door_is_open, 0);
        return;
      }
      EXPECT_EQ(cell.activity, Activity::none);
      EXPECT_TRUE(cell.state == idle || (event == Event::begin_homing && cell.state == alarm));
    }
  });
}

TEST(Machine, KnowsWhyItIsHeldAndWhichAlarmItHas) {
  std::mt19937 random(1);
  machine::Machine machine;
  for (int i = 0; i < scaled(200'000); ++i) {
    const auto event = static_cast<Event>(random() % machine::event_count);
    const auto conditions = static_cast<Conditions>(random() % every_condition);
    machine.apply(event, conditions, static_cast<std::uint8_t>(1 + random() % 6));
    ASSERT_EQ(machine.alarm() != 0, machine.locked()) << static_cast<int>(event);
    if (machine.state() == holding) {
      ASSERT_NE(machine.hold_reason(), HoldReason::none);
    }
    if (machine.state() == running || machine.state() == door) {
      ASSERT_EQ(machine.hold_reason(), HoldReason::none);
    }
  }
}

TEST(Machine, AHoldByTheHostOutranksTheOthers) {
  const auto held_by = [](std::initializer_list<std::pair<Event, HoldReason>> events) {
    machine::Machine machine;
    machine.apply(Event::begin_points, 0);
    for (const auto& [event, reason] : events)
      machine.apply(event, 0, static_cast<std::uint8_t>(reason));
    return machine.hold_reason();
  };
  using enum HoldReason;
  EXPECT_EQ(held_by({{Event::hold, dead_man}, {Event::hold_byte, realtime}}), realtime);
  EXPECT_EQ(held_by({{Event::hold_byte, realtime}, {Event::hold, dead_man}}), realtime);
  EXPECT_EQ(held_by({{Event::hold, dead_man}, {Event::hold, host}}), host);
  EXPECT_EQ(held_by({{Event::hold, host}, {Event::hold_byte, realtime}}), host);
  EXPECT_EQ(held_by({{Event::hold, lamp}, {Event::resume, none}}), none);
  // A host that asks later learns why its job is over.
  EXPECT_EQ(held_by({{Event::reset, reset}, {Event::settled, none}}), reset);
}

TEST(Machine, ReportsStatesToTheWire) {
  for (const Cell& cell : cells()) {
    const bool home = cell.activity == Activity::homing;
    const bool waits = cell.activity == Activity::tool_change && cell.state == running;
    const wire::MachineState expected = cell.state == alarm     ? wire::MachineState::alarm
                                        : cell.state == estop   ? wire::MachineState::estop
                                        : cell.state == holding ? wire::MachineState::hold
                                        : cell.state == door    ? wire::MachineState::door
                                        : home                  ? wire::MachineState::home
                                        : waits                 ? wire::MachineState::hold
                                        : ends(cell) || cell.state == running
                                            ? wire::MachineState::run
                                            : wire::MachineState::idle;
    EXPECT_EQ(machine::wire_state(cell.state, cell.activity), expected) << cell;
  }
}

}  // namespace
}  // namespace lamplock::test::machine_test
