#include "host/job/board_of_profile.hpp"

#include <fmt/format.h>

#include "host/error.hpp"
#include "host/units.hpp"
#include "shared/boards/all_boards.hpp"
#include "shared/boards/setting_limits.hpp"

namespace lamplock::job {
namespace {

using boards::SettingLimits;
using settings::Id;

bool is_stated(const Profile& profile, Id id) {
  return profile.stated.test(static_cast<std::size_t>(id));
}

/// First stated setting that the board refuses; those that are not stated are left to the board.
Id refused_setting(const Profile& profile, const SettingLimits& limits) {
  settings::Values values = profile.settings;
  for (Id unfit; (unfit = boards::unfit_setting(limits, values)) != Id::count;) {
    if (is_stated(profile, unfit)) return unfit;
    values.set_milli(unfit, boards::fitting_milli(limits, unfit));
  }
  const Id unfit = boards::unfit_drive_setting(limits, values);
  return unfit != Id::count && is_stated(profile, unfit) ? unfit : Id::count;
}

/// What the board has instead.
std::string board_words(Id id, const SettingLimits& limits) {
  if (id == Id::axes) return fmt::format("has pins for {} axes", limits.axes);
  if (id == Id::channels) return "has no shutter of such a channel";
  if (id == Id::loop) return "has no SENSOR";
  if (id == Id::lamp_mode) return "has no LAMP TRIGGER";
  if (id == Id::enable_invert) return "has drives that a low level enables";
  if (id >= Id::microsteps_x && id <= settings::for_axis(Id::microsteps_x, max_axes - 1))
    return "has drives with 1, 2, 4, 8, 16, 32, 64, 128 or 256 microsteps";
  if (id >= Id::drive_current_x && id <= settings::for_axis(Id::drive_current_x, max_axes - 1))
    return fmt::format("has drives with at most {} mA", limits.max_drive_current_ma);
  return "has STEP and DIR only";
}

}  // namespace

void require_board_has(const Profile& profile, const std::string& file) {
  if (!is_stated(profile, Id::pin_map)) return;
  const int number = profile.settings.whole(Id::pin_map);
  const auto map = static_cast<boards::PinMap>(number);
  const boards::BoardRow* row = boards::find_board(map);
  if (row == nullptr)
    throw Error(Exit::bad_input, file, fmt::format("no board has pin_map = {}", number),
                "see the pin maps in docs/boards");
  const SettingLimits limits = boards::limits_of(*row, row->map(map).pins);
  const Id refused = refused_setting(profile, limits);
  if (refused == Id::count) return;
  throw Error(Exit::bad_input, file,
              fmt::format("{} = {:.10g}: the board of pin_map = {}, {}, {}",
                          settings::row(refused).name, in_units(profile.settings, refused), number,
                          row->name, board_words(refused, limits)),
              "change the value, or state the pin map of your board");
}

}  // namespace lamplock::job
