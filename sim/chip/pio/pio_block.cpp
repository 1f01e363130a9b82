#include "sim/chip/pio/pio_block.hpp"

#include <algorithm>
#include <utility>

namespace lamplock::sim::chip {

namespace {

using pio::machine_count;

// Offsets (RP2040 datasheet, 3.7).
constexpr std::uint32_t ctrl = 0x000, fstat_offset = 0x004, fdebug_offset = 0x008,
                        flevel_offset = 0x00c, txf0 = 0x010, rxf0 = 0x020, irq_offset = 0x030,
                        irq_force = 0x034, input_sync_bypass = 0x038, dbg_padout = 0x03c,
                        dbg_padoe = 0x040, dbg_cfginfo = 0x044, instr_mem0 = 0x048,
                        sm0_clkdiv = 0x0c8, sm_end = 0x128, intr_offset = 0x128, irq0_inte = 0x12c,
                        irq1_inte = 0x138, irqs_end = 0x144;
constexpr std::uint32_t sm_stride = 0x18;
constexpr std::uint32_t interrupt_bits = 0xfff;
// DBG_CFGINFO: 32 words of instruction memory, 4 machines, FIFOs of 4 words.
constexpr std::uint32_t configuration = 32u << 16 | 4u << 8 | 4u;

constexpr bool in_range(std::uint32_t offset, std::uint32_t first, std::uint32_t count) {
  return offset >= first && offset < first + 4 * count;
}

}  // namespace

PioBlock::PioBlock(ClockOwner& clock, unsigned number, IrqLines& irqs, NotModelled not_modelled)
    : owner_(clock),
      number_(number),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      machines_{pio::StateMachine{shared_, 0}, pio::StateMachine{shared_, 1},
                pio::StateMachine{shared_, 2}, pio::StateMachine{shared_, 3}},
      interrupts_{InterruptRegisters{intr_offset, interrupt_bits},
                  InterruptRegisters{irq1_inte - 4, interrupt_bits}} {
  for (pio::StateMachine& machine : machines_) machine.reset(0);
}

// ---------------------------------------------------------------------------------------------
// Clocks

void PioBlock::clock(Cycle of_system) {
  const Cycle clock = own(of_system);
  shared_.in = shared_.inputs.seen(clock, pio::input_latency);
  if (shared_.bypass != 0)
    shared_.in = (shared_.in & ~shared_.bypass) |
                 (shared_.inputs.seen(clock, pio::bypassed_latency) & shared_.bypass);
  for (unsigned i = 0; i < machine_count; ++i)
    if (shared_.due[i] <= clock) machines_[i].step(clock);
  if ((shared_.irq_set | shared_.irq_clear | static_cast<std::uint32_t>(shared_.fifo_changed)) != 0)
    after_change();
  if ((shared_.irq_set | shared_.irq_clear) != 0) {
    // If a flag is set and cleared in one clock, it is set (assumed).
    shared_.irq = (shared_.irq & ~shared_.irq_clear) | shared_.irq_set;
    shared_.irq_set = shared_.irq_clear = 0;
    for (pio::StateMachine& machine : machines_) machine.flags_changed(clock + 1);
    update_lines();
  }
  if (shared_.reserved_used && !std::exchange(reserved_told_, true))
    report("instruction with a reserved field");
  find_due();
}

void PioBlock::after_change() {
  if (!std::exchange(shared_.fifo_changed, false)) return;
  fifo_changed_ = true;
  update_lines();
}

void PioBlock::find_due() {
  due_ =
      std::min(std::min(shared_.due[0], shared_.due[1]), std::min(shared_.due[2], shared_.due[3]));
  if (stopped_)
    due_ = never_cycle;
  else if (due_ != never_cycle)
    due_ += without_;
}

void PioBlock::set_clock(bool runs, Cycle next) {
  if (runs != stopped_) return;
  if (runs) {
    stopped_ = false;
    without_ += next - stopped_at_;
  } else {
    stopped_ = true;
    stopped_at_ = next;
  }
  find_due();
}

void PioBlock::set_inputs(std::uint32_t levels, Cycle at_system) {
  if (stopped_) return;
  const Cycle at = own(at_system);
  const std::uint32_t changed = shared_.inputs.set(levels, at);
  if (changed == 0) return;
  for (pio::StateMachine& machine : machines_) machine.inputs_changed(changed, at);
  find_due();
}

void PioBlock::set_every_clock(bool on, Cycle next) {
  shared_.every_clock = on;
  settle(own(next));
}

/// Called after a write that can matter to any machine: all check again in the next clock.
void PioBlock::settle(Cycle next) {
  for (unsigned i = 0; i < machine_count; ++i) {
    machines_[i].settle(next);
    std::uint32_t others = 0;
    for (unsigned k = 0; k < machine_count; ++k)
      if (k != i && machines_[k].active()) others |= machines_[k].reach();
    machines_[i].set_contested(others);
  }
  find_due();
}

void PioBlock::update_lines() {
  std::uint32_t raw = 0;
  if ((interrupts_[0].enabled() | interrupts_[1].enabled()) != 0) raw = intr();
  const Irq first = number_ == 0 ? Irq::pio0_0 : Irq::pio1_0;
  const Irq second = number_ == 0 ? Irq::pio0_1 : Irq::pio1_1;
  irqs_.set(first, interrupts_[0].status(raw) != 0);
  irqs_.set(second, interrupts_[1].status(raw) != 0);
}

// ---------------------------------------------------------------------------------------------
// Registers

std::uint32_t PioBlock::fstat() const {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < machine_count; ++i) {
    const pio::StateMachine& machine = machines_[i];
    value |= (machine.rx().full() ? 1u : 0u) << i | (machine.rx().empty() ? 1u : 0u) << (8 + i) |
             (machine.tx().full() ? 1u : 0u) << (16 + i) |
             (machine.tx().empty() ? 1u : 0u) << (24 + i);
  }
  return value;
}

std::uint32_t PioBlock::flevel() const {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < machine_count; ++i)
    value |= (machines_[i].tx().level() | machines_[i].rx().level() << 4) << (8 * i);
  return value;
}

std::uint32_t PioBlock::intr() const {
  const std::uint32_t fifos = fstat();
  // Bits 3..0 RX not empty, 7..4 TX not full, 11..8 flags 3..0.
  return (~fifos >> 8 & 0xfu) | (~fifos >> 16 & 0xfu) << 4 | (shared_.irq & 0xfu) << 8;
}

std::uint32_t PioBlock::machine_register(std::uint32_t offset, Cycle next) const {
  const pio::StateMachine& machine = machines_[(offset - sm0_clkdiv) / sm_stride];
  switch ((offset - sm0_clkdiv) % sm_stride) {
    case 0x00:
      return machine.clkdiv();
    case 0x04:
      return machine.execctrl();
    case 0x08:
      return machine.shiftctrl();
    case 0x0c:
      return machine.pc(next);
    case 0x10:
      return machine.current_instruction(next);
    default:
      return machine.pinctrl();
  }
}

std::optional<std::uint32_t> PioBlock::value_of(std::uint32_t offset, Cycle next) const {
  if (offset >= sm0_clkdiv && offset < sm_end) return machine_register(offset, next);
  if (in_range(offset, rxf0, machine_count)) return machines_[(offset - rxf0) / 4].rx().front();
  // Write-only.
  if (in_range(offset, txf0, machine_count) || in_range(offset, instr_mem0, 32)) return 0;
  switch (offset) {
    case ctrl: {
      std::uint32_t enabled = 0;
      for (unsigned i = 0; i < machine_count; ++i)
        enabled |= (machines_[i].enabled() ? 1u : 0u) << i;
      return enabled;
    }
    case fstat_offset:
      return fstat();
    case fdebug_offset:
      return shared_.fdebug;
    case flevel_offset:
      return flevel();
    case irq_offset:
      return shared_.irq;
    case irq_force:
      return 0;
    case input_sync_bypass:
      return shared_.bypass;
    case dbg_padout:
      return shared_.out;
    case dbg_padoe:
      return shared_.dirs;
    case dbg_cfginfo:
      return configuration;
    case intr_offset:
      return intr();
    default:
      break;
  }
  if (offset >= irq0_inte && offset < irqs_end) {
    return interrupts_[offset < irq1_inte ? 0 : 1].read(offset, intr());
  }
  return std::nullopt;
}

std::uint32_t PioBlock::peek(std::uint32_t offset) const {
  return value_of(offset, next_clock()).value_or(0);
}

std::uint32_t PioBlock::read(std::uint32_t offset) {
  const Cycle next = next_clock();
  if (in_range(offset, rxf0, machine_count)) {
    const unsigned i = (offset - rxf0) / 4;
    pio::Fifo& rx = machines_[i].rx();
    if (rx.empty()) {
      shared_.fdebug |= 1u << (pio::fdebug::rxunder + i);
      return rx.front();
    }
    const std::uint32_t word = rx.pop();
    fifo_changed_ = true;
    machines_[i].wake(next);
    update_lines();
    find_due();
    owner_.changed();
    return word;
  }
  const std::optional<std::uint32_t> value = value_of(offset, next);
  if (!value) report("read of offset " + std::to_string(offset));
  return value.value_or(0);
}

void PioBlock::push(unsigned machine, std::uint32_t word, Cycle next) {
  pio::Fifo& tx = machines_[machine].tx();
  if (tx.full()) {
    shared_.fdebug |= 1u << (pio::fdebug::txover + machine);
    return;
  }
  tx.push(word);
  fifo_changed_ = true;
  machines_[machine].wake(next);
  update_lines();
  find_due();
}

void PioBlock::write_control(std::uint32_t value, Cycle next) {
  for (unsigned i = 0; i < machine_count; ++i) {
    pio::StateMachine& machine = machines_[i];
    if ((value >> (4 + i) & 1u) != 0) machine.restart(next);
    if ((value >> (8 + i) & 1u) != 0) machine.restart_divider(next);
    machine.set_enabled((value >> i & 1u) != 0, next);
  }
}

void PioBlock::write_machine(std::uint32_t offset, std::uint32_t value, Cycle next) {
  pio::StateMachine& machine = machines_[(offset - sm0_clkdiv) / sm_stride];
  switch ((offset - sm0_clkdiv) % sm_stride) {
    case 0x00:
      machine.set_clkdiv(value, next);
      break;
    case 0x04:
      machine.set_execctrl(value);
      break;
    case 0x08:
      machine.set_shiftctrl(value);
      break;
    case 0x0c:
      break;  // ADDR is read-only
    case 0x10:
      machine.force(static_cast<std::uint16_t>(value));
      break;
    default:
      machine.set_pinctrl(value);
  }
}

void PioBlock::write(std::uint32_t offset, std::uint32_t value) {
  const Cycle next = next_clock();
  if (in_range(offset, txf0, machine_count)) {
    push((offset - txf0) / 4, value, next);
    owner_.changed();
    return;
  }
  for (pio::StateMachine& machine : machines_) machine.settle(next);
  if (offset >= sm0_clkdiv && offset < sm_end) {
    write_machine(offset, value, next);
  } else if (in_range(offset, instr_mem0, 32)) {
    for (pio::StateMachine& machine : machines_)
      machine.set_instruction((offset - instr_mem0) / 4, static_cast<std::uint16_t>(value));
  } else if (offset >= irq0_inte && offset < irqs_end) {
    interrupts_[offset < irq1_inte ? 0 : 1].write(offset, value);
  } else if (offset == ctrl) {
    write_control(value, next);
  } else if (offset == fdebug_offset) {
    shared_.fdebug &= ~value;
  } else if (offset == irq_offset) {
    shared_.irq &= ~value;
  } else if (offset == irq_force) {
    shared_.irq |= value & 0xffu;
  } else if (offset == input_sync_bypass) {
    shared_.bypass = value;
  } else if (offset >= irqs_end) {
    report("write of offset " + std::to_string(offset));
  }
  shared_.fifo_changed = true;
  after_change();
  settle(next);
  owner_.changed();
}

std::uint32_t PioBlock::write_clear_bits(std::uint32_t offset) const {
  return offset == fdebug_offset || offset == irq_offset ? ~0u : 0;
}

void PioBlock::reset() {
  const Cycle next = next_clock();
  const pio::InputHistory inputs = shared_.inputs;
  const bool every_clock = shared_.every_clock;
  shared_ = {};
  shared_.inputs = inputs;
  shared_.every_clock = every_clock;
  for (pio::StateMachine& machine : machines_) {
    machine.reset(next);
    for (unsigned i = 0; i < 32; ++i) machine.set_instruction(i, 0);
  }
  for (InterruptRegisters& line : interrupts_) line.reset();
  fifo_changed_ = true;
  update_lines();
  settle(next);
  owner_.changed();
}

void PioBlock::report(const std::string& what) const {
  if (not_modelled_) not_modelled_(std::string(name()) + ": " + what);
}

}  // namespace lamplock::sim::chip
