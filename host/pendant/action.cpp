#include "host/pendant/action.hpp"

#include <array>

namespace lamplock::pendant {
namespace {

using enum Action;

constexpr auto rows = std::to_array<ActionRow>(
    {{none, "none", "nothing"},
     {stop, "stop", "cancels a jog (0x85), ends a macro and homing, holds other motion (!)"},
     {reset, "reset", "soft reset (0x18)"},
     {start, "start", "resumes after a hold (~)"},
     {hold, "hold", "feed hold (!)"},
     {start_pause, "start-pause",
      "holds motion (!), resumes held motion (~), cancels a jog, ends homing"},
     {unlock, "unlock", "ends an alarm ($X)"},
     {home, "home", "homes the axes ($H)"},
     {zero, "zero", "sets zero of the selected axis at its current position"},
     {zero_x, "zero-x", "sets zero of X"},
     {zero_y, "zero-y", "sets zero of Y"},
     {zero_z, "zero-z", "sets zero of Z"},
     {zero_a, "zero-a", "sets zero of A"},
     {zero_all, "zero-all", "sets zero of all axes"},
     {go_to_zero, "go-to-zero", "moves X and Y to zero"},
     {safe_z, "safe-z", "moves Z to `safe_z`, a machine coordinate"},
     {feed_full, "feed-full", "sets the feed override to 100 %"},
     {feed_plus, "feed-plus", "raises the feed override by 10 %"},
     {feed_minus, "feed-minus", "lowers the feed override by 10 %"},
     {power_full, "power-full", "sets the override of power or spindle to 100 %"},
     {power_plus, "power-plus", "raises the override of power or spindle by 10 %"},
     {power_minus, "power-minus", "lowers the override of power or spindle by 10 %"},
     {next_step, "next-step", "selects the next of `steps`, after the last the first"},
     {greater_step, "greater-step", "selects the next greater of `steps`"},
     {smaller_step, "smaller-step", "selects the next smaller of `steps`"},
     {next_mode, "next-mode", "selects the next mode: step, continuous, feed, step"},
     {mode_step, "mode-step", "the wheel moves the axis by steps"},
     {mode_continuous, "mode-continuous", "the wheel moves the axis at the feed while it turns"},
     {mode_feed, "mode-feed", "the wheel changes the feed override"},
     {next_axis, "next-axis", "selects the next axis"},
     {axis_x, "axis-x", "selects X"},
     {axis_y, "axis-y", "selects Y"},
     {axis_z, "axis-z", "selects Z"},
     {axis_a, "axis-a", "selects A"},
     {axis_off, "axis-off", "selects no axis"},
     {jog_x_plus, "jog-x-plus", "moves X up by a step; while held in mode continuous, at the feed"},
     {jog_x_minus, "jog-x-minus", "the same, down"},
     {jog_y_plus, "jog-y-plus", "moves Y up likewise"},
     {jog_y_minus, "jog-y-minus", "moves Y down likewise"},
     {jog_z_plus, "jog-z-plus", "moves Z up likewise"},
     {jog_z_minus, "jog-z-minus", "moves Z down likewise"},
     {jog_a_plus, "jog-a-plus", "moves A up likewise"},
     {jog_a_minus, "jog-a-minus", "moves A down likewise"},
     {quit, "quit", "stops the machine and ends the program"}});
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
