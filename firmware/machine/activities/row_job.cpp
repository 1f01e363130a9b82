#include "firmware/machine/activities/row_job.hpp"

namespace lamplock::machine {
namespace {

/// Lines carry 24 bits; 0 means none.
constexpr std::uint32_t carried_mark = 1u << 23, carried_bits = carried_mark - 1;

constexpr std::uint32_t carried(std::uint32_t index) {
  return (index & carried_bits) | carried_mark;
}

motion::LineTarget rapid_to(const StepPosition& steps, std::uint32_t index) {
  motion::LineTarget line;
  line.steps = steps;
  line.rapid = true;
  line.line = carried(index);
  return line;
}

}  // namespace

void RowJob::begin(const wire::JobHeader& header, const StepPosition& at) {
  decoder_.begin(header);
  runner_.drop_pixels();
  stage_ = Stage::runs;
  known_ = true;
  dry_ = header.dry;
  off_target_ = at != header.origin_steps;
  seen_ = false;
  first_ = header.first_index;
}

program::RowRoom RowJob::room() const {
  const std::uint32_t lines = runner_.free_lines();
  // One for the move to the start of the first line.
  const std::uint32_t kept = off_target_ ? 1 : 0;
  return {lines > kept ? lines - kept : 0, runner_.free_runs()};
}

Result RowJob::take(std::span<const std::uint8_t> records, const StepLimits& space) {
  if (!runs()) return Result::no_job;
  const Result checked = decoder_.check(records, room(), space);
  if (checked != Result::ok) return checked;
  decoder_.take(
      records, [this](const wire::RowLine& line) { take_line(line); },
      [this](std::uint16_t run) { take_run(run); });
  return Result::ok;
}

void RowJob::take_run(std::uint16_t run) {
  // The first line shines: move to its start before.
  if (off_target_) runner_.take(rapid_to(decoder_.from(), decoder_.index()));
  off_target_ = false;
  if (!dry_) runner_.add_run(run);
}

void RowJob::take_line(const wire::RowLine& line) {
  off_target_ = false;
  motion::LineTarget target = rapid_to(line.steps, decoder_.index());
  if (line.light) {
    target.rapid = false;
    target.feed_um_min = line.feed_milli;
    target.pixels = !dry_;
    target.laser = dry_ ? motion::LinePower::off : motion::LinePower::proportional;
    if (!dry_) runner_.end_pixels(target);
  }
  runner_.take(target);
}

/// At most as many lines as the planner has room for are accepted and not run.
std::uint32_t RowJob::index_of(std::uint32_t carried) const {
  return decoder_.index() - ((decoder_.index() - carried) & carried_bits);
}

/// The index of a line never decreases.
void RowJob::pass(std::uint32_t index) {
  if (index > first_) first_ = index;
}

void RowJob::poll() {
  if (runner_.idle()) {
    if (runs()) first_ = decoder_.index();
    runner_.forget_pixels();
    seen_ = false;
    return;
  }
  if (!runs()) return;
  bool at_end = false;
  if (const std::uint32_t line = runner_.first_line_at_rest(at_end); line != 0) {
    pass(index_of(line) + (at_end ? 1 : 0));
    seen_ = false;
    return;
  }
  if (seen_ && runner_.played(next_tick_)) {
    pass(index_of(next_));
    seen_ = false;
  }
  if (const std::uint32_t line = runner_.line(); !seen_ && line != 0) {
    seen_ = true;
    next_ = line;
    next_tick_ = runner_.head();
  }
}

void RowJob::fill_status(wire::Status& status) const {
  status.received = decoder_.index();
  status.first_unfired = first_;
  status.starvations = runner_.starvations();
}

}  // namespace lamplock::machine
