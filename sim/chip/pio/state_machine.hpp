// One state machine of a PIO block (RP2040 datasheet, chapter 3).
//
// In:  its registers, its FIFOs, the inputs and interrupt flags of the block, and the clocks in
//      which the block runs it.
// Out: writes to the block's output latches, interrupt flags (gathered, as they take effect at the
//      end of the clock), FIFO words, debug flags, and the clock of its next run.
//
// Time is counted in 1/256 clocks (the divider has 8 fractional bits): execution number n of a grid
// that began at q executes in clock (q + n * divisor) >> 8, as with a first-order delta divider
// (3.5.5). The grid continues while the machine is disabled or stalled.
//
// Machines sleep that stall on a pin, a flag or a FIFO, or run a loop of jumps whose period is
// known (`jmp x--` on itself, or a loop that counts while it polls a pin). After a change both
// continue exactly where hardware would be.
//
// Instructions that no other part can notice (registers of the machine alone, pins that keep their
// levels) run at once after the one before them, up to the next that can be noticed or depends on
// other parts. If something changes before that one is due, the machine returns to the state before
// them and runs them again, up to the present time.
//
// With every_clock set nothing sleeps and nothing runs at once.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/pio/fifo.hpp"
#include "sim/chip/pio/input_history.hpp"
#include "sim/chip/pio/instruction.hpp"

namespace lamplock::sim::chip::pio {

inline constexpr unsigned machine_count = 4;

/// State that the four machines of a block share.
struct Shared {
  std::array<Cycle, machine_count> due{never_cycle, never_cycle, never_cycle, never_cycle};
  std::uint32_t in = 0;                      ///< inputs as seen in this clock
  std::uint32_t out = 0, dirs = 0;           ///< output latches
  std::uint32_t irq = 0;                     ///< the eight flags
  std::uint32_t irq_set = 0, irq_clear = 0;  ///< by instructions of this clock
  std::uint32_t fdebug = 0;
  bool fifo_changed = false;  ///< since the owner looked
  bool every_clock = false;
  std::uint32_t bypass = 0;    ///< INPUT_SYNC_BYPASS
  bool reserved_used = false;  ///< an instruction with a reserved field was executed
  InputHistory inputs;
};

/// Bits of FDEBUG, for machine 0.
namespace fdebug {
inline constexpr unsigned rxstall = 0, rxunder = 8, txover = 16, txstall = 24;
}

class StateMachine {
 public:
  StateMachine(Shared& shared, unsigned index) : shared_(shared), index_(index) {}

  /// Resets all registers; `next` is the first clock to come.
  void reset(Cycle next);
  /// Runs clock `clock`. Called when the machine is due, or more often.
  void step(Cycle clock);

  // Registers. Before each write the owner calls settle().
  /// Brings counters of a sleeping loop and the tick grid up to the first clock to come.
  void settle(Cycle next);
  void set_enabled(bool enabled, Cycle next);
  bool enabled() const { return enabled_; }
  void restart(Cycle next);
  void restart_divider(Cycle next);
  void set_clkdiv(std::uint32_t value, Cycle next);
  void set_execctrl(std::uint32_t value);
  void set_shiftctrl(std::uint32_t value);
  void set_pinctrl(std::uint32_t value);
  std::uint32_t clkdiv() const { return clkdiv_; }
  std::uint32_t execctrl() const { return execctrl_ | (latched() ? 1u << 31 : 0u); }
  std::uint32_t shiftctrl() const { return shiftctrl_; }
  std::uint32_t pinctrl() const { return pinctrl_; }
  /// The program counter in clock `next`, even when asleep or ahead, and the instruction there.
  unsigned pc(Cycle next) const;
  std::uint16_t current_instruction(Cycle next) const { return ops_[pc(next)].raw; }
  void set_instruction(unsigned at, std::uint16_t raw);
  /// SMx_INSTR written: executes in the next clock whatever the divider and delay (3.5.7).
  void force(std::uint16_t raw);

  /// An event that the machine may wait for: it checks again in clock `next`.
  void wake(Cycle next) {
    if (active()) shared_.due[index_] = std::min(shared_.due[index_], next);
  }
  /// Wakes it if it waits for an interrupt flag, or for one of these pins at cycle `at`.
  void flags_changed(Cycle next) {
    if (waits_for_flag_) wake(next);
  }
  void inputs_changed(std::uint32_t changed, Cycle at) {
    if ((watched_pin_ & changed) != 0) wake(at + watched_latency());
  }
  bool active() const { return enabled_ || forced_; }
  /// All pins that it can write.
  std::uint32_t reach() const;
  /// Pins that other active machines can write.
  void set_contested(std::uint32_t pins) {
    contested_ = pins;
    alone_ = (reach() & pins) == 0;
  }

  Fifo& tx() { return tx_; }
  Fifo& rx() { return rx_; }
  const Fifo& tx() const { return tx_; }
  const Fifo& rx() const { return rx_; }

 private:
  enum class Sleep : std::uint8_t { none, stall, loop };
  /// A loop of jumps: one pass takes `ticks` executions and delays; X and Y decrease by dx and dy.
  struct Loop {
    std::uint32_t ticks = 0, dx = 0, dy = 0;
    bool pin = false;  ///< level of the JMP pin while it sleeps
  };
  /// State that instructions can change unnoticed by other parts.
  struct Own {
    std::uint64_t next_q8 = 0;
    std::uint32_t x = 0, y = 0, isr = 0, osr = 0;
    unsigned isr_count = 0, osr_count = 0;
    std::uint8_t pc = 0;
  };

  bool latched() const { return exec_valid_ || forced_; }
  Cycle watched_latency() const {
    return (watched_pin_ & shared_.bypass) != 0 ? bypassed_latency : input_latency;
  }
  bool execute(const Decoded& op);
  [[gnu::always_inline]] bool execute_inline(const Decoded& op);
  [[gnu::always_inline]] void take_side_effects(const Decoded& op);
  [[gnu::always_inline]] void advance(const Decoded& op, Cycle clock);
  void step_latched(Cycle clock);
  void stall(const Decoded& op, Cycle clock);
  void step_forced(Cycle clock);
  void early(Cycle clock);
  void wake_up(Cycle clock);
  void align(Cycle clock);
  Cycle ticks_left(Cycle clock) const;
  void try_loop(Cycle clock);
  [[gnu::noinline]] void run_at_once(Cycle clock);
  void run_again(Cycle clock);
  bool execute_unnoticed(const Decoded& op);
  bool out_unnoticed(const Decoded& op);
  bool sleep_in_wait(const Decoded& op, Cycle clock);
  [[gnu::always_inline]] void move_on(const Decoded& op);
  /// Ticks of the divider in a time, rounded up.
  std::uint64_t ticks_in(std::uint64_t time_q8) const {
    // Most machines run undivided, and a division takes as long as an instruction.
    if (divisor_q8_ == 256) return (time_q8 + 255) >> 8;
    return (time_q8 + divisor_q8_ - 1) / divisor_q8_;
  }
  /// True if a write keeps the levels of pins of one latch that no other machine writes.
  bool keeps(std::uint32_t mask, std::uint32_t bits, bool dirs) const {
    return (((dirs ? shared_.dirs : shared_.out) ^ bits) & mask) == 0 && (mask & contested_) == 0;
  }
  void leave_loop(Cycle clock);
  void schedule();
  void decode_all();
  void write_pins(std::uint32_t mask, std::uint32_t bits, bool dirs);
  void stick(std::uint32_t mask, std::uint32_t bits, bool dirs);
  void apply_sticky();
  void refill();
  /// Pins may change in ticks in which nothing executes: OUT_STICKY restores what a side-set or
  /// another machine has overwritten.
  bool restless() const { return sticky_ && (!alone_ || mapping_.side_count != 0); }
  /// The bits that OUT takes next, 1 to 32 of them.
  std::uint32_t next_out(unsigned bits) const {
    return out_right_ ? osr_ & low_bits(bits) : osr_ >> (32 - bits);
  }
  void shift_out(unsigned bits) {
    if (bits == 32)
      osr_ = 0;
    else
      osr_ = out_right_ ? osr_ >> bits : osr_ << bits;
    osr_count_ = std::min(32u, osr_count_ + bits);
  }
  bool osr_used_up() const { return osr_count_ >= pull_threshold_; }

  bool run_wait(const Decoded& op);
  bool run_in(const Decoded& op);
  bool run_out(const Decoded& op);
  bool run_push(const Decoded& op);
  bool run_pull(const Decoded& op);
  void run_mov(const Decoded& op);
  bool run_irq(const Decoded& op);
  std::uint32_t mov_source(unsigned source) const;
  void write_out_pins(std::uint32_t data, bool dirs, bool is_out);
  void set_exec(std::uint32_t raw);
  void jump_to(unsigned target) {
    pc_ = static_cast<std::uint8_t>(target);
    jumped_ = true;
  }
  [[gnu::always_inline]] bool condition(Operation operation, std::uint32_t& x, std::uint32_t& y,
                                        bool pin) const;
  unsigned flag_of(unsigned index) const {
    // The top bit adds the machine's number to the low two bits, modulo four (3.4.9).
    const unsigned flag = index & 7u;
    return (index & 16u) != 0 ? (flag & 4u) | ((flag + index_) & 3u) : flag;
  }
  std::uint32_t status() const;

  Shared& shared_;
  unsigned index_;

  std::uint64_t next_q8_ = 0;  ///< when the next instruction executes
  std::uint64_t divisor_q8_ = 256;
  std::uint32_t x_ = 0, y_ = 0, isr_ = 0, osr_ = 0;
  unsigned isr_count_ = 0, osr_count_ = 32;
  std::uint8_t pc_ = 0;
  bool enabled_ = false;
  bool jumped_ = false;
  bool exec_valid_ = false;  ///< an instruction from OUT EXEC or MOV EXEC comes next or stalls
  bool forced_ = false;      ///< an instruction written to INSTR
  bool running_forced_ = false;
  std::array<bool, 2> irq_waiting_{};  ///< of the program, of a forced instruction
  bool alone_ = true;                  ///< none of the pins that it can write is contested
  std::uint32_t contested_ = 0;
  Sleep sleep_ = Sleep::none;
  bool at_once_ = false;  ///< instructions before next_q8_ have run at once
  bool waits_for_flag_ = false;
  std::uint32_t watched_pin_ = 0;
  std::uint64_t delay_left_ = 0;  ///< delay that a disabled machine has yet to do
  Loop loop_;
  Own before_;  ///< if at_once_: the state before them

  // Fields of the registers.
  std::uint32_t clkdiv_ = 0, execctrl_ = 0, shiftctrl_ = 0, pinctrl_ = 0;
  unsigned wrap_top_ = 31, wrap_bottom_ = 0, jmp_pin_ = 0;
  bool sticky_ = false, inline_enable_ = false;
  unsigned enable_bit_ = 0;
  unsigned push_threshold_ = 32, pull_threshold_ = 32;
  bool autopush_ = false, autopull_ = false, in_right_ = true, out_right_ = true;
  unsigned in_base_ = 0, out_base_ = 0;
  std::uint32_t out_mask_ = 0;

  // Levels that OUT_STICKY keeps asserting.
  std::uint32_t sticky_mask_ = 0, sticky_bits_ = 0, sticky_dir_mask_ = 0, sticky_dir_bits_ = 0;

  Fifo tx_, rx_;
  Decoded exec_op_, forced_op_;
  Mapping mapping_;
  std::array<Decoded, 32> ops_{};
};

}  // namespace lamplock::sim::chip::pio
