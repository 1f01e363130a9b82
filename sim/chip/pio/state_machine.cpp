#include "sim/chip/pio/state_machine.hpp"

namespace lamplock::sim::chip::pio {

namespace {

std::uint32_t reverse_bits(std::uint32_t v) {
  v = (v >> 1 & 0x5555'5555u) | (v & 0x5555'5555u) << 1;
  v = (v >> 2 & 0x3333'3333u) | (v & 0x3333'3333u) << 2;
  v = (v >> 4 & 0x0f0f'0f0fu) | (v & 0x0f0f'0f0fu) << 4;
  v = (v >> 8 & 0x00ff'00ffu) | (v & 0x00ff'00ffu) << 8;
  return std::rotl(v, 16);
}

/// 0 means 32 in thresholds.
unsigned threshold(std::uint32_t field) { return (field & 31u) == 0 ? 32u : field & 31u; }

/// A sleep in a loop shorter than this many executions is not worth its bookkeeping.
constexpr std::uint64_t min_loop_sleep = 8;
/// Maximum number of jumps in a loop.
constexpr int max_loop = 8;
/// Rounds after which a sleep in a loop ends: times then fit 64 bits even if each round takes 8
/// jumps with all delays, divided by 65536.
constexpr std::uint64_t max_rounds = std::uint64_t{1} << 28;
/// Maximum number of instructions that run at once, because an unnoticed loop has no end.
constexpr int max_at_once = 16;

}  // namespace

void StateMachine::reset(Cycle next) {
  x_ = y_ = isr_ = osr_ = 0;
  pc_ = 0;
  enabled_ = false;
  delay_left_ = 0;
  next_q8_ = next << 8;
  tx_.set_depth(4);
  rx_.set_depth(4);
  shiftctrl_ = 0;
  set_clkdiv(0x0001'0000, next);  // reset values: SMx_CLKDIV, EXECCTRL, SHIFTCTRL, PINCTRL
  set_execctrl(0x0001'f000);
  set_shiftctrl(0x000c'0000);
  set_pinctrl(0x1400'0000);
  restart(next);
  sleep_ = Sleep::none;
  watched_pin_ = 0;
  waits_for_flag_ = false;
  shared_.due[index_] = never_cycle;
}

// ---------------------------------------------------------------------------------------------
// Time

/// Grid ticks from the first one at or after `clock` to the next execution.
Cycle StateMachine::ticks_left(Cycle clock) const {
  const std::uint64_t from = clock << 8;
  return next_q8_ <= from ? 0 : (next_q8_ - from) / divisor_q8_;
}

/// Moves the next execution to the first tick at or after `clock` if it lies before.
void StateMachine::align(Cycle clock) {
  const std::uint64_t from = clock << 8;
  if (next_q8_ >= from) return;
  next_q8_ += ticks_in(from - next_q8_) * divisor_q8_;
}

void StateMachine::wake_up(Cycle clock) {
  if (at_once_) run_again(clock);
  if (sleep_ == Sleep::loop) leave_loop(clock);
  sleep_ = Sleep::none;
  watched_pin_ = 0;
  waits_for_flag_ = false;
  align(clock);
}

unsigned StateMachine::pc(Cycle next) const {
  StateMachine present = *this;
  present.wake_up(next);
  return present.pc_;
}

void StateMachine::settle(Cycle next) {
  wake_up(next);
  shared_.due[index_] = active() ? next : never_cycle;
}

void StateMachine::schedule() {
  shared_.due[index_] = next_q8_ >> 8;
  // Delay ticks in between matter when pins are asserted again in each of them.
  if (shared_.every_clock || restless()) shared_.due[index_] = 0;
}

/// A clock before the next execution, with or without a tick of the delay.
void StateMachine::early(Cycle clock) {
  if (!enabled_) {
    shared_.due[index_] = never_cycle;
    return;
  }
  Cycle left = ticks_left(clock);
  if ((next_q8_ - left * divisor_q8_) >> 8 == clock) {
    refill();
    if (sticky_) apply_sticky();
    if (left > 0) --left;
  }
  const bool each_tick =
      shared_.every_clock || restless() || (autopull_ && osr_used_up() && !tx_.empty());
  shared_.due[index_] = (each_tick ? next_q8_ - left * divisor_q8_ : next_q8_) >> 8;
}

void StateMachine::stall(const Decoded& op, Cycle clock) {
  Cycle& due = shared_.due[index_];
  // The next step: at the next tick, or in the next clock for a forced instruction.
  due = running_forced_ ? clock + 1 : next_q8_ >> 8;
  if (shared_.every_clock) return;
  // Another machine may write a pin that this one asserts again in each tick.
  if ((op.side_mask & contested_) != 0 || (sticky_ && !alone_)) return;
  switch (op.operation) {
    case Operation::wait_gpio:
      watched_pin_ = 1u << op.arg;
      break;
    case Operation::wait_pin:
      watched_pin_ = 1u << ((op.arg + in_base_) & 31u);
      break;
    case Operation::wait_irq:
    case Operation::irq:
      waits_for_flag_ = true;
      break;
    case Operation::out:
      if (!osr_used_up()) return;  // refilled in this tick
      break;
    default:
      break;
  }
  sleep_ = Sleep::stall;
  due = never_cycle;
  if (watched_pin_ != 0) due = shared_.inputs.next_change(watched_pin_, clock, watched_latency());
}

void StateMachine::step_forced(Cycle clock) {
  wake_up(clock);
  if ((next_q8_ >> 8) == clock) next_q8_ += divisor_q8_;  // in place of the program's instruction
  running_forced_ = true;
  const bool done = execute(forced_op_);
  take_side_effects(forced_op_);
  if (done) {
    forced_ = false;
    jumped_ = false;
    shared_.due[index_] = enabled_ ? clock + 1 : never_cycle;
  } else {
    stall(forced_op_, clock);
  }
  running_forced_ = false;
}

// ---------------------------------------------------------------------------------------------
// Loops of jumps

inline bool StateMachine::condition(Operation operation, std::uint32_t& x, std::uint32_t& y,
                                    bool pin) const {
  switch (operation) {
    case Operation::jmp_always:
      return true;
    case Operation::jmp_not_x:
      return x == 0;
    case Operation::jmp_x_dec:
      return x-- != 0;  // decrements whether it jumps or not (3.4.2)
    case Operation::jmp_not_y:
      return y == 0;
    case Operation::jmp_y_dec:
      return y-- != 0;
    case Operation::jmp_x_ne_y:
      return x != y;
    case Operation::jmp_pin:
      return pin;
    default:
      return !osr_used_up();
  }
}

/// At the head of a loop that consists only of jumps whose conditions stay the same for a number of
/// rounds: sleeps through these rounds.
void StateMachine::try_loop(Cycle clock) {
  if (!is_jump(ops_[pc_].operation) || !enabled_) return;
  std::uint32_t x = x_, y = y_;
  const bool pin = (shared_.in >> jmp_pin_ & 1u) != 0;
  std::array<std::uint32_t, max_loop> x_tests{}, y_tests{};
  std::size_t x_count = 0, y_count = 0;
  bool uses_pin = false, compares = false, closed = false;
  std::uint32_t ticks = 0;
  unsigned pc = pc_;
  for (int i = 0; i < max_loop && !closed; ++i) {
    const Decoded& op = ops_[pc];
    if (!is_jump(op.operation)) return;
    if (op.side_mask != 0) {
      const std::uint32_t latch = op.side_to_dirs ? shared_.dirs : shared_.out;
      if ((op.side_mask & contested_) != 0 || (latch & op.side_mask) != op.side_bits) return;
    }
    const bool tests_x =
        op.operation == Operation::jmp_not_x || op.operation == Operation::jmp_x_dec;
    const bool tests_y =
        op.operation == Operation::jmp_not_y || op.operation == Operation::jmp_y_dec;
    if (tests_x) x_tests[x_count++] = x;
    if (tests_y) y_tests[y_count++] = y;
    uses_pin |= op.operation == Operation::jmp_pin;
    compares |= op.operation == Operation::jmp_x_ne_y;
    ticks += 1u + op.delay;
    if (condition(op.operation, x, y, pin))
      pc = op.arg;
    else
      pc = pc == wrap_top_ ? wrap_bottom_ : (pc + 1) & 31u;
    closed = pc == pc_;
  }
  if (!closed) return;
  const std::uint32_t dx = x_ - x, dy = y_ - y;
  if (compares && dx != dy) return;
  // Rounds in which every test has the same result as in this one.
  std::uint64_t rounds = max_rounds;
  const auto bound = [&rounds](std::uint32_t value, std::uint32_t step) {
    if (step != 0)
      rounds = std::min<std::uint64_t>(rounds, value == 0 ? 1 : (value - 1) / step + 1);
  };
  for (std::size_t i = 0; i < x_count; ++i) bound(x_tests[i], dx);
  for (std::size_t i = 0; i < y_count; ++i) bound(y_tests[i], dy);
  if (rounds * ticks < min_loop_sleep) return;
  sleep_ = Sleep::loop;
  loop_ = {ticks, dx, dy, pin};
  Cycle& due = shared_.due[index_];
  due = (next_q8_ + rounds * ticks * divisor_q8_) >> 8;
  if (!uses_pin) return;
  watched_pin_ = 1u << jmp_pin_;
  due = std::min(due, shared_.inputs.next_change(watched_pin_, clock, watched_latency()));
}

/// Applies what the loop has done before `clock`.
void StateMachine::leave_loop(Cycle clock) {
  const std::uint64_t from = clock << 8;
  if (next_q8_ >= from) return;
  const std::uint64_t ticks = ticks_in(from - next_q8_);
  const std::uint64_t rounds = ticks / loop_.ticks;
  x_ -= static_cast<std::uint32_t>(rounds) * loop_.dx;
  y_ -= static_cast<std::uint32_t>(rounds) * loop_.dy;
  next_q8_ += rounds * loop_.ticks * divisor_q8_;
  while (next_q8_ < from) {
    const Decoded& op = ops_[pc_];
    if (condition(op.operation, x_, y_, loop_.pin))
      pc_ = op.arg;
    else
      pc_ = static_cast<std::uint8_t>(pc_ == wrap_top_ ? wrap_bottom_ : (pc_ + 1) & 31u);
    next_q8_ += (1u + op.delay) * divisor_q8_;
  }
}

// ---------------------------------------------------------------------------------------------
// Instructions that no other part can notice

/// OUT, if no word is pulled and pins keep their levels.
inline bool StateMachine::out_unnoticed(const Decoded& op) {
  const unsigned bits = op.arg;
  if (autopull_ && osr_count_ + bits >= pull_threshold_) return false;
  const std::uint32_t data = next_out(bits);
  switch (op.field) {
    case 0:
    case 4:
      if (inline_enable_ ||
          !keeps(out_mask_, std::rotl(data, static_cast<int>(out_base_)), op.field == 4))
        return false;
      break;
    case 1:
      x_ = data;
      break;
    case 2:
      y_ = data;
      break;
    case 3:
      break;
    default:
      return false;
  }
  shift_out(bits);
  return true;
}

/// Executes an instruction if no other part can notice it; false: nothing was done.
inline bool StateMachine::execute_unnoticed(const Decoded& op) {
  if (op.side_mask != 0 && !keeps(op.side_mask, op.side_bits, op.side_to_dirs)) return false;
  if (autopull_ && osr_used_up()) return false;  // a word may be pulled
  switch (op.operation) {
    case Operation::jmp_always:
    case Operation::jmp_not_x:
    case Operation::jmp_x_dec:
    case Operation::jmp_not_y:
    case Operation::jmp_y_dec:
    case Operation::jmp_x_ne_y:
    case Operation::jmp_not_osre:
      if (condition(op.operation, x_, y_, false)) jump_to(op.arg);
      return true;
    case Operation::set_x:
      x_ = op.arg;
      return true;
    case Operation::set_y:
      y_ = op.arg;
      return true;
    case Operation::set_pins:
    case Operation::set_pindirs:
      return keeps(op.set_mask, op.set_bits, op.operation == Operation::set_pindirs);
    case Operation::out:
      return out_unnoticed(op);
    case Operation::mov: {
      // From X, Y, NULL, ISR, OSR to X, Y, ISR, OSR.
      const unsigned source = op.arg & 7u;
      if (source == 0 || source == 4 || source == 5 || op.arg >> 3 == 3) return false;
      if (op.field == 0 || (op.field >= 3 && op.field <= 5)) return false;
      run_mov(op);
      return true;
    }
    default:
      return false;
  }
}

/// WAIT for a pin that has the other level, with no change on its way: sleeps at once, because any
/// change of the pin wakes the machine.
bool StateMachine::sleep_in_wait(const Decoded& op, Cycle clock) {
  if (op.operation != Operation::wait_gpio && op.operation != Operation::wait_pin) return false;
  if (op.side_mask != 0 && !keeps(op.side_mask, op.side_bits, op.side_to_dirs)) return false;
  if (autopull_ && osr_used_up()) return false;
  const unsigned pin = op.operation == Operation::wait_gpio ? op.arg : (op.arg + in_base_) & 31u;
  if ((shared_.in >> pin & 1u) == op.field >> 2) return false;
  watched_pin_ = 1u << pin;
  if (shared_.inputs.next_change(watched_pin_, clock, watched_latency()) != never_cycle) {
    watched_pin_ = 0;
    return false;
  }
  sleep_ = Sleep::stall;
  shared_.due[index_] = never_cycle;
  return true;
}

void StateMachine::run_at_once(Cycle clock) {
  for (int i = 0; i < max_at_once; ++i) {
    const Decoded& op = ops_[pc_];
    const unsigned old = pc_;
    if (!at_once_) before_ = {next_q8_, x_, y_, isr_, osr_, isr_count_, osr_count_, pc_};
    if (!execute_unnoticed(op)) break;
    at_once_ = true;
    next_q8_ += divisor_q8_;
    move_on(op);
    if (pc_ <= old && is_jump(op.operation)) try_loop(clock);
    if (sleep_ != Sleep::none) return;
  }
  if (!sleep_in_wait(ops_[pc_], clock)) shared_.due[index_] = next_q8_ >> 8;
}

/// Undoes those instructions run at once that are not before `clock`.
void StateMachine::run_again(Cycle clock) {
  at_once_ = false;
  if ((next_q8_ >> 8) <= clock) return;
  next_q8_ = before_.next_q8;
  x_ = before_.x;
  y_ = before_.y;
  isr_ = before_.isr;
  osr_ = before_.osr;
  isr_count_ = before_.isr_count;
  osr_count_ = before_.osr_count;
  pc_ = before_.pc;
  sleep_ = Sleep::none;
  while ((next_q8_ >> 8) < clock) {
    const Decoded& op = ops_[pc_];
    execute_unnoticed(op);
    next_q8_ += divisor_q8_;
    move_on(op);
  }
}

// ---------------------------------------------------------------------------------------------
// Instructions

inline void StateMachine::write_pins(std::uint32_t mask, std::uint32_t bits, bool dirs) {
  std::uint32_t& latch = dirs ? shared_.dirs : shared_.out;
  latch = (latch & ~mask) | (bits & mask);
}

void StateMachine::stick(std::uint32_t mask, std::uint32_t bits, bool dirs) {
  (dirs ? sticky_dir_mask_ : sticky_mask_) = mask;
  (dirs ? sticky_dir_bits_ : sticky_bits_) = bits;
}

void StateMachine::apply_sticky() {
  write_pins(sticky_mask_, sticky_bits_, false);
  write_pins(sticky_dir_mask_, sticky_dir_bits_, true);
}

/// Autopull in a cycle without OUT (3.5.4.2).
inline void StateMachine::refill() {
  if (!autopull_ || !osr_used_up() || tx_.empty()) return;
  osr_ = tx_.pop();
  osr_count_ = 0;
  shared_.fifo_changed = true;
}

inline void StateMachine::take_side_effects(const Decoded& op) {
  if (op.operation != Operation::out) refill();
  if (sticky_) apply_sticky();
  // Side-set has precedence over OUT and SET (3.5.6.1), and happens even if the instruction stalls.
  if (op.side_mask != 0) write_pins(op.side_mask, op.side_bits, op.side_to_dirs);
}

inline bool StateMachine::execute_inline(const Decoded& op) {
  switch (op.operation) {
    case Operation::jmp_always:
    case Operation::jmp_not_x:
    case Operation::jmp_x_dec:
    case Operation::jmp_not_y:
    case Operation::jmp_y_dec:
    case Operation::jmp_x_ne_y:
    case Operation::jmp_pin:
    case Operation::jmp_not_osre:
      if (condition(op.operation, x_, y_, (shared_.in >> jmp_pin_ & 1u) != 0)) jump_to(op.arg);
      return true;
    case Operation::wait_gpio:
    case Operation::wait_pin:
    case Operation::wait_irq:
      return run_wait(op);
    case Operation::in:
      return run_in(op);
    case Operation::out:
      return run_out(op);
    case Operation::push:
      return run_push(op);
    case Operation::pull:
      return run_pull(op);
    case Operation::mov:
      run_mov(op);
      return true;
    case Operation::irq:
      return run_irq(op);
    case Operation::set_pins:
      write_pins(op.set_mask, op.set_bits, false);
      if (sticky_) stick(op.set_mask, op.set_bits, false);
      return true;
    case Operation::set_pindirs:
      write_pins(op.set_mask, op.set_bits, true);
      if (sticky_) stick(op.set_mask, op.set_bits, true);
      return true;
    case Operation::set_x:
      x_ = op.arg;
      return true;
    case Operation::set_y:
      y_ = op.arg;
      return true;
    case Operation::wait_reserved:
    case Operation::set_reserved:
      shared_.reserved_used = true;
      return true;
  }
  return true;
}

bool StateMachine::run_wait(const Decoded& op) {
  const bool wanted = (op.field & 4u) != 0;
  if (op.operation == Operation::wait_irq) {
    const std::uint32_t flag = 1u << flag_of(op.arg);
    if (((shared_.irq & flag) != 0) != wanted) return false;
    if (wanted) shared_.irq_clear |= flag;  // 3.4.3: waiting for 1 clears it
    return true;
  }
  const unsigned pin = op.operation == Operation::wait_gpio ? op.arg : (op.arg + in_base_) & 31u;
  return ((shared_.in >> pin & 1u) != 0) == wanted;
}

bool StateMachine::run_in(const Decoded& op) {
  const unsigned bits = op.arg;
  const unsigned count = std::min(32u, isr_count_ + bits);
  const bool push = autopush_ && count >= push_threshold_;
  if (push && rx_.full()) {
    shared_.fdebug |= 1u << (fdebug::rxstall + index_);
    return false;
  }
  std::uint32_t data = 0;
  switch (op.field) {
    case 0:
      data = std::rotr(shared_.in, static_cast<int>(in_base_));
      break;
    case 1:
      data = x_;
      break;
    case 2:
      data = y_;
      break;
    case 3:
      break;
    case 6:
      data = isr_;
      break;
    case 7:
      data = osr_;
      break;
    default:
      shared_.reserved_used = true;
  }
  data &= low_bits(bits);
  if (bits == 32)
    isr_ = data;
  else if (in_right_)
    isr_ = isr_ >> bits | data << (32 - bits);
  else
    isr_ = isr_ << bits | data;
  isr_count_ = count;
  if (push) {
    rx_.push(isr_);
    shared_.fifo_changed = true;
    isr_ = 0;
    isr_count_ = 0;
  }
  return true;
}

bool StateMachine::run_out(const Decoded& op) {
  if (autopull_ && osr_used_up()) {
    // An empty OSR cannot be filled and shifted in the same cycle (3.5.4.2).
    if (tx_.empty())
      shared_.fdebug |= 1u << (fdebug::txstall + index_);
    else
      refill();
    return false;
  }
  const unsigned bits = op.arg;
  const std::uint32_t data = next_out(bits);
  shift_out(bits);
  refill();
  switch (op.field) {
    case 0:
      write_out_pins(data, false, true);
      break;
    case 1:
      x_ = data;
      break;
    case 2:
      y_ = data;
      break;
    case 3:
      break;
    case 4:
      write_out_pins(data, true, true);
      break;
    case 5:
      jump_to(data & 31u);
      break;
    case 6:
      isr_ = data;
      isr_count_ = bits;
      break;
    default:
      set_exec(data);
  }
  return true;
}

/// OUT PINS, OUT PINDIRS, MOV PINS: the OUT mapping (3.5.6).
void StateMachine::write_out_pins(std::uint32_t data, bool dirs, bool is_out) {
  const std::uint32_t bits = std::rotl(data, static_cast<int>(out_base_));
  if (is_out && inline_enable_ && (data >> enable_bit_ & 1u) == 0) {
    stick(0, 0, dirs);  // also clears what OUT_STICKY asserts
    return;
  }
  write_pins(out_mask_, bits, dirs);
  if (sticky_ && is_out) stick(out_mask_, bits, dirs);
}

bool StateMachine::run_push(const Decoded& op) {
  const bool if_full = (op.field & 2u) != 0, block = (op.field & 1u) != 0;
  if (if_full && isr_count_ < push_threshold_) return true;
  if (rx_.full()) {
    shared_.fdebug |= 1u << (fdebug::rxstall + index_);
    if (block) return false;
  } else {
    rx_.push(isr_);
    shared_.fifo_changed = true;
  }
  isr_ = 0;
  isr_count_ = 0;
  return true;
}

bool StateMachine::run_pull(const Decoded& op) {
  const bool if_empty = (op.field & 2u) != 0, block = (op.field & 1u) != 0;
  // With autopull PULL does nothing while there is data (3.5.4.2).
  if ((if_empty || autopull_) && !osr_used_up()) return true;
  if (!tx_.empty()) {
    osr_ = tx_.pop();
    shared_.fifo_changed = true;
  } else if (block) {
    shared_.fdebug |= 1u << (fdebug::txstall + index_);
    return false;
  } else {
    osr_ = x_;
  }
  osr_count_ = 0;
  return true;
}

std::uint32_t StateMachine::status() const {
  const unsigned level = (execctrl_ >> 4 & 1u) != 0 ? rx_.level() : tx_.level();
  return level < (execctrl_ & 15u) ? ~0u : 0u;
}

std::uint32_t StateMachine::mov_source(unsigned source) const {
  switch (source) {
    case 0:
      return std::rotr(shared_.in, static_cast<int>(in_base_));
    case 1:
      return x_;
    case 2:
      return y_;
    case 5:
      return status();
    case 6:
      return isr_;
    case 7:
      return osr_;
    default:
      return 0;  // 3: NULL; 4 is reserved
  }
}

void StateMachine::run_mov(const Decoded& op) {
  const unsigned source = op.arg & 7u, operation = op.arg >> 3;
  std::uint32_t value = mov_source(source);
  if (operation == 1) value = ~value;
  if (operation == 2) value = reverse_bits(value);
  if (source == 4 || operation == 3) shared_.reserved_used = true;
  switch (op.field) {
    case 0:
      write_out_pins(value, false, false);
      break;
    case 1:
      x_ = value;
      break;
    case 2:
      y_ = value;
      break;
    case 4:
      set_exec(value);
      break;
    case 5:
      jump_to(value & 31u);
      break;
    case 6:
      isr_ = value;
      isr_count_ = 0;
      break;
    case 7:
      osr_ = value;
      osr_count_ = 0;
      break;
    default:
      shared_.reserved_used = true;
  }
}

bool StateMachine::run_irq(const Decoded& op) {
  const std::uint32_t flag = 1u << flag_of(op.arg);
  const bool clear = (op.field & 2u) != 0, wait = (op.field & 1u) != 0;
  if (clear) {
    shared_.irq_clear |= flag;
    return true;
  }
  bool& waiting = irq_waiting_[running_forced_ ? 1 : 0];
  if (waiting) {
    waiting = (shared_.irq & flag) != 0;
    return !waiting;
  }
  shared_.irq_set |= flag;
  waiting = wait;
  return !wait;
}

void StateMachine::set_exec(std::uint32_t raw) {
  exec_op_ = decode(static_cast<std::uint16_t>(raw), mapping_);
  exec_valid_ = true;
}

bool StateMachine::execute(const Decoded& op) { return execute_inline(op); }

// ---------------------------------------------------------------------------------------------
// Completes an instruction of the program; in one piece because most time is spent here

inline void StateMachine::move_on(const Decoded& op) {
  if (jumped_)
    jumped_ = false;
  else
    pc_ = static_cast<std::uint8_t>(pc_ == wrap_top_ ? wrap_bottom_ : (pc_ + 1) & 31u);
  // A delay on the instruction that latches another one is ignored (3.4.5, 3.4.8).
  if (op.delay != 0 && !exec_valid_) next_q8_ += op.delay * divisor_q8_;
}

inline void StateMachine::advance(const Decoded& op, Cycle clock) {
  const unsigned old = pc_;
  const std::uint64_t first = next_q8_;
  move_on(op);
  if (shared_.every_clock || restless()) {
    shared_.due[index_] = first >> 8;
    return;
  }
  shared_.due[index_] = next_q8_ >> 8;
  if (exec_valid_) return;
  if (pc_ <= old && is_jump(op.operation)) try_loop(clock);
  const Decoded& following = ops_[pc_];
  if (following.own && sleep_ == Sleep::none && !sticky_ &&
      keeps(following.set_mask, following.set_bits, following.operation == Operation::set_pindirs))
    run_at_once(clock);
}

void StateMachine::step(Cycle clock) {
  if (forced_) {
    step_forced(clock);
    return;
  }
  if (sleep_ != Sleep::none || at_once_ || (next_q8_ >> 8) < clock) [[unlikely]] {
    if (sleep_ == Sleep::none && (next_q8_ >> 8) == clock)
      at_once_ = false;  // the time of all that has run at once has passed
    else
      wake_up(clock);
  }
  if ((next_q8_ >> 8) > clock) {
    early(clock);
    return;
  }
  if (exec_valid_) {
    step_latched(clock);
    return;
  }
  const Decoded& op = ops_[pc_];
  const bool done = execute_inline(op);
  take_side_effects(op);
  next_q8_ += divisor_q8_;
  if (done)
    advance(op, clock);
  else
    stall(op, clock);
}

/// Executes the instruction that OUT EXEC or MOV EXEC has latched.
void StateMachine::step_latched(Cycle clock) {
  const Decoded op = exec_op_;  // the instruction may latch another one
  exec_valid_ = false;
  const bool done = execute(op);
  take_side_effects(op);
  next_q8_ += divisor_q8_;
  if (done) {
    jumped_ = false;
    next_q8_ += op.delay * divisor_q8_;
    schedule();
  } else {
    exec_valid_ = true;
    stall(op, clock);
  }
}

// ---------------------------------------------------------------------------------------------
// Registers

void StateMachine::force(std::uint16_t raw) {
  forced_op_ = decode(raw, mapping_);
  forced_ = true;
  irq_waiting_[1] = false;
}

void StateMachine::set_enabled(bool enabled, Cycle next) {
  if (enabled == enabled_) return;
  enabled_ = enabled;
  if (enabled) {
    align(next);
    next_q8_ += delay_left_ * divisor_q8_;
    delay_left_ = 0;
  } else {
    delay_left_ = ticks_left(next);
    next_q8_ -= delay_left_ * divisor_q8_;
  }
}

void StateMachine::restart(Cycle next) {
  // What SM_RESTART clears: the list in the description of CTRL (3.7).
  next_q8_ -= ticks_left(next) * divisor_q8_;
  delay_left_ = 0;
  isr_ = 0;
  isr_count_ = 0;
  osr_count_ = 32;
  irq_waiting_ = {};
  exec_valid_ = forced_ = false;
  stick(0, 0, false);
  stick(0, 0, true);
}

void StateMachine::restart_divider(Cycle next) {
  next_q8_ = (next << 8) + ticks_left(next) * divisor_q8_;
}

void StateMachine::set_clkdiv(std::uint32_t value, Cycle next) {
  clkdiv_ = value & 0xffff'ff00u;
  const std::uint64_t left = ticks_left(next);
  const std::uint64_t first = next_q8_ - left * divisor_q8_;
  const std::uint32_t whole = value >> 16;
  // 0 divides by 65536 (description of SMx_CLKDIV). A period that has begun keeps its length.
  divisor_q8_ =
      (whole == 0 ? std::uint64_t{1} << 24 : std::uint64_t{whole} << 8) | (value >> 8 & 0xffu);
  next_q8_ = first + left * divisor_q8_;
}

void StateMachine::set_execctrl(std::uint32_t value) {
  execctrl_ = value & 0x7fff'ff9fu;
  mapping_.side_enable = (value >> 30 & 1u) != 0;
  mapping_.side_pindir = (value >> 29 & 1u) != 0;
  jmp_pin_ = value >> 24 & 31u;
  enable_bit_ = value >> 19 & 31u;
  inline_enable_ = (value >> 18 & 1u) != 0;
  sticky_ = (value >> 17 & 1u) != 0;
  wrap_top_ = value >> 12 & 31u;
  wrap_bottom_ = value >> 7 & 31u;
  if (!sticky_) {
    stick(0, 0, false);
    stick(0, 0, true);
  }
  decode_all();
}

void StateMachine::set_shiftctrl(std::uint32_t value) {
  value &= 0xffff'0000u;
  const std::uint32_t join = 0xc000'0000u;
  if (((value ^ shiftctrl_) & join) != 0) {
    const bool join_rx = (value >> 31) != 0, join_tx = (value >> 30 & 1u) != 0;
    tx_.set_depth(join_rx ? 0 : join_tx ? 8 : 4);
    rx_.set_depth(join_tx ? 0 : join_rx ? 8 : 4);
    shared_.fifo_changed = true;
  }
  shiftctrl_ = value;
  pull_threshold_ = threshold(value >> 25);
  push_threshold_ = threshold(value >> 20);
  out_right_ = (value >> 19 & 1u) != 0;
  in_right_ = (value >> 18 & 1u) != 0;
  autopull_ = (value >> 17 & 1u) != 0;
  autopush_ = (value >> 16 & 1u) != 0;
}

void StateMachine::set_pinctrl(std::uint32_t value) {
  pinctrl_ = value;
  mapping_.side_count = value >> 29;
  mapping_.set_count = std::min(5u, value >> 26 & 7u);
  mapping_.side_base = value >> 10 & 31u;
  mapping_.set_base = value >> 5 & 31u;
  in_base_ = value >> 15 & 31u;
  out_base_ = value & 31u;
  out_mask_ = pin_mask(out_base_, std::min(32u, value >> 20 & 63u));
  decode_all();
}

void StateMachine::set_instruction(unsigned at, std::uint16_t raw) {
  ops_[at] = decode(raw, mapping_);
}

void StateMachine::decode_all() {
  for (Decoded& op : ops_) op = decode(op.raw, mapping_);
  exec_op_ = decode(exec_op_.raw, mapping_);
  forced_op_ = decode(forced_op_.raw, mapping_);
}

std::uint32_t StateMachine::reach() const {
  const unsigned side = std::min(5u, mapping_.side_count);
  return out_mask_ | pin_mask(mapping_.set_base, mapping_.set_count) |
         pin_mask(mapping_.side_base, side - (mapping_.side_enable && side > 0 ? 1u : 0u));
}

}  // namespace lamplock::sim::chip::pio
