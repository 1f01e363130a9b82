// Cutter compensation in a statement: G40 to G42.1, and what they exclude.
#include "firmware/program/statement.hpp"

namespace lamplock::program {
namespace {

constexpr std::uint16_t dwell_code = 40, end_code = 2, end_and_rewind_code = 30;

/// Groups whose commands would move the contour or the machine under the path of the cutter.
constexpr Group excluded[] = {Group::tool_length, Group::system, Group::rotation,
                              Group::tool_change, Group::saving, Group::beat_lock,
                              Group::io,          Group::pulses};

}  // namespace

/// The side of the cutter, and its diameter.
bool Statement::cutter() {
  const std::uint16_t code = block_.code(Group::cutter), column = block_.column(Group::cutter);
  plan_.sets_cutter = true;
  if (code == 400) {
    after_.modal.cutter = Cutter::off;
    return true;
  }
  if (after_.modal.cutter != Cutter::off) return fail(GcodeError::compensation_on, column);
  after_.modal.cutter = code < 420 ? Cutter::left : Cutter::right;
  std::int64_t diameter_e7 = 0;
  if (!cutter_diameter(diameter_e7)) return false;
  cutter_radius_e7_ = diameter_e7 / 2;
  return true;
}

/// G41.1 and G42.1 have the diameter; G41 and G42 the number of a tool, by default the one in the
/// spindle.
bool Statement::cutter_diameter(std::int64_t& diameter_e7) {
  const std::uint16_t code = block_.code(Group::cutter);
  const Word* const word = block_.d_word();
  const std::uint16_t column = word == nullptr ? block_.column(Group::cutter) : word->column;
  block_.use(Ignored::d);
  if (code == 411 || code == 421) {
    if (word == nullptr) return fail(GcodeError::value_missing, column);
    diameter_e7 = length_e7(*word, after_.modal.inches);
    return inside(diameter_e7, ToolTable::max_diameter_e7, GcodeError::out_of_range, column);
  }
  std::uint32_t number = 0;
  Tool tool;
  if (!tool_of(word, number)) return false;
  if (number == 0) return fail(GcodeError::no_diameter, column);
  if (!find_tool(number, tool, column)) return false;
  diameter_e7 = tool.diameter_e7;
  return diameter_e7 != 0 || fail(GcodeError::no_diameter, column);
}

Fault Statement::check_compensated(const Modal& before) {
  const Modal& after = after_.modal;
  const auto fault = [&](Group group) {
    return Fault{GcodeError::compensation_on, block_.column(group)};
  };
  if (needs_machine_place() && block_.has(Group::once)) return fault(Group::once);
  if (before.cutter != Cutter::off) {
    for (const Group group : excluded)
      if (block_.has(group)) return fault(group);
    if (after.plane != before.plane) return fault(Group::plane);
    if (after.inches != before.inches) return fault(Group::units);
  }
  if (block_.has(Group::stopping)) {
    const std::uint16_t stop = block_.code(Group::stopping);
    const bool ends = stop == end_code || stop == end_and_rewind_code;
    if (!ends || move_is_asked()) return fault(Group::stopping);
  }
  if (after.cutter != Cutter::off &&
      (after.beat_lock != BeatLock::off || after.feed_mode == FeedMode::inverse_time))
    return {GcodeError::compensation_on, compensation_column()};
  if (block_.pieces() != 0) return {GcodeError::compensation_on, block_.word('S').column};
  const bool moves = plan_.stages >> static_cast<int>(Stage::via) != 0 && !plan_.has(Stage::stop);
  const bool known = plan_.motion == Motion::rapid || plan_.motion == Motion::line ||
                     (is_arc(plan_.motion) && plan_.turns <= 1);
  if (moves && !known) return {GcodeError::compensation_on, motion_column()};
  return {};
}

bool Statement::names_plane_axes() const {
  const PlaneAxes plane = axes_of(after_.modal.plane);
  return (block_.axes() & (1u << plane.first | 1u << plane.second)) != 0;
}

bool Statement::needs_machine_place() const {
  return (block_.has(Group::once) && block_.code(Group::once) != dwell_code) ||
         (block_.has(Group::cutter) && after_.modal.cutter != Cutter::off);
}

std::uint16_t Statement::compensation_column() const {
  if (block_.has(Group::cutter)) return block_.column(Group::cutter);
  if (block_.has(Group::stopping)) return block_.column(Group::stopping);
  if (block_.has(Group::motion) || block_.axes() != 0 || centre_column() != 0)
    return motion_column();
  return 1;
}

}  // namespace lamplock::program
