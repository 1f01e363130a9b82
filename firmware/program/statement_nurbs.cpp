// The block of a NURBS in a statement: G5.2, lines of control points, G5.3.
//
// As in LinuxCNC ("G-code Reference"): the curve begins where the program is, with the weight of a
// P beside G5.2 without X and Y; the block has only control points (X Y P); the motion mode is none
// from G5.2 on. The program is where the curve begins until G5.3.
#include "firmware/program/curves/nurbs.hpp"
#include "firmware/program/statement.hpp"

namespace lamplock::program {
namespace {

constexpr std::uint16_t nurbs_end_code = 53;
constexpr std::uint32_t default_order = 3, weight_one_e6 = 1'000'000;

}  // namespace

/// G5.2.
bool Statement::nurbs() {
  if (!curve_in_xy()) return false;
  if (after_.modal.cutter != Cutter::off) return fail_motion(GcodeError::compensation_on);
  std::uint32_t order = default_order;
  if (block_.has('L') && !integer('L', order)) return false;
  if (order < NurbsPoints::min_order || order > NurbsPoints::max_order)
    return fail_at('L', GcodeError::out_of_range);
  after_.nurbs = {plan_.start[0], plan_.start[1], 1, static_cast<std::uint8_t>(order)};
  after_.modal.motion = Motion::none;
  plan_.weights_e6[0] = weight_one_e6;
  return block_.axes() == 0 ? nurbs_weight(plan_.weights_e6[0]) : nurbs_point();
}

bool Statement::nurbs_weight(std::uint32_t& weight_e6) {
  weight_e6 = weight_one_e6;
  if (!block_.has('P')) return true;
  if (!unsigned_value('P', scaled(block_.word('P'), 1, 6), GcodeError::out_of_range, weight_e6))
    return false;
  return (weight_e6 >= NurbsPoints::min_weight_e6 && weight_e6 <= NurbsPoints::max_weight_e6) ||
         fail_at('P', GcodeError::out_of_range);
}

/// X Y P: one more control point.
bool Statement::nurbs_point() {
  const std::uint16_t column = block_.axis_column(block_.axes());
  if (after_.nurbs.count == NurbsPoints::capacity) return fail(GcodeError::out_of_range, column);
  if (!needed('X', column) || !needed('Y', column)) return false;
  if (!target(plan_.points[0], false) || !nurbs_weight(plan_.weights_e6[1])) return false;
  ++after_.nurbs.count;
  after_.nurbs.first_e7 = plan_.points[0][0];
  after_.nurbs.second_e7 = plan_.points[0][1];
  return true;
}

/// A line within the block.
bool Statement::nurbs_line() {
  if (!line_number()) return false;
  if (block_.code(Group::motion) == nurbs_end_code) return feed() && nurbs_end() && rest();
  if (block_.group_bits() != 0) return fail(GcodeError::unsupported, block_.first_code());
  if (block_.axes() == 0) return rest();
  return curve_in_xy() && nurbs_point() && rest();
}

/// G5.3: the curve is made.
bool Statement::nurbs_end() {
  const NurbsBlock& block = after_.nurbs;
  if (block_.group_bits() != 1u << static_cast<int>(Group::motion))
    return fail(GcodeError::unsupported, block_.first_code());
  if (block.count < block.order) return fail_motion(GcodeError::no_offset_in_plane);
  if (!feed_in_force()) return false;
  plan_.start = after_.programmed_e7;
  plan_.motion = Motion::nurbs;
  plan_.add(Stage::curve);
  Place end = plan_.start;
  end[0] = block.first_e7;
  end[1] = block.second_e7;
  after_.nurbs = {};
  return end_at(end);
}

}  // namespace lamplock::program
