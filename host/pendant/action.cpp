#include "host/pendant/action.hpp"

#include <array>

namespace lamplock::pendant {
namespace {

constexpr std::array rows{
    ActionRow{Action::none, "none", "nothing"},
    ActionRow{Action::stop, "stop",
              "ends a jog (0x85) and a macro, holds what else moves, ends homing"},
    ActionRow{Action::reset, "reset", "soft reset (0x18)"},
    ActionRow{Action::start, "start", "goes on after a hold (~)"},
    ActionRow{Action::hold, "hold", "holds (!)"},
    ActionRow{Action::start_pause, "start-pause", "holds what runs, goes on with what is held"},
    ActionRow{Action::unlock, "unlock", "ends an alarm ($X)"},
    ActionRow{Action::home, "home", "finds the switches ($H)"},
    ActionRow{Action::zero, "zero", "zero of the chosen axis is where it stands"},
    ActionRow{Action::zero_x, "zero-x", "likewise of X"},
    ActionRow{Action::zero_y, "zero-y", "likewise of Y"},
    ActionRow{Action::zero_z, "zero-z", "likewise of Z"},
    ActionRow{Action::zero_a, "zero-a", "likewise of A"},
    ActionRow{Action::zero_all, "zero-all", "likewise of all axes"},
    ActionRow{Action::go_to_zero, "go-to-zero", "X and Y go to zero"},
    ActionRow{Action::safe_z, "safe-z", "Z goes to `safe_z`, machine coordinate"},
    ActionRow{Action::feed_full, "feed-full", "feed override 100 %"},
    ActionRow{Action::feed_plus, "feed-plus", "feed override 10 % more"},
    ActionRow{Action::feed_minus, "feed-minus", "feed override 10 % less"},
    ActionRow{Action::power_full, "power-full", "override of power or spindle 100 %"},
    ActionRow{Action::power_plus, "power-plus", "override of power or spindle 10 % more"},
    ActionRow{Action::power_minus, "power-minus", "override of power or spindle 10 % less"},
    ActionRow{Action::next_step, "next-step", "the next of `steps`, the first behind the last"},
    ActionRow{Action::greater_step, "greater-step", "the next of `steps`"},
    ActionRow{Action::smaller_step, "smaller-step", "the one before"},
    ActionRow{Action::next_mode, "next-mode", "step, continuous, feed, step"},
    ActionRow{Action::mode_step, "mode-step", "the wheel moves by steps"},
    ActionRow{Action::mode_continuous, "mode-continuous",
              "the wheel moves at the feed while it turns"},
    ActionRow{Action::mode_feed, "mode-feed", "the wheel turns the feed override"},
    ActionRow{Action::next_axis, "next-axis", "chooses the next axis"},
    ActionRow{Action::axis_x, "axis-x", "chooses X"},
    ActionRow{Action::axis_y, "axis-y", "chooses Y"},
    ActionRow{Action::axis_z, "axis-z", "chooses Z"},
    ActionRow{Action::axis_a, "axis-a", "chooses A"},
    ActionRow{Action::axis_off, "axis-off", "chooses none"},
    ActionRow{Action::jog_x_plus, "jog-x-plus", "a step; held: moves on, in mode continuous"},
    ActionRow{Action::jog_x_minus, "jog-x-minus", "the same, the other way"},
    ActionRow{Action::jog_y_plus, "jog-y-plus", "likewise"},
    ActionRow{Action::jog_y_minus, "jog-y-minus", "likewise"},
    ActionRow{Action::jog_z_plus, "jog-z-plus", "likewise"},
    ActionRow{Action::jog_z_minus, "jog-z-minus", "likewise"},
    ActionRow{Action::jog_a_plus, "jog-a-plus", "likewise"},
    ActionRow{Action::jog_a_minus, "jog-a-minus", "likewise"},
    ActionRow{Action::quit, "quit", "stops and leaves"}};
static_assert(rows.size() == static_cast<std::size_t>(Action::count));

constexpr bool in_order() {
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].action != static_cast<Action>(i)) return false;
  return true;
}
static_assert(in_order());

}  // namespace

std::span<const ActionRow> action_rows() { return rows; }

std::string_view action_name(Action action) { return rows[static_cast<std::size_t>(action)].name; }

std::optional<Action> action_named(std::string_view name) {
  for (const ActionRow& row : rows)
    if (row.name == name) return row.action;
  return std::nullopt;
}

}  // namespace lamplock::pendant
