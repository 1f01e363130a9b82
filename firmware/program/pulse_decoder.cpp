#include "firmware/program/pulse_decoder.hpp"

#include <cstddef>

namespace lamplock::program {
namespace {

bool inside(const StepPosition& steps, const StepLimits& limits, int axes) {
  for (int axis = 0; axis < axes; ++axis)
    if (!limits.contains(axis, steps[static_cast<std::size_t>(axis)])) return false;
  return true;
}

wire::Target to_target(const wire::Record& record, const StepPosition& before) {
  const bool dwell = record.shots == 0 && record.beats != 0 && record.steps == before;
  return {record.steps, record.beats, record.shots, record.channel, record.energy, dwell};
}

}  // namespace

void PulseDecoder::begin(const wire::JobHeader& header, std::uint8_t channels) {
  channels_ = channels;
  state_ = {};
  state_.steps = header.origin_steps;
  points_total_ = header.points_total;
  axes_ = header.axes;
}

Result PulseDecoder::decode(std::span<const std::uint8_t> records, motion::PointQueue& queue,
                            const StepLimits& limits) {
  std::uint32_t index = queue.end();
  wire::RecordState trial = state_;
  const Result checked = wire::walk_records(records, axes_, trial, [&](const wire::Record& record) {
    if (index >= points_total_) return Result::bad_value;
    if (record.shots != 0 && (channels_ >> record.channel & 1) == 0) return Result::unsupported;
    if (!inside(record.steps, limits, axes_)) return Result::out_of_bounds;
    ++index;
    return Result::ok;
  });
  if (checked != Result::ok) {
    refused_index_ = index;
    return checked;
  }
  if (index - queue.end() > queue.free()) return Result::no_space;
  StepPosition before = state_.steps;
  return wire::walk_records(records, axes_, state_, [&](const wire::Record& record) {
    const wire::Target target = to_target(record, before);
    before = record.steps;
    return queue.push(target) ? Result::ok : Result::no_space;
  });
}

}  // namespace lamplock::program
