// A Cortex-M0+ (r0p1, single-cycle multiplier) of the simulated chip: instructions, exceptions,
// NVIC, SysTick and the system registers at 0xe000e000.
//
// In:  instructions and data through Bus, levels of the interrupt lines, events of the other core.
// Out: the registers, accesses, and time: cycle() moves by what each instruction costs (Cortex-M0+
//      Technical Reference Manual, 3.3) and what the bus adds.
// Who: the loop of the chip. With one core running:
//
//        core.reset(vector_table);              // also after a reset of the chip
//        while (...) core.run_until(limit);     // sleeps, events and interrupts included
//
//      with two, the core whose cycle() is lower makes the next step:
//
//        Core& core = (core0.cycle() <= core1.cycle()) ? core0 : core1;
//        if (core.idle()) core.idle_to(other.cycle()); else core.step();
//
//      and if both are idle, both idle_to() the next event of the wheel (TimeWheel::next()).
//
// A core runs the events of the wheel that are due before each of its instructions, and Bus
// advances time to each register access. reset() must not be called from inside an access or an
// event (watchdog, SYSRESETREQ): note the request, call request_stop(), and reset after step() or
// run_until() has returned.
//
// As long as instructions touch only registers of the core and plain memory, execute() checks one
// thing between them: whether the next event of the wheel or the end of the run is due. Anything
// else (registers of blocks, the system space, contended memory, faults, sleep, a listener) ends
// execute(), and all states are checked again.
//
// Functions of the ROM are native: add_native() covers addresses. When the program counter reaches
// one, the function is called instead. It takes its arguments from r0..r3 (reg, set_reg) and
// returns how many cycles it took; the core continues at LR.
//
// An instruction that the manual calls UNPREDICTABLE raises a HardFault and is reported. Timing has
// the costs that the manual does not give.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "sim/chip/cpu/fault.hpp"
#include "sim/chip/cpu/mpu.hpp"
#include "sim/chip/cpu/nvic.hpp"
#include "sim/chip/cpu/systick.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/fabric/timing.hpp"

namespace lamplock::sim::chip {

/// Receives what a core does, for profiles and traces. Without a listener it costs a predictable
/// branch.
class CoreListener {
 public:
  virtual ~CoreListener() = default;
  /// The first instruction of the handler runs at `at`; entry (or the chain) began at `since`.
  virtual void exception_entered(int core, unsigned number, Cycle since, Cycle at) = 0;
  /// The handler's last instruction has run at `at`.
  virtual void exception_left(int core, unsigned number, Cycle at) = 0;
  /// BL, BLX: the first instruction of `to` runs at `at`.
  virtual void called(int core, std::uint32_t from, std::uint32_t to, Cycle at) = 0;
  /// BX, POP of the program counter and MOV to it, but not exception returns.
  virtual void branched(int core, std::uint32_t to, Cycle at) = 0;
  /// WFI, WFE, SLEEPONEXIT.
  virtual void slept(int core, Cycle at) = 0;
  virtual void woke(int core, Cycle at) = 0;
  /// PRIMASK has changed.
  virtual void masked(int core, bool interrupts_off, Cycle at) = 0;
};

class Core {
 public:
  Core(int id, Bus& bus, TimeWheel& wheel, IrqLines& irqs, const Timing& timing,
       NotModelled not_modelled = {});
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  /// Reset state; takes stack pointer and entry point from the vector table there (VTOR stays 0).
  /// The core starts at the wheel's time.
  void reset(std::uint32_t vector_table);
  /// Runs due events, then one instruction or one exception entry. Returns the cycles taken; 0: the
  /// core is idle(), or the other core makes the next step.
  Cycle step();
  /// Steps and sleeps until cycle() is `limit` or slightly more, or until request_stop().
  void run_until(Cycle limit);
  /// Runs two cores that are both awake: the one with the lower cycle() (the first of equals) makes
  /// the next step, until both have reached `limit`, one is idle, or there was a request_stop().
  static void run_two(Core& first, Core& second, Cycle limit);
  /// Lets time pass, events included, for a core that sleeps or has locked up, until it can run
  /// again or its cycle() is `to`.
  void idle_to(Cycle to);
  /// Runs events due up to and including `to`, which is not after cycle(). run_until() leaves those
  /// that became due during its last instruction.
  void run_events(Cycle to);
  /// run_until() returns after the current step.
  void request_stop();
  /// While the other core is awake, this one never runs time ahead of it, not even inside a step:
  /// an instruction of several cycles pauses until the other core has reached the same cycle. null:
  /// the other core sleeps. Holds until run_until() or run_two() returns.
  void wait_for(const Core* other) { other_ = other; }
  /// True in the middle of a multiple access or of an exception entry or return; the next step
  /// continues it.
  bool paused() const { return pause_ != Pause::none; }
  /// The other core or the chip reports that interrupt lines changed at `when`. During an exception
  /// entry or return the cycle matters.
  void lines_changed(Cycle when);
  /// True if an access of the other master was, in the end, served before one of this core
  /// (Arbiter).
  bool owes() const { return bus_.arbiter().owes(static_cast<Requester>(master_)); }
  /// First part of step(): spends the cycles that the core owes.
  void give_back();

  Cycle cycle() const { return cycle_; }
  /// In WFI, WFE or after SLEEPONEXIT, and nothing has ended the sleep yet.
  bool sleeping() const { return sleep_ != Sleep::awake && !can_wake(); }
  bool locked_up() const { return locked_up_ && !takeable_; }
  bool idle() const { return sleeping() || locked_up(); }
  /// Asleep with SCR.SLEEPDEEP set.
  bool sleeping_deeply() const { return sleeping() && (scr_ & scr_sleep_deep) != 0; }
  /// The next step is an exception entry.
  bool exception_waits() const { return takeable_; }
  /// The present value of a register at 0xe0000000, for debuggers: no side effects, no time. Empty
  /// if there is no such register.
  std::optional<std::uint32_t> peek_system(std::uint32_t address);

  /// r0..r15; 13 the stack pointer in use, 15 the address of the next instruction.
  std::uint32_t reg(unsigned number) const { return number == 15 ? pc_ : r_[number]; }
  void set_reg(unsigned number, std::uint32_t value);
  std::uint32_t xpsr() const;
  void set_xpsr(std::uint32_t value);
  std::uint32_t msp() const { return uses_psp() ? other_sp_ : r_[13]; }
  std::uint32_t psp() const { return uses_psp() ? r_[13] : other_sp_; }
  void set_msp(std::uint32_t value) { (uses_psp() ? other_sp_ : r_[13]) = value & ~3u; }
  void set_psp(std::uint32_t value) { (uses_psp() ? r_[13] : other_sp_) = value & ~3u; }
  bool primask() const { return primask_; }
  void set_primask(bool masked);
  std::uint32_t control() const { return control_; }
  void set_control(std::uint32_t value);
  std::uint32_t vtor() const { return vtor_; }
  void set_vtor(std::uint32_t value) { vtor_ = value & ~0xffu; }
  /// SCR; masks the value as a write to the register does.
  void set_scr(std::uint32_t value);
  /// Exception number of the handler that runs, 0 in thread mode.
  unsigned exception() const { return ipsr_; }
  int id() const { return id_; }

  /// What happens after a native function returns.
  enum class Then : std::uint8_t {
    returns,  ///< the core continues at LR
    again,    ///< called again at the same address after its cycles; interrupts may run between
    jumped    ///< the function has set the program counter itself
  };
  struct Native {
    std::uint32_t cycles = 1;
    Then then = Then::returns;
  };
  using NativeFunction = std::function<Native(Core& core, std::uint32_t address)>;
  /// Makes addresses first..last (even, both included) native. Must not be called during a run.
  void add_native(std::uint32_t first, std::uint32_t last, NativeFunction function);

  /// SEV of the other core, or another source that sets the event register.
  void send_event() { event_ = true; }
  /// This core's SEV; it has set its own event register already.
  std::function<void()> on_event;
  /// This core has noticed that interrupt lines changed in cycle `when`; not called from inside an
  /// event.
  std::function<void(Cycle when)> on_lines_changed;
  /// SysTick has just woken this core; called from inside an event, possibly one run by the other
  /// core.
  std::function<void()> on_woken;
  /// This core enters (true) or is about to leave (false) a sleep with SCR.SLEEPDEEP.
  std::function<void(bool asleep)> on_deep_sleep;
  /// BKPT: true if a debugger takes it; the core then stays at that instruction. Otherwise a
  /// HardFault.
  std::function<bool()> on_breakpoint;
  /// A HardFault is taken, or the core locks up. `at` is not filled in.
  std::function<void(const Fault&)> on_fault;
  /// AIRCR.SYSRESETREQ was written; see reset().
  std::function<void()> on_reset_request;
  /// The lines that raise NMI (SYSCFG PROC0_NMI_MASK, PROC1_NMI_MASK).
  void set_nmi_mask(std::uint32_t mask);
  SysTick& systick() { return systick_; }
  /// One listener; null: none.
  void listen(CoreListener* listener) { listener_ = listener; }

 private:
  enum class Sleep : std::uint8_t { awake, wfi, wfe };
  /// The part of a step that is still to be completed.
  enum class Pause : std::uint8_t { none, words, entering, leaving };
  static constexpr std::uint32_t scr_sleep_on_exit = 1u << 1, scr_sleep_deep = 1u << 2,
                                 scr_sev_on_pend = 1u << 4;

  // core.cpp: instructions
  // Those that are rare are not inlined: execute() keeps its state in registers.
  void execute(Cycle until);
  [[gnu::noinline]] std::optional<std::uint16_t> fetch_outside(std::uint32_t pc);
  std::optional<std::uint16_t> fetch_code(std::uint32_t pc);
  std::optional<std::uint16_t> fetch_word(std::uint32_t pc);
  std::optional<std::uint16_t> fetch_from_memory(std::uint32_t pc);
  void forget_code();
  [[gnu::noinline]] void cut_natives(std::uint32_t pc, Bus::CodeWindow& window) const;
  [[gnu::noinline]] std::optional<std::uint16_t> fetch_second(std::uint32_t pc);
  void call_native(const NativeFunction& function);
  [[gnu::noinline]] bool execute_wide(std::uint16_t first, std::uint16_t second);
  bool execute_mrs(std::uint16_t second);
  bool execute_msr(std::uint16_t first, std::uint16_t second);
  [[gnu::noinline]] void execute_hint(std::uint16_t instruction);
  [[gnu::noinline]] void execute_exchange(std::uint16_t instruction);
  [[gnu::noinline]] void execute_high(std::uint16_t instruction);
  [[gnu::noinline]] bool load_multiple(std::uint16_t instruction);
  [[gnu::noinline]] bool store_multiple(std::uint16_t instruction);
  [[gnu::noinline]] bool push(std::uint16_t instruction);
  [[gnu::noinline]] void pop(std::uint16_t instruction);
  /// Words of a multiple access: eight low registers and LR or PC.
  using Words = std::array<std::uint32_t, 9>;
  unsigned gather(unsigned list, Words& words) const;
  unsigned scatter(unsigned list, const Words& words);
  std::uint8_t* put(unsigned list, std::uint8_t* words) const;
  void take(unsigned list, const std::uint8_t* words);
  template <class Transfer>
  bool each_word(std::uint32_t address, unsigned first, unsigned count, MpuAccess kind,
                 const Transfer& transfer);
  bool load_block(std::uint32_t address, unsigned first, unsigned count);
  bool store_block(std::uint32_t address, unsigned first, unsigned count, const Words& words);
  bool word_may_begin(unsigned word);
  bool pause_or_abandon(unsigned word);
  unsigned begin_words(std::uint16_t instruction);
  void resume();
  void resume_words();
  Cycle horizon() const { return other_ == nullptr ? never_cycle : other_->cycle_; }
  bool waits() const {
    return other_ != nullptr && (id_ == 0 ? other_->cycle_ < cycle_ : other_->cycle_ <= cycle_);
  }
  bool complete(std::uint32_t address, Width width, MpuAccess kind, const Access& access);
  [[gnu::noinline, gnu::cold]] bool access_fault(std::uint32_t address, Width width,
                                                 MpuAccess kind);
  [[gnu::noinline]] bool load(std::uint32_t address, Width width, std::uint32_t& value);
  [[gnu::noinline]] bool store(std::uint32_t address, Width width, std::uint32_t value);
  Access read_bus(std::uint32_t address, Width width);
  [[gnu::noinline]] Access read_checked(std::uint32_t address, Width width);
  [[gnu::noinline]] Access write_checked(std::uint32_t address, Width width, std::uint32_t value);
  bool permits(std::uint32_t address, MpuAccess access) const;
  Access write_bus(std::uint32_t address, Width width, std::uint32_t value);
  void branch_exchange(std::uint32_t target);
  bool undefined(FaultCause cause = FaultCause::undefined_instruction);
  [[gnu::noinline]] bool unpredictable(std::uint16_t instruction);
  bool condition(unsigned code) const;

  void set_nz(std::uint32_t result) { n_ = z_ = result; }
  std::uint32_t add_with_carry(std::uint32_t a, std::uint32_t b, bool carry) {
    const std::uint32_t result = a + b + (carry ? 1u : 0u);
    c_ = carry ? result <= a : result < a;
    v_ = ((~(a ^ b) & (a ^ result)) >> 31) != 0;
    set_nz(result);
    return result;
  }
  std::uint32_t shift_left(std::uint32_t value, std::uint32_t amount);
  std::uint32_t shift_right(std::uint32_t value, std::uint32_t amount);
  std::uint32_t shift_right_signed(std::uint32_t value, std::uint32_t amount);
  std::uint32_t rotate_right(std::uint32_t value, std::uint32_t amount);

  // exceptions.cpp
  bool attend();
  void systick_expired();
  bool attention_needed() const {
    return attention_ || wheel_.next() <= cycle_ || irqs_.changes() != seen_changes_;
  }
  /// No event is due before this cycle, unless an instruction causes one.
  Cycle undisturbed_until(Cycle limit) const {
    return attention_ ? 0 : std::min(limit, wheel_.next());
  }
  void run_event();
  void notice_access();
  void sample(Cycle when);
  void refresh(Cycle when);
  void update_attention();
  int execution_priority() const;
  bool can_wake() const;
  void sleep(Sleep kind);
  void hard_fault(FaultCause cause, std::uint32_t address = 0);
  void lock_up(FaultCause cause, std::uint32_t address, std::uint32_t lr);
  void note_fault(FaultKind kind, FaultCause cause, std::uint32_t address, std::uint32_t lr) const;
  void supervisor_call(std::uint32_t next);
  void enter(unsigned number, std::uint32_t return_address);
  bool push_frame(std::uint32_t return_address, std::uint32_t& waits);
  void start_handler(unsigned number, Cycle since, Cycle end);
  bool pass_exchange();
  void finish_entry();
  void finish_return();
  void notice_in_exchange(unsigned best, Cycle when);
  void exception_return(std::uint32_t value);
  void chain(unsigned number, std::uint32_t exc_return, Cycle at);
  bool pop_frame(std::uint32_t exc_return, std::uint32_t& waits);
  bool uses_psp() const { return ipsr_ == 0 && (control_ & control_spsel) != 0; }
  bool privileged() const { return ipsr_ != 0 || (control_ & control_npriv) == 0; }

  // system_registers.cpp
  bool read_system(std::uint32_t address, std::uint32_t& value);
  std::optional<std::uint32_t> system_register(std::uint32_t offset, Cycle at);
  bool write_system(std::uint32_t address, std::uint32_t value);
  std::uint32_t read_icsr() const;
  void write_icsr(std::uint32_t value);
  bool write_nvic(std::uint32_t offset, std::uint32_t value);
  void write_mpu(std::uint32_t offset, std::uint32_t value);
  void report(std::uint32_t address);

  static constexpr std::uint32_t ppb_base = 0xe000'0000;
  static constexpr std::uint32_t control_npriv = 1, control_spsel = 2;

  // State that every instruction uses, kept together.
  std::array<std::uint32_t, 15> r_{};
  std::uint32_t pc_ = 0;
  std::uint32_t n_ = 0;  ///< bit 31 is the N flag
  bool c_ = false, v_ = false;
  std::uint32_t z_ = 1;     ///< zero: Z is set; beside n_ both would be stored as a vector, slower
  bool attention_ = false;  ///< one of the states below needs attend()
  Cycle cycle_ = 0;
  Bus::CodeWindow window_;
  std::uint32_t seen_changes_ = 0;
  /// Below this address the bus is used without a check: the PPB, or 0 while the MPU is on.
  std::uint32_t unchecked_end_ = ppb_base;
  TimeWheel& wheel_;
  IrqLines& irqs_;
  Bus& bus_;
  CoreListener* listener_ = nullptr;

  bool thumb_ = true;      ///< EPSR.T
  bool takeable_ = false;  ///< an exception is pending that the present priority lets through
  bool locked_up_ = false;
  bool stop_ = false;
  bool primask_ = false;
  Pause pause_ = Pause::none;
  bool event_ = false;  ///< the event register of WFE
  bool nmi_level_ = false;
  Sleep sleep_ = Sleep::awake;
  Cycle since_ = 0;  ///< when takeable_ became true
  unsigned ipsr_ = 0;
  std::uint32_t control_ = 0;
  std::uint32_t other_sp_ = 0;  ///< the one of MSP and PSP that is not r13
  std::uint32_t vtor_ = 0;
  std::uint32_t scr_ = 0;
  std::uint32_t nmi_mask_ = 0;
  Mpu mpu_;

  const Core* other_ = nullptr;  ///< awake
  /// A multiple access, of which words before `next` are done.
  struct Multiple {
    std::uint16_t instruction = 0;
    unsigned next = 0;
    Words words{};
  };
  Multiple multiple_;
  /// An exception entry or return in progress.
  struct Exchange {
    unsigned number = 0;       ///< of the handler entered
    std::uint32_t value = 0;   ///< EXC_RETURN of the handler left
    Cycle start = 0;           ///< where it began
    Cycle since = 0, end = 0;  ///< of entry, chain or return; an event before `end` may change it
  };
  Exchange exchange_;

  int id_;
  Master master_;
  const Timing& timing_;
  NotModelled not_modelled_;
  Nvic nvic_;
  SysTick systick_;
  struct NativeRange {
    std::uint32_t first, last;
    NativeFunction function;
  };
  std::vector<NativeRange> natives_;  ///< in the order of their addresses
  std::vector<NativeRange>::const_iterator native_above(std::uint32_t address) const;
  /// ROM or SRAM around the last word that was contended for, without native functions.
  Bus::CodeWindow memory_;
  /// The word fetched last, where code is fetched word by word; window_ shows it.
  std::array<std::uint8_t, 4> fetched_{};
};

}  // namespace lamplock::sim::chip
