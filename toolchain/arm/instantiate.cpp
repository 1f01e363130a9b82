// Makes the compiler emit the functions of the controller that a board calls, inline ones too, so
// that toolchain/gate checks all code that can be part of the board. Never runs.
#include <new>
#include <tuple>

#include "firmware/machine/controller.hpp"

namespace lamplock::machine {

/// Builds a controller as a board does: in memory that it has set aside.
Controller* construct(void* memory) { return new (memory) Controller; }

// Taking the address of an inline function makes the compiler emit it.
[[gnu::used]] constexpr std::tuple functions{
    &Controller::receive,
    &Controller::transmit,
    &Controller::prepare,
    &Controller::fill,
    &Controller::next_span,
    &Controller::lamp_edge,
    &Controller::next_token,
    &Controller::token_expired,
    &Controller::photosensors,
    &Controller::outputs,
    &Controller::plan,
    &Controller::commit,
    &Controller::take_settings,
    &Controller::values,
    &Controller::fire_timing,
    &Controller::input_changed,
    &Controller::job_mark,
    &Controller::stopped_at,
    &Controller::lattice_stopped,
    &Controller::report_message,
    &Controller::clock,
    &Controller::start_in_alarm,
    &Controller::shots,
    &Controller::state,
    &Controller::loader_requested,
    &Controller::new_connection,
    &Controller::job_unfinished,
};

}  // namespace lamplock::machine
