// RealTime, the start of the board: the check of its wiring, its pads, and the lattice at rest.
#include "firmware/boards/rp2040/base/allocation.hpp"
#include "firmware/boards/rp2040/real_time.hpp"
#include "firmware/boards/rp2040/registers/pads_bank0.hpp"
#include "firmware/boards/rp2040/registers/sio.hpp"
#include "firmware/boards/rp2040/safety/board_check.hpp"

namespace lamplock::rp2040 {
namespace {

using boards::Role;

void make_output(unsigned gpio, bool high) {
  (high ? sio().gpio_out_set : sio().gpio_out_clr) = 1u << gpio;
  sio().gpio_oe_set = 1u << gpio;
  io_bank0().gpio[gpio].ctrl = io_ctrl::function(io_ctrl::Function::sio);
}

}  // namespace

/// Outputs keep the reset state of their pads: weak pull-down, 4 mA, Schmitt trigger.
void RealTime::start_inputs() const {
  const std::uint32_t pulled_up = inputs_.pulled_up();
  for (const boards::PinUse& use : map_) {
    if (use.direction != boards::Direction::input) continue;
    // An open serial line must read as idle.
    const bool up = (pulled_up >> use.gpio & 1) != 0 || use.role == Role::uart_rx;
    pads_bank0().gpio[use.gpio] =
        pad::input_enable | pad::schmitt | pad::drive_4ma | (up ? pad::pull_up : pad::pull_down);
  }
}

void RealTime::start_pads() const {
  for (const boards::PinUse& use : map_)
    if (boards::is_enable(use.role)) make_output(use.gpio, !drives_active_high_);  // off
  if (const auto led = boards::find_gpio(map_, Role::status_led)) make_output(*led, false);
  beam_.start();
  programs_.start(drives_active_high_);
}

/// On another board no pad is ever driven, and the machine stays in the e-stop.
bool RealTime::check_board(machine::Controller& core, const stepper::PulseOutput& output) {
  const int wrong = BoardCheck::wrong_pin(map_, output);
  if (wrong == BoardCheck::none) return true;
  BoardCheck::disable_outputs();
  inputs_.hold_estop(true);
  TextLine line;
  line.add("Outputs off: GPIO ").add(std::int64_t{wrong}).add(" is not as on a board ");
  line.add(boards::this_board.name)
      .add("; check wiring and $2, $3, or flash the image of your board");
  core.report_message(line.view());
  return false;
}

bool RealTime::start(machine::Controller& core) {
  start_us_ = microseconds();
  now_us_ = static_cast<std::uint32_t>(start_us_);
  drives_active_high_ = core.values().whole(settings::Id::enable_invert) != 0;
  const stepper::PulseOutput output = stepper::pulse_output(core.values());
  const bool is_wrong = !check_board(core, output);
  if (!is_wrong) start_inputs();  // otherwise all pads stay pulled down
  start_pads();
  expander_.configure(output);
  lattice_.start(map_, output);
  fire_.start();
  fire_.configure(core.fire_timing());
  estop_.start();
  begin(core, StepPosition{}, 0);  // in the state of a new core
  // Pressed already: there will be no edge.
  const bool is_high = (sio().gpio_in >> boards::gpio(Role::estop) & 1) != 0;
  if (is_wrong || is_high != boards::is_inverted(Role::estop)) estop_interrupt();
  return !is_wrong;
}

}  // namespace lamplock::rp2040
