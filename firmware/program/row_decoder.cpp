#include "firmware/program/row_decoder.hpp"

namespace lamplock::program {
namespace {

/// Contents of a payload.
struct RowCount {
  std::uint32_t lines = 0;
  std::uint32_t places = 0;  ///< for its runs, with headers
  bool open = false;         ///< the next line has runs already

  void add_run() {
    places += open ? 1 : 2;
    open = true;
  }
  void add_line() {
    ++lines;
    open = false;
  }
};

bool within_travel(const StepPosition& steps, const StepLimits& limits, int axes) {
  for (int axis = 0; axis < axes; ++axis)
    if (!limits.contains(axis, steps[static_cast<std::size_t>(axis)])) return false;
  return true;
}

}  // namespace

void RowDecoder::begin(const wire::JobHeader& header) {
  state_ = {};
  state_.steps = header.origin_steps;
  index_ = header.first_index;
  lines_total_ = header.points_total;
  axes_ = header.axes;
}

Result RowDecoder::check(std::span<const std::uint8_t> records, RowRoom room,
                         const StepLimits& limits) {
  wire::RowState trial = state_;
  RowCount count;
  count.open = state_.runs != 0;
  StepPosition before = state_.steps;
  const Result checked = wire::walk_row_records(
      records, axes_, trial,
      [&](const wire::RowLine& line) {
        if (index_ + count.lines >= lines_total_) return Result::bad_value;
        if (count.lines == wire::max_lines_a_frame) return Result::bad_value;
        // The first line may begin elsewhere than at the end of another.
        const bool well = within_travel(line.steps, limits, axes_) &&
                          (!line.light || within_travel(before, limits, axes_));
        if (!well) return Result::out_of_bounds;
        before = line.steps;
        count.add_line();
        return Result::ok;
      },
      [&](std::uint16_t) {
        count.add_run();
        return Result::ok;
      });
  if (checked != Result::ok) {
    refused_index_ = index_ + count.lines;
    return checked;
  }
  return count.lines > room.lines || count.places > room.runs ? Result::no_space : Result::ok;
}

}  // namespace lamplock::program
