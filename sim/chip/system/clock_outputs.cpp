#include "sim/chip/system/clock_outputs.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "sim/chip/fabric/wide.hpp"

namespace lamplock::sim::chip {

namespace {
constexpr Wide halves_q8 = 2 * 256;  ///< half periods of a divisor in 24.8 fixed point
}  // namespace

ClockOutputs::ClockOutputs(TimeWheel& wheel, FunctionPins& pins, NotModelled not_modelled)
    : wheel_(wheel), slot_(wheel.add(*this)), pins_(pins), not_modelled_(std::move(not_modelled)) {
  pins_.listen(*this);
}

void ClockOutputs::set(std::size_t index, std::uint64_t source_hz, std::uint64_t divisor_q8) {
  Output& output = outputs_[index];
  if (output.source_hz != source_hz || output.divisor != divisor_q8) {
    output = {source_hz, divisor_q8, wheel_.time(), 0};
    drive(index, wheel_.now());
    schedule();
  }
  report_too_fast(index);
}

std::uint64_t ClockOutputs::edges_until(const Output& output, Picoseconds time) const {
  if (output.source_hz == 0) return 0;
  return static_cast<std::uint64_t>(static_cast<Wide>(time - output.since) * halves_q8 *
                                    static_cast<Wide>(output.source_hz) /
                                    (static_cast<Wide>(output.divisor) * ps_per_s));
}

Picoseconds ClockOutputs::time_of_edge(const Output& output, std::uint64_t edge) const {
  const Wide hz = halves_q8 * static_cast<Wide>(output.source_hz);
  const Wide scaled = static_cast<Wide>(edge) * static_cast<Wide>(output.divisor) * ps_per_s;
  return output.since + static_cast<Picoseconds>((scaled + hz - 1) / hz);
}

bool ClockOutputs::connected(std::size_t index) const {
  return outputs_[index].source_hz != 0 && pins_.connected(static_cast<unsigned>(index));
}

/// True if the cycles are fine enough for the output.
bool ClockOutputs::slow_enough(std::size_t index) const {
  const Output& output = outputs_[index];
  return static_cast<Wide>(output.source_hz) * halves_q8 <=
         static_cast<Wide>(output.divisor) * static_cast<Wide>(wheel_.frequency());
}

// Not reported where an output is driven, because when clk_sys changes, the wheel changes before an
// output made of clk_sys.
void ClockOutputs::report_too_fast(std::size_t index) const {
  if (!connected(index) || slow_enough(index)) return;
  not_modelled_("CLOCKS GPOUT" + std::to_string(index) +
                ": faster than half of clk_sys, not shown on its pin");
}

void ClockOutputs::drive(std::size_t index, Cycle at) {
  Output& output = outputs_[index];
  output.edges = shown(index) ? edges_until(output, wheel_.time_of(at)) : 0;
  pins_.put(static_cast<unsigned>(index), output.edges % 2 != 0, true, at);
}

void ClockOutputs::schedule() {
  Picoseconds first = never;
  for (std::size_t index = 0; index < output_count; ++index)
    if (shown(index))
      first = std::min(first, time_of_edge(outputs_[index], outputs_[index].edges + 1));
  wheel_.set(slot_, wheel_.cycle_at(first));
}

void ClockOutputs::run(Cycle) {
  for (std::size_t index = 0; index < output_count; ++index)
    if (shown(index)) drive(index, wheel_.now());
  schedule();
}

void ClockOutputs::pins_changed(Cycle at) {
  for (std::size_t index = 0; index < output_count; ++index) {
    drive(index, at);
    report_too_fast(index);
  }
  schedule();
}

// Levels must be right even of outputs that are about to be connected.
void ClockOutputs::pins_connecting(Cycle at) {
  for (std::size_t index = 0; index < output_count; ++index) {
    Output& output = outputs_[index];
    if (output.source_hz == 0 || pins_.connected(static_cast<unsigned>(index))) continue;
    const bool high = edges_until(output, wheel_.time_of(at)) % 2 != 0;
    pins_.put(static_cast<unsigned>(index), high, true, at);
  }
}

}  // namespace lamplock::sim::chip
