// Jobs of rows of pixels.
#include "firmware/machine/work.hpp"

namespace lamplock::machine {

/// As begin_lines(); the previous motion has ended.
Result MachineWork::begin_rows(const wire::JobHeader& header, const settings::Values& values,
                               std::uint32_t tick_q16) {
  runner_.end();
  {
    const Masked masked(mask_);
    runner_.read_outcomes();  // the rest of a job must not move the machine back
  }
  if (const Result r = program_.begin(values, tick_q16); r != Result::ok) return r;
  StepPosition at{};
  const stepper::MotionState state = motion_.generator().state();
  for (int axis = 0; axis < header.axes; ++axis) at[index(axis)] = state.axis[index(axis)].step();
  for (int axis = header.axes; axis < max_axes; ++axis)
    at[index(axis)] = header.origin_steps[index(axis)];
  rows_.begin(header, at);
  return Result::ok;
}

Result MachineWork::take_rows(std::span<const std::uint8_t> records) {
  // STATUS contains the reason of the refusal.
  if (machine_.locked()) return Result::no_space;
  const Result r = rows_.take(records, work_space_);
  refused_value_ = rows_.refused_index();
  return r;
}

Result MachineWork::end_rows(std::uint32_t total) {
  if (total == points_total_ && rows_.complete()) return Result::ok;
  return rows_.runs() ? Result::bad_value : Result::no_job;
}

/// A feed override, effective with the next batch.
Result MachineWork::set_speed_of_rows(std::uint32_t percent) {
  overrides_.feed = static_cast<std::uint8_t>(percent < min_override ? min_override : percent);
  use_overrides();
  return Result::ok;
}

}  // namespace lamplock::machine
