#include "host/program/locked_run.hpp"

#include <algorithm>

#include "host/error.hpp"
#include "host/link/dialog.hpp"
#include "host/link/line_sender.hpp"
#include "host/link/simulated_transport.hpp"
#include "host/units.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/lamp_settings.hpp"

namespace lamplock::program_run {
namespace {

using settings::Id;
using sim::Picoseconds;
using sim::Pin;

/// Records the first and the last time of motion or shots.
class Busy final : public sim::PinListener {
 public:
  explicit Busy(sim::PinBus& bus) {
    for (const Pin pin : {Pin::step_x, Pin::step_y, Pin::step_z, Pin::step_a, Pin::q_switch})
      bus.listen(pin, *this);
  }
  void pin_changed(Pin pin, bool level, Picoseconds at) override {
    if (!level) return;
    if (pin == Pin::q_switch) ++shots_;
    first_ = any_ ? std::min(first_, at) : at;
    last_ = std::max(last_, at);
    any_ = true;
  }
  LockedRun run() const { return {shots_, sim::seconds(last_ - first_)}; }

 private:
  Picoseconds first_ = 0, last_ = 0;
  std::size_t shots_ = 0;
  bool any_ = false;
};

/// Runs the machine until it is warm and follows its lamp.
void warm_up(sim::VirtualBoard& board, const settings::Values& values) {
  const auto beat = static_cast<Picoseconds>(1e12 / in_units(values, Id::lamp_frequency));
  // More than a lock needs, so that the lattice reaches the lamp.
  const Picoseconds most = 4 * values.whole(Id::lock_edges) * beat;
  while (!board.controller().clock().settled() && board.now() < most)
    board.run_until(board.now() + beat);
}

/// The same machine with STEP and DIR, not inverted: time does not depend on the form of pulses.
settings::Values plain_pulses(settings::Values values) {
  for (int axis = 0; axis < max_axes; ++axis)
    values.set_milli(settings::for_axis(Id::pulse_mode_x, axis), 0);
  values.set_milli(Id::step_invert, 0);
  return values;
}

}  // namespace

LockedRun run_locked(std::string_view text, const settings::Values& values) {
  sim::VirtualBoard board(plain_pulses(values), sim::WorldConfig{.lamp = sim::lamp_of(values)});
  Busy busy(board.bus());
  warm_up(board, values);
  link::SimulatedTransport transport(board);
  link::LinePort port(transport);
  if (values.whole(Id::homing) != 0) link::unlock(port);
  link::LineSender sender(port, link::program_lines(text, "program"));
  while (sender.step())
    if (sender.waits()) sender.resume();
  if (sender.result().end != link::LineEnd::done)
    throw Error(Exit::job_failed, "program", "does not reach its end on the simulated board",
                "run it with `lamplock send --board virtual` to find the cause");
  return busy.run();
}

}  // namespace lamplock::program_run
