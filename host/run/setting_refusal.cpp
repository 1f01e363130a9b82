#include "host/run/setting_refusal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "host/job/rate_excess.hpp"
#include "host/job/setting_range.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/line_port.hpp"
#include "host/units.hpp"
#include "shared/boards/all_boards.hpp"
#include "shared/job_limits.hpp"
#include "shared/units.hpp"

namespace lamplock::run {
namespace {

using settings::Id;
using settings::Rule;

/// As in remaining_time(): a board that knows only frames does not answer.
constexpr link::Patience settings_time{std::chrono::milliseconds(300),
                                       std::chrono::milliseconds(1000)};
/// Settings that a message names one by one.
constexpr std::size_t max_named = 3;

/// "200", "0.5", "1 (slave)", "0 (board pico)".
std::string value_words(Id id, const settings::Values& values) {
  constexpr std::array lamp_modes{"none", "slave", "master"};
  const std::string number = fmt::format("{:.10g}", in_units(values, id));
  if (id == Id::pin_map)
    if (const auto* board = boards::find_board(static_cast<boards::PinMap>(values.whole(id))))
      return fmt::format("{} (board {})", number, board->name);
  const auto mode = static_cast<std::size_t>(values.whole(id));
  if (id != Id::lamp_mode || mode >= lamp_modes.size()) return number;
  return fmt::format("{} ({})", number, lamp_modes[mode]);
}

/// The work space of the job along one axis is not inside that of the board.
std::string space_words(int axis, const settings::Values& job, const settings::Values& board) {
  const auto span = [axis](const settings::Values& values) {
    const double low = in_units(values, Id::min_corner_x, axis);
    return fmt::format("{:.10g} to {:.10g} mm", low, low + in_units(values, Id::travel_x, axis));
  };
  return fmt::format("the work space of the job along {}, {}, is not inside that of the board, {}",
                     axis_letters[index(axis)], span(job), span(board));
}

std::string setting_words(Id id, const settings::Values& job, const settings::Values& board) {
  for (int axis = 0; axis < max_axes; ++axis)
    if (id == settings::for_axis(Id::min_corner_x, axis) &&
        !settings::inside_work_space(job, board, axis))
      return space_words(axis, job, board);
  const std::string asked = fmt::format("{} = {}{}", settings::row(id).name, value_words(id, job),
                                        job::unit_suffix(settings::row(id)));
  if (job.milli(id) == board.milli(id))
    return fmt::format("{} of the job contradicts the other settings of the board", asked);
  const std::string own = value_words(id, board);
  const bool oversteps = settings::oversteps(id, job.milli(id), board.milli(id));
  switch (settings::row(id).rule) {
    case Rule::not_less:
      if (oversteps) return fmt::format("the job is for {}, the board needs {}", asked, own);
      break;
    case Rule::not_more:
    case Rule::not_more_zero_unlimited:
      if (oversteps) return fmt::format("the job is for {}, the board allows {}", asked, own);
      break;
    default:
      break;
  }
  return fmt::format("the job is for {}, the board has {}", asked, own);
}

/// The board compares a hash of all settings that jobs may have.
std::string mismatch_words(const job::Job& job, const settings::Values& board) {
  const settings::Values in_job = job::apply_overrides(board, job.header);
  std::vector<std::string> names;
  Id first = Id::count;
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const auto id = static_cast<Id>(i);
    if (!settings::of_jobs(id) || in_job.milli(id) == job.settings.milli(id)) continue;
    if (first == Id::count)
      first = id;
    else
      names.emplace_back(settings::row(id).name);
  }
  if (first == Id::count) return "the job was made for other settings";
  std::string text = setting_words(first, job.settings, in_job);
  for (std::size_t i = 0; i < std::min(names.size(), max_named - 1); ++i)
    text += (i == 0 ? ", also different: " : ", ") + names[i];
  if (names.size() >= max_named) text += fmt::format(" and {} more", names.size() - max_named + 1);
  return text;
}

/// The way to a job with the settings of this board.
std::string remake(const BoardOptions& options) {
  if (options.is_simulated())
    return options.profile.empty() ? "make the job with the profile of this machine"
                                   : "make the job with --machine " + options.profile;
  return fmt::format(
      "make the job with the settings of the board: lamplock settings backup board.toml --board "
      "{}, then --machine board.toml",
      options.board);
}

[[noreturn]] void refuse_on(const BoardOptions& options, const std::string& what,
                            const std::string& remedy) {
  throw Error(Exit::bad_input, options.board, what, remedy);
}

[[noreturn]] void refuse_pulsed(const BoardOptions& options) {
  refuse_on(
      options,
      "this board is set up for a pulsed laser (laser_mode = 0), rows of pixels need a "
      "continuous one",
      options.is_simulated()
          ? "for a continuous laser set laser_mode = 1 in " + options.profile
          : "for a continuous laser: lamplock settings set laser_mode=1 --board " + options.board);
}

}  // namespace

void explain_refusal(const link::RefusedSetting& refusal, const job::Job& job,
                     link::Transport& port, const BoardOptions& options) {
  const Id id = refusal.number() == 0 ? Id::count : link::find_setting(refusal.number());
  if (id == Id::laser_mode) refuse_pulsed(options);
  if (refusal.number() != 0 && id == Id::count) throw link::RefusedSetting(refusal);
  settings::Values board;
  try {
    link::LinePort lines(port);
    board = link::read_settings(lines, settings_time).values;
  } catch (const Error&) {  // at the end of a job a board may be busy, or know frames only
    throw link::RefusedSetting(refusal);
  }
  const auto excess = job::rate_excess_words(job::apply_overrides(board, job.header));
  if (excess && excess->id == id) refuse_on(options, excess->limit, excess->remedy);
  refuse_on(options,
            id == Id::count ? mismatch_words(job, board) : setting_words(id, job.settings, board),
            remake(options));
}

}  // namespace lamplock::run
