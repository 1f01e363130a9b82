#include "host/run/outside_work_space.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string>

#include "host/error.hpp"
#include "host/link/board_settings.hpp"
#include "host/link/line_port.hpp"
#include "host/link/not_ready.hpp"
#include "host/units.hpp"
#include "shared/work_space.hpp"

namespace lamplock::run {
namespace {

using settings::Id;

/// A board that knows only frames does not answer.
constexpr link::Patience patience{std::chrono::milliseconds(300), std::chrono::milliseconds(1000)};
/// Reports have three decimals.
constexpr double report_error_mm = 0.001;

struct Span {
  double low = 0, high = 0;
};

Span work_space(const settings::Values& values, int axis) {
  const double low = in_units(values, Id::min_corner_x, axis);
  return {low, low + in_units(values, Id::travel_x, axis)};
}

/// Where the machine is outside, and the nearest place inside: all axes move at once, for a move of
/// one of them would end outside too.
struct Way {
  std::string where, inside;
};

void add_axis(Way& way, int axis, double position, const Span& span) {
  const bool is_inside =
      position >= span.low - report_error_mm && position <= span.high + report_error_mm;
  if (is_inside) return;
  const char letter = axis_letters[index(axis)];
  way.where += fmt::format("{}{}{:.3f} ({:.10g} to {:.10g} mm)", way.where.empty() ? "" : ", ",
                           letter, position, span.low, span.high);
  way.inside += fmt::format(" {}{:.10g}", letter, position < span.low ? span.low : span.high);
}

}  // namespace

void require_inside_work_space(link::Transport& board, const BoardOptions& options) {
  link::LinePort port(board);
  link::BoardSettings settings;
  link::BoardStatus status;
  try {
    status = link::greet(port).status;
    settings = link::read_settings(port, patience);
  } catch (const Error&) {
    return;
  }
  const bool is_inches = settings.values.whole(Id::report_inches) != 0;
  if (is_inches || !settings.has(Id::travel_x)) return;
  Way way;
  for (std::size_t a = 0; a < status.position.size() && a < axis_letters.size(); ++a) {
    const int axis = static_cast<int>(a);
    if (!is_rotary(settings.values, axis))
      add_axis(way, axis, status.position[a], work_space(settings.values, axis));
  }
  if (way.where.empty()) return;
  throw Error(
      Exit::bad_input, options.board,
      fmt::format("the machine is outside its work space, where no job can begin: {}", way.where),
      fmt::format("move it inside: G53 G0{} in lamplock console{}", way.inside,
                  link::board_option(options.board)));
}

}  // namespace lamplock::run
