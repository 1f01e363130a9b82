// Exceptions of the core: entry, return, chaining, sleep, lock-up (ARMv6-M Architecture Reference
// Manual, B1.5).
#include <algorithm>

#include "sim/chip/cpu/core.hpp"

namespace lamplock::sim::chip {

namespace {

// Cortex-M0+ Technical Reference Manual: 15 cycles from the assertion of an interrupt to the first
// instruction of its handler, memory without wait states. Up to two of them overlap the instruction
// in progress (assumed): an instruction that is not abandoned has at most two left.
constexpr Cycle entry_cycles = 15;
constexpr Cycle entry_overlap = 2;

constexpr std::uint32_t frame_size = 32;
constexpr std::uint32_t frame_align = 4;
constexpr std::uint32_t psr_aligned = 1u << 9;
constexpr std::uint32_t psr_exception = 0x3f;

constexpr std::uint32_t return_to_handler = 0xffff'fff1;
constexpr std::uint32_t return_to_thread_msp = 0xffff'fff9;
constexpr std::uint32_t return_to_thread_psp = 0xffff'fffd;

constexpr std::uint32_t lock_up_address = 0xffff'fffe;

constexpr unsigned hard_fault_number = number_of(Exception::hard_fault);

}  // namespace

int Core::execution_priority() const {
  const int active = nvic_.active_priority();
  return primask_ ? std::min(active, 0) : active;
}

void Core::refresh(Cycle when) {
  const unsigned best = nvic_.best();
  const bool take = best != 0 && nvic_.priority(best) < execution_priority();
  if (take && !takeable_) since_ = when;
  takeable_ = take;
  if (pause_ == Pause::entering || pause_ == Pause::leaving) notice_in_exchange(best, when);
  update_attention();
}

void Core::update_attention() {
  attention_ = takeable_ || stop_ || locked_up_ || !thumb_ || sleep_ != Sleep::awake ||
               pause_ != Pause::none || owes();
}

void Core::sample(Cycle when) {
  seen_changes_ = irqs_.changes();
  const std::uint32_t levels = irqs_.levels(id_);
  bool pended = nvic_.sample(levels);
  const bool nmi = (levels & nmi_mask_) != 0;
  if (nmi && !nmi_level_) {
    nvic_.pend(number_of(Exception::nmi));
    pended = true;
  }
  nmi_level_ = nmi;
  if (pended && (scr_ & scr_sev_on_pend) != 0) event_ = true;
  refresh(when);
  if (on_lines_changed) on_lines_changed(when);
}

void Core::lines_changed(Cycle when) {
  if (pause_ != Pause::none && irqs_.changes() != seen_changes_) sample(when);
}

// Runs only the next event, so that the time of a line's rise is known. It may wake the other core.
void Core::run_event() {
  const Cycle when = wheel_.next();
  wheel_.advance_to(when);
  if (irqs_.changes() != seen_changes_) sample(when);
}

void Core::run_events(Cycle to) {
  while (wheel_.next() <= std::min(to, horizon())) run_event();
  if (irqs_.changes() != seen_changes_) sample(cycle_);
}

// A change by this core's own access to a register shows in the next cycle: time has been advanced
// only to the access.
void Core::notice_access() {
  if (irqs_.changes() != seen_changes_) sample(wheel_.now() + 1);
}

bool Core::can_wake() const {
  if (takeable_) return true;
  if (sleep_ == Sleep::wfe) return event_;
  // WFI also ends for an exception that only PRIMASK holds back.
  const unsigned best = nvic_.best();
  return best != 0 && nvic_.priority(best) < nvic_.active_priority();
}

void Core::sleep(Sleep kind) {
  sleep_ = kind;
  update_attention();
  if (listener_ != nullptr) listener_->slept(id_, cycle_);
  if ((scr_ & scr_sleep_deep) != 0 && on_deep_sleep) on_deep_sleep(true);
}

void Core::systick_expired() {
  const bool slept = sleeping();
  nvic_.pend(number_of(Exception::systick));
  refresh(wheel_.now());
  if (!slept || sleeping()) return;
  // The core has slept until now, whatever its cycle() is.
  cycle_ = std::max(cycle_, wheel_.now());
  if (on_woken) on_woken();
}

// Handles everything before the next instruction; true if this uses up the step.
bool Core::attend() {
  run_events(cycle_);
  if (waits() || stop_) return true;
  if (!attention_) return false;
  if (sleep_ != Sleep::awake) {
    if (!can_wake()) return true;
    if (sleep_ == Sleep::wfe) event_ = false;
    sleep_ = Sleep::awake;
    update_attention();
    if (listener_ != nullptr) listener_->woke(id_, cycle_);
    if ((scr_ & scr_sleep_deep) != 0 && on_deep_sleep) on_deep_sleep(false);
  }
  if (takeable_) {
    enter(nvic_.best(), pc_);
    return true;
  }
  if (locked_up_) return true;
  if (!thumb_) {
    hard_fault(FaultCause::even_address);
    return true;
  }
  return false;
}

void Core::idle_to(Cycle to) {
  while (true) {
    if (irqs_.changes() != seen_changes_) {
      // The core has slept until another part changed the lines.
      cycle_ = std::max(cycle_, wheel_.now());
      sample(cycle_);
    }
    if (!idle() || stop_) return;
    const Cycle next = wheel_.next();
    if (next > to) break;
    cycle_ = std::max(cycle_, next);
    wheel_.advance_to(next);
  }
  cycle_ = std::max(cycle_, to);
}

void Core::request_stop() {
  stop_ = true;
  update_attention();
}

// A fault of the current instruction (or of its fetch); it runs again after a return.
void Core::hard_fault(FaultCause cause, std::uint32_t address) {
  if (execution_priority() <= -1) return lock_up(cause, address, r_[14]);
  note_fault(FaultKind::hard_fault, cause, address, r_[14]);
  enter(hard_fault_number, pc_);
}

void Core::note_fault(FaultKind kind, FaultCause cause, std::uint32_t address,
                      std::uint32_t lr) const {
  if (on_fault) on_fault({kind, cause, address, id_, pc_, lr, cycle_});
}

void Core::lock_up(FaultCause cause, std::uint32_t address, std::uint32_t lr) {
  note_fault(FaultKind::lock_up, cause, address, lr);
  locked_up_ = true;
  pc_ = lock_up_address;
  refresh(cycle_);
}

void Core::supervisor_call(std::uint32_t next) {
  constexpr unsigned number = number_of(Exception::svcall);
  if (nvic_.priority(number) < execution_priority())
    enter(number, next);
  else
    hard_fault(FaultCause::supervisor_call);
}

void Core::enter(unsigned number, std::uint32_t return_address) {
  const Cycle since = cycle_;
  const Cycle overlap = takeable_ && since_ < cycle_ ? std::min(cycle_ - since_, entry_overlap) : 0;
  std::uint32_t waits = 0;
  const std::uint32_t stack = r_[13], lr = r_[14];  // before they are those of the handler
  locked_up_ = false;
  if (!push_frame(return_address, waits)) {
    if (number == hard_fault_number || execution_priority() <= -1) {
      cycle_ += entry_cycles;
      return lock_up(FaultCause::stacking, stack - frame_size, lr);
    }
    note_fault(FaultKind::hard_fault, FaultCause::stacking, stack - frame_size, lr);
    number = hard_fault_number;
  }
  start_handler(number, since - overlap, since - overlap + entry_cycles + waits);
}

bool Core::push_frame(std::uint32_t return_address, std::uint32_t& waits) {
  const std::uint32_t sp = r_[13];
  const std::uint32_t frame = (sp - frame_size) & ~frame_align;
  const std::uint32_t psr = xpsr() | ((sp & frame_align) != 0 ? psr_aligned : 0);
  const std::array<std::uint32_t, 8> words = {r_[0],  r_[1],  r_[2],          r_[3],
                                              r_[12], r_[14], return_address, psr};
  const std::uint32_t link = ipsr_ != 0   ? return_to_handler
                             : uses_psp() ? return_to_thread_psp
                                          : return_to_thread_msp;
  bool good = true;
  const Cycle start = cycle_;
  for (std::uint32_t i = 0; i < words.size() && good; ++i) {
    cycle_ = start + i + waits;  // a word a cycle, from the first on (assumed)
    const Access access = write_bus(frame + 4 * i, Width::word, words[i]);
    good = !access.fault;
    waits += access.wait;
  }
  cycle_ = start;
  r_[13] = frame;
  if (uses_psp()) std::swap(r_[13], other_sp_);
  control_ &= ~control_spsel;
  r_[14] = link;
  return good;
}

// The end of an entry or a chain: until the handler's first instruction runs, a higher priority may
// still replace it.
void Core::start_handler(unsigned number, Cycle since, Cycle end) {
  exchange_ = {number, 0, cycle_, since, end};
  pause_ = Pause::entering;
  finish_entry();
}

// Runs due events until the end of an exchange, one by one; refresh() may change the exchange.
// False: it pauses because the other core has not reached that cycle.
bool Core::pass_exchange() {
  const Pause kind = pause_;
  while (wheel_.next() < exchange_.end && wheel_.next() <= horizon()) {
    run_event();
    if (pause_ != kind) return true;
  }
  if (horizon() >= exchange_.end - 1) {
    cycle_ = exchange_.start;
    return true;
  }
  cycle_ = exchange_.end - 1;
  update_attention();
  return false;
}

// An exception has become pending during the exchange.
void Core::notice_in_exchange(unsigned best, Cycle when) {
  if (when >= exchange_.end) return;
  if (pause_ == Pause::entering) {
    if (best == 0 || nvic_.priority(best) >= nvic_.priority(exchange_.number)) return;
    exchange_.number = best;
    exchange_.end = std::max(exchange_.end, when + timing_.tail_chain);
  } else {
    // A higher priority during a return ends the return, and is chained.
    if (!takeable_) return;
    r_[14] = exchange_.value;
    const Cycle since = std::max(when, exchange_.start);
    exchange_ = {best, 0, exchange_.start, since, since + timing_.tail_chain};
    pause_ = Pause::entering;
  }
  cycle_ = exchange_.end - 1;
}

void Core::finish_entry() {
  if (!pass_exchange()) return;
  pause_ = Pause::none;
  unsigned number = exchange_.number;
  std::uint32_t vector = 0;
  // Vectors are read past the MPU (ARMv6-M ARM, B3.5.1).
  Access access = bus_.read(vtor_ + 4 * number, Width::word, master_, cycle_);
  if (access.fault && number != hard_fault_number && execution_priority() > -1) {
    note_fault(FaultKind::hard_fault, FaultCause::vector, vtor_ + 4 * number, r_[14]);
    number = hard_fault_number;
    access = bus_.read(vtor_ + 4 * number, Width::word, master_, cycle_);
  }
  vector = access.value;
  cycle_ = exchange_.end + access.wait;
  nvic_.activate(number);
  ipsr_ = number;
  event_ = true;
  thumb_ = (vector & 1) != 0;
  if (access.fault) return lock_up(FaultCause::vector, vtor_ + 4 * number, r_[14]);
  pc_ = vector & ~1u;
  refresh(cycle_);
  if (listener_ != nullptr) listener_->exception_entered(id_, number, exchange_.since, cycle_);
}

void Core::exception_return(std::uint32_t value) {
  const unsigned returning = ipsr_;
  const bool to_thread = value == return_to_thread_msp || value == return_to_thread_psp;
  const bool nested = nvic_.active_count() > 1;
  if (!nvic_.active(returning) || !(to_thread ? !nested : nested && value == return_to_handler))
    return hard_fault(FaultCause::exception_return, value);
  if (listener_ != nullptr) listener_->exception_left(id_, returning, cycle_);
  nvic_.deactivate(returning);
  refresh(cycle_);
  run_events(cycle_);
  if (takeable_) return chain(nvic_.best(), value, cycle_);
  exchange_ = {0, value, cycle_, cycle_, cycle_ + timing_.exception_return};
  pause_ = Pause::leaving;
  finish_return();
}

void Core::finish_return() {
  if (!pass_exchange()) return;
  if (pause_ == Pause::entering) return finish_entry();
  pause_ = Pause::none;
  const std::uint32_t value = exchange_.value;
  const Cycle end = exchange_.end;
  std::uint32_t waits = 0;
  if (!pop_frame(value, waits)) {
    const std::uint32_t frame = value == return_to_thread_psp ? other_sp_ : r_[13];
    if (execution_priority() <= -1) return lock_up(FaultCause::unstacking, frame, r_[14]);
    note_fault(FaultKind::hard_fault, FaultCause::unstacking, frame, r_[14]);
    return chain(hard_fault_number, value, end);
  }
  cycle_ = end + waits;
  event_ = true;
  refresh(cycle_);
  if (value != return_to_handler && (scr_ & scr_sleep_on_exit) != 0) sleep(Sleep::wfi);
}

void Core::chain(unsigned number, std::uint32_t exc_return, Cycle at) {
  r_[14] = exc_return;
  start_handler(number, at, at + timing_.tail_chain);
}

bool Core::pop_frame(std::uint32_t exc_return, std::uint32_t& waits) {
  const bool psp = exc_return == return_to_thread_psp;
  const std::uint32_t frame = psp ? other_sp_ : r_[13];
  std::array<std::uint32_t, 8> words{};
  const Cycle start = cycle_;
  for (std::uint32_t i = 0; i < words.size(); ++i) {
    cycle_ = start + i + waits;
    const Access access = read_bus(frame + 4 * i, Width::word);
    cycle_ = start;
    if (access.fault) return false;
    words[i] = access.value;
    waits += access.wait;
  }
  const std::uint32_t psr = words[7];
  const unsigned number = psr & psr_exception;
  if ((number != 0) != (exc_return == return_to_handler)) return false;
  const std::uint32_t sp = (frame + frame_size) | ((psr & psr_aligned) != 0 ? frame_align : 0);
  if (psp) {
    other_sp_ = r_[13];
    control_ |= control_spsel;
  }
  r_[13] = sp;
  std::copy_n(words.begin(), 4, r_.begin());
  r_[12] = words[4];
  r_[14] = words[5];
  pc_ = words[6] & ~1u;
  ipsr_ = 0;
  set_xpsr(psr);
  return true;
}

}  // namespace lamplock::sim::chip
