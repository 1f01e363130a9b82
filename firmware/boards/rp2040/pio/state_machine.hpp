// One state machine of a PIO block: set-up, immediate instructions, its state.
//
// Who: LatticeOutput and FireUnit, with the state machine disabled unless stated otherwise.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/pio/assembler.hpp"
#include "firmware/boards/rp2040/registers/pio.hpp"

namespace lamplock::rp2040::pio {

/// Block and number.
struct StateMachine {
  unsigned block = 0;
  unsigned number = 0;

  PioRegisters& registers() const { return block == 0 ? pio0() : pio1(); }
  PioStateMachineRegisters& machine() const { return registers().sm[number]; }
  std::uint32_t mask() const { return 1u << number; }

  /// Executes in the clock after the store; the next access is later than that.
  void execute(std::uint16_t instruction) const {
    machine().instr = instruction;
    asm volatile("nop\n nop" ::: "memory");
  }
  void write(std::uint32_t word) const { registers().txf[number] = word; }
  std::uint32_t read() const { return registers().rxf[number]; }
  unsigned tx_level() const { return pio_flevel::tx(registers().flevel, number); }
  unsigned rx_level() const { return pio_flevel::rx(registers().flevel, number); }
  void enable() const { set_bits(registers().ctrl, pio_ctrl::enable(mask())); }
  void disable() const { clear_bits(registers().ctrl, pio_ctrl::enable(mask())); }

  /// Its position in a program at `offset`.
  unsigned place(unsigned offset) const { return machine().addr - offset; }
  /// Makes `count` pins from `base` on outputs, low. Changes PINCTRL.
  void make_outputs_low(unsigned base, unsigned count) const {
    for (unsigned i = 0; i < count; ++i) {
      machine().pinctrl = pio_pinctrl::set((base + i) % 32, 1);
      execute(encode::set(SetTo::pins, 0));
      execute(encode::set(SetTo::pindirs, 1));
    }
  }
  /// Sets undivided clock, wrap and side-set of a program; `jmp_pin`: the pin for its jumps.
  void configure(const Program& program, unsigned offset, unsigned jmp_pin) const {
    machine().clkdiv = 1u << 16;
    machine().execctrl = pio_execctrl::wrap_bottom(offset + program.wrap_target) |
                         pio_execctrl::wrap_top(offset + program.wrap) |
                         pio_execctrl::jmp_pin(jmp_pin) |
                         (program.side_set_optional ? pio_execctrl::side_en : 0);
  }
  /// Clears FIFOs, shift counters, delays; jumps to `address`. Must be disabled before.
  void restart(std::uint32_t shiftctrl, unsigned address) const {
    // Changing a join bit empties both FIFOs (3.5.4, 3.7: SHIFTCTRL).
    machine().shiftctrl = shiftctrl ^ pio_shiftctrl::join_rx;
    machine().shiftctrl = shiftctrl;
    set_bits(registers().ctrl, pio_ctrl::restart(mask()) | pio_ctrl::clkdiv_restart(mask()));
    execute(encode::jump(Jump::always, address));
  }
};

/// Writes a program into instruction memory.
inline void load(PioRegisters& block, const Program& program, unsigned offset) {
  for (unsigned i = 0; i < program.size; ++i) block.instr_mem[offset + i] = program.at(i, offset);
}

}  // namespace lamplock::rp2040::pio
