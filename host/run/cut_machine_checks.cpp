#include "host/run/cut_machine_checks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "host/error.hpp"
#include "host/run/bounds_text.hpp"
#include "host/run/prepare.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using cutting::MachineType;
using cutting::Operation;
using cutting::OperationKind;
using Warnings = std::vector<std::string>;

/// Without laser mode a board keeps the power of the beam where the machine brakes.
void warn_of_pulsed(const settings::Values& values, Warnings& warnings) {
  if (values.whole(settings::Id::laser_mode) != 0) return;
  warnings.emplace_back(
      "the settings are those of a pulsed laser (laser_mode = 0): give the profile of the laser "
      "cutter, and set laser_mode = 1 on its board, so that the beam is dimmed in corners");
}

/// A board permits light at rest up to a power and a time of its own.
void warn_of_dark_pierce(const std::vector<Operation>& operations, const settings::Values& values,
                         Warnings& warnings) {
  const double max_power = in_units(values, settings::Id::focus_power) / 100;
  const double max_s = in_units(values, settings::Id::focus_time);
  for (const Operation& one : operations) {
    if (one.pierce_s <= 0 || (one.power <= max_power && one.pierce_s <= max_s)) continue;
    warnings.push_back(
        fmt::format("{}: the settings permit light at rest with {:g} % for {:g} s (focus_power, "
                    "focus_time): the pierce time has no more",
                    one.name, max_power * 100, max_s));
  }
}

/// The beam removes half its width at both sides of a tab.
void warn_of_thin_tabs(const std::vector<Operation>& operations, Warnings& warnings) {
  for (const Operation& one : operations) {
    if (one.tabs.count == 0 || one.kerf_mm > 0) continue;
    warnings.push_back(
        fmt::format("{}: without a kerf the tabs are narrower than {:g} mm by the width of the "
                    "beam: give the kerf",
                    one.name, one.tabs.width_mm));
  }
}

}  // namespace

void require_power(const std::vector<Operation>& operations, MachineType machine,
                   const settings::Values& values) {
  constexpr double min_s = 0.0005;  // programs have three decimals
  constexpr double decimals = 1e6;  // of the percentage below
  const double max_s = in_units(values, settings::Id::max_spindle_speed);
  const double min_percent = std::ceil(min_s / max_s * 100 * decimals) / decimals;
  const bool is_laser = machine == MachineType::laser;
  for (const Operation& one : operations)
    if (one.kind != OperationKind::ignore && one.power * max_s < min_s)
      throw Error(
          Exit::bad_input, one.name,
          fmt::format("a {} of {:g} % is S0 in the program, {}", is_laser ? "power" : "speed",
                      one.power * 100, is_laser ? "without light" : "and the spindle would stop"),
          fmt::format("give at least {:.6f} %, or --dry", min_percent));
}

void require_inside(const std::string& drawing, const geometry::Bounds& box,
                    const settings::Values& values) {
  const geometry::Bounds space = work_space_mm(values);
  // A place on the edge is inside, to the rounding of positions.
  constexpr double slack_mm = 1e-6;
  const auto is_inside = [](double low, double high, double from, double to) {
    return low >= from - slack_mm && high <= to + slack_mm;
  };
  // A program without depths does not move Z.
  const bool moves_z = box.low.z != 0 || box.high.z != 0;
  const bool is_in_plane = is_inside(box.low.x, box.high.x, space.low.x, space.high.x) &&
                           is_inside(box.low.y, box.high.y, space.low.y, space.high.y);
  const bool is_in_depth = !moves_z || is_inside(box.low.z, box.high.z, space.low.z, space.high.z);
  if (is_in_plane && is_in_depth) return;
  if (is_in_plane)
    throw Error(Exit::bad_input, drawing,
                fmt::format("Z would leave the work space: {:.6g} to {:.6g} mm; the machine has "
                            "{:.6g} to {:.6g} mm",
                            box.low.z, box.high.z, space.low.z, space.high.z),
                "change the surface, the final depth or the clearance, or give the profile of "
                "another machine");
  const bool fits = box.high.x - box.low.x <= space.high.x - space.low.x &&
                    box.high.y - box.low.y <= space.high.y - space.low.y;
  throw Error(Exit::bad_input, drawing,
              fmt::format("the beam would leave the work space: {}; the machine has {}",
                          bounds_text(box), bounds_text(space)),
              fits ? "give another place with x and y, or the profile of another machine"
                   : "it is too large for this machine: give the profile of another one");
}

std::vector<std::string> operation_warnings(const std::vector<Operation>& operations,
                                            const cutting::Post& post,
                                            const settings::Values& values) {
  Warnings warnings;
  warn_of_thin_tabs(operations, warnings);
  if (!post.is_checked || post.machine != MachineType::laser) return warnings;
  warn_of_pulsed(values, warnings);
  warn_of_dark_pierce(operations, values, warnings);
  return warnings;
}

}  // namespace lamplock::run
