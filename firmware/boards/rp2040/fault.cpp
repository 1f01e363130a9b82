#include "firmware/boards/rp2040/fault.hpp"

#include "firmware/boards/rp2040/base/program_pins.hpp"
#include "firmware/boards/rp2040/fire/beam_output.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/pio.hpp"
#include "firmware/boards/rp2040/storage/restart_record.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {
namespace {

/// Stack frame of an exception (ARMv6-M Architecture Reference Manual, B1.5.6).
struct ExceptionFrame {
  std::uint32_t r0, r1, r2, r3, r12, lr, pc, xpsr;
};

}  // namespace

void make_outputs_safe() {
  using boards::Role;
  force_low(boards::gpio(Role::q_switch));
  force_low(boards::gpio(Role::laser_gate));
  force_low(boards::gpio(Role::laser_pwm));
  force_low(boards::gpio(Role::shot_enable));
  if constexpr (boards::has(Role::lamp_trigger))
    force_low(boards::optional_gpio(Role::lamp_trigger));
  BeamOutput::close();
  ProgramPins::end_pwm();
  pio1().ctrl = 0;  // TICK
  pio0().ctrl = 0;
}

extern "C" [[gnu::used, noreturn]] void fault_handler(const ExceptionFrame* frame) {
  make_outputs_safe();
  restart_after({frame->pc, frame->lr, frame->xpsr});
}

}  // namespace lamplock::rp2040

/// The process stack is not used.
extern "C" [[gnu::naked]] void fault_entry() {
  asm volatile(
      "mrs r0, msp\n"
      "ldr r1, =fault_handler\n"
      "bx r1\n");
}
