// Coordinate systems in a statement: their choice, origins (G10 L2, L20) and rotations, G68, G92.
#include "firmware/program/statement.hpp"
#include "shared/fixed_point.hpp"

namespace lamplock::program {
namespace {

constexpr std::uint32_t turned_axes = 1u << 0 | 1u << 1;  // X and Y

Place difference(const Place& a, const Place& b) {
  Place result{};
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

}  // namespace

/// G68 is in force from here on.
void Statement::turn(const Rotation& rotation) {
  after_.modal.rotation = rotation;
  after_.programmed_e7 = after_.rotations().turned_back(after_.machine_e7);
}

/// The active coordinate system is rotated so from here on.
void Statement::turn_system(const Rotation& rotation) {
  if (!rotation.active() && !after_.system_rotation.active()) return;
  after_.system_rotation = rotation;
  after_.programmed_e7 = after_.rotations().turned_back(after_.machine_e7);
}

/// Another coordinate system is active.
void Statement::change_system() { turn_system(parameters_.rotation_of(after_.modal.system)); }

/// G54 to G59.3, G54.1.
bool Statement::system() {
  const std::uint32_t code = block_.code(Group::system);
  const std::uint8_t before = after_.modal.system;
  if (code == 541) {
    if (!additional_system()) return false;
  } else {
    const std::uint32_t number = code <= 590 ? (code - 540) / 10 : code - 590 + 5;
    after_.modal.system = static_cast<std::uint8_t>(number);
  }
  if (after_.modal.system != before) change_system();
  return true;
}

/// G68, G69.
bool Statement::rotation() {
  if (block_.code(Group::rotation) == 690) {
    turn({});
    return true;
  }
  if (!needed('R', block_.column(Group::rotation)) || !take('R')) return false;
  const PlaneAxes plane = axes_of(after_.modal.plane);
  const std::uint32_t others = block_.axes() & ~(1u << plane.first | 1u << plane.second);
  if (others != 0) return fail_axes(GcodeError::axis_words_unused, others);
  Place centre = after_.system_rotation.turned_back(after_.machine_e7);
  for (const int axis : {int{plane.first}, int{plane.second}}) {
    if ((block_.axes() >> axis & 1u) == 0) continue;
    centre[index(axis)] =
        axis_e7(axis) + (after_.modal.relative ? centre[index(axis)] : offset_e7(axis));
    if (!inside(centre[index(axis)], max_position_e7, GcodeError::bad_target,
                block_.axis(axis).column))
      return false;
  }
  block_.take_axes();
  turn(Rotation(plane.first, plane.second, after_.system_rotation.turned(centre),
                scaled(block_.word('R'), 1, 7)));
  return true;
}

/// G10.
bool Statement::set_system() {
  const std::uint16_t column = block_.column(Group::once);
  std::uint32_t kind = 0, number = 0;
  const bool has_words = block_.axes() != 0 || block_.has('R');
  if (!has_words) return fail(GcodeError::no_axis_words, column);
  if (!needed('L', column) || !needed('P', column)) return false;
  if (!integer('L', kind) || !integer('P', number)) return false;
  if (kind == 1 || kind == 10 || kind == 11) return enter_tool(kind, number);
  if (kind != 2 && kind != 20) return fail_at('L', GcodeError::unsupported);
  if (number > coordinate_systems) return fail_at('P', GcodeError::no_such_system);
  return set_origin(kind, number == 0 ? after_.modal.system : number - 1);
}

/// G10 L2 and L20 of coordinate system `row`.
bool Statement::set_origin(std::uint32_t kind, std::size_t row) {
  changes_.place = parameters_.systems_e7[row];
  changes_.rotation_e7 = parameters_.rotations_e7[row];
  if (block_.has('R')) {
    // As LinuxCNC: the position has no angle that the rotation could follow from.
    if (kind == 20) return fail_at('R', GcodeError::unsupported);
    if (!take('R')) return false;
    changes_.rotation_e7 = scaled(block_.word('R'), 1, 7);
  }
  if (kind == 20) {
    origin_of_position();
  } else {
    for (int i = 0; i < options_.axes; ++i)
      if ((block_.axes() >> i & 1u) != 0) changes_.place[index(i)] = axis_e7(i);
  }
  for (int i = 0; i < options_.axes; ++i) {
    const bool has_word = (block_.axes() >> i & 1u) != 0;
    const std::uint16_t column = has_word ? block_.axis(i).column : block_.column(Group::once);
    if (!inside(changes_.place[index(i)], 2 * max_position_e7, GcodeError::out_of_range, column))
      return false;
  }
  changes_.add(static_cast<int>(row));
  block_.take_axes();
  if (row == after_.modal.system)
    turn_system(Parameters::system_rotation(changes_.place, changes_.rotation_e7));
  return true;
}

/// The origin with which the current position has the coordinates of the axis words; the other
/// coordinates stay.
void Statement::origin_of_position() {
  Place& origin = changes_.place;
  const Place position = after_.system_rotation.turned(after_.programmed_e7);
  const Rotation rotation = Parameters::system_rotation({}, changes_.rotation_e7);
  Place way = rotation.turned_back(difference(position, origin));
  std::uint32_t axes = block_.axes();
  for (int i = 0; i < options_.axes; ++i) {
    if ((axes >> i & 1u) == 0) continue;
    const Place& active_origin = parameters_.systems_e7[after_.modal.system];
    way[index(i)] = axis_e7(i) + offset_e7(i) - active_origin[index(i)];
  }
  // The rotation joins X and Y.
  if (rotation.active() && (axes & turned_axes) != 0) axes |= turned_axes;
  const Place moved = difference(position, rotation.turned(way));
  for (int i = 0; i < options_.axes; ++i)
    if ((axes >> i & 1u) != 0) origin[index(i)] = moved[index(i)];
}

/// G92.
bool Statement::shift() {
  if (block_.axes() == 0) return fail(GcodeError::no_axis_words, block_.column(Group::once));
  // Axes without a word keep the active shift.
  Place place = after_.modal.shifted ? parameters_.shift_e7 : Place{};
  for (int i = 0; i < options_.axes; ++i) {
    if ((block_.axes() >> i & 1u) == 0) continue;
    std::int64_t& value = place[index(i)];
    const std::int64_t others = offset_e7(i) - value;
    value = after_.programmed_e7[index(i)] - others - axis_e7(i);
    if (!inside(value, 2 * max_position_e7, GcodeError::out_of_range, block_.axis(i).column))
      return false;
  }
  changes_.place = place;
  changes_.add(static_cast<int>(ParameterRow::shift));
  after_.modal.shifted = true;
  block_.take_axes();
  return true;
}

}  // namespace lamplock::program
