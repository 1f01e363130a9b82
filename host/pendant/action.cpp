#include "host/pendant/action.hpp"

#include <array>

namespace lamplock::pendant {
namespace {

using enum Action;

constexpr auto rows = std::to_array<ActionRow>(
    {{none, "none", "nothing"},
     {stop, "stop", "ends a jog (0x85) and a macro, holds what else moves, ends homing"},
     {reset, "reset", "soft reset (0x18)"},
     {start, "start", "goes on after a hold (~)"},
     {hold, "hold", "holds (!)"},
     {start_pause, "start-pause",
      "holds what runs, goes on with what is held; ends a jog and homing"},
     {unlock, "unlock", "ends an alarm ($X)"},
     {home, "home", "finds the switches ($H)"},
     {zero, "zero", "zero of the chosen axis is where it stands"},
     {zero_x, "zero-x", "likewise of X"},
     {zero_y, "zero-y", "likewise of Y"},
     {zero_z, "zero-z", "likewise of Z"},
     {zero_a, "zero-a", "likewise of A"},
     {zero_all, "zero-all", "likewise of all axes"},
     {go_to_zero, "go-to-zero", "X and Y go to zero"},
     {safe_z, "safe-z", "Z goes to `safe_z`, machine coordinate"},
     {feed_full, "feed-full", "feed override 100 %"},
     {feed_plus, "feed-plus", "feed override 10 % more"},
     {feed_minus, "feed-minus", "feed override 10 % less"},
     {power_full, "power-full", "override of power or spindle 100 %"},
     {power_plus, "power-plus", "override of power or spindle 10 % more"},
     {power_minus, "power-minus", "override of power or spindle 10 % less"},
     {next_step, "next-step", "the next of `steps`, the first behind the last"},
     {greater_step, "greater-step", "the next of `steps`"},
     {smaller_step, "smaller-step", "the one before"},
     {next_mode, "next-mode", "step, continuous, feed, step"},
     {mode_step, "mode-step", "the wheel moves by steps"},
     {mode_continuous, "mode-continuous", "the wheel moves at the feed while it turns"},
     {mode_feed, "mode-feed", "the wheel turns the feed override"},
     {next_axis, "next-axis", "chooses the next axis"},
     {axis_x, "axis-x", "chooses X"},
     {axis_y, "axis-y", "chooses Y"},
     {axis_z, "axis-z", "chooses Z"},
     {axis_a, "axis-a", "chooses A"},
     {axis_off, "axis-off", "chooses none"},
     {jog_x_plus, "jog-x-plus", "a step; held: moves on, in mode continuous"},
     {jog_x_minus, "jog-x-minus", "the same, the other way"},
     {jog_y_plus, "jog-y-plus", "likewise"},
     {jog_y_minus, "jog-y-minus", "likewise"},
     {jog_z_plus, "jog-z-plus", "likewise"},
     {jog_z_minus, "jog-z-minus", "likewise"},
     {jog_a_plus, "jog-a-plus", "likewise"},
     {jog_a_minus, "jog-a-minus", "likewise"},
     {quit, "quit", "stops and leaves"}});
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
