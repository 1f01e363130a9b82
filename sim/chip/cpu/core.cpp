// Instructions of the core (ARMv6-M Architecture Reference Manual, A5 and A6), with the cycles of
// the Cortex-M0+ Technical Reference Manual, table 3-1.
#include "sim/chip/cpu/core.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <utility>

#include "sim/chip/cpu/decode.hpp"
#include "sim/chip/fabric/hex.hpp"

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t sio_nibble = 0xd;  // the single-cycle I/O port: 0xd0000000
// Code is fetched from code, SRAM and external RAM space; the rest is execute-never (B3.1).
constexpr bool executable(std::uint32_t address) {
  return address < 0x4000'0000 || (address >= 0x6000'0000 && address < 0xa000'0000);
}

constexpr std::uint32_t psr_thumb = 1u << 24;

// Fields of an instruction.
constexpr unsigned low_d(unsigned op) { return op & 7; }
constexpr unsigned low_n(unsigned op) { return (op >> 3) & 7; }
constexpr unsigned low_m(unsigned op) { return (op >> 6) & 7; }
constexpr unsigned imm5(unsigned op) { return (op >> 6) & 31; }
constexpr unsigned register8(unsigned op) { return (op >> 8) & 7; }
constexpr unsigned imm8(unsigned op) { return op & 0xff; }
constexpr unsigned high_d(unsigned op) { return (op & 7) | (op >> 4 & 8); }
constexpr unsigned high_m(unsigned op) { return op >> 3 & 15; }
constexpr std::uint32_t sign_extend(std::uint32_t value, unsigned bits) {
  const std::uint32_t sign = 1u << (bits - 1);
  return ((value & ((sign << 1) - 1)) ^ sign) - sign;
}
/// Registers in a list of low ones. (Without an instruction for it std::popcount is a call.)
constexpr std::array<std::uint8_t, 256> list_sizes = [] {
  std::array<std::uint8_t, 256> sizes{};
  for (unsigned list = 0; list < sizes.size(); ++list)
    sizes[list] = static_cast<std::uint8_t>(std::popcount(list));
  return sizes;
}();
/// How far BL branches.
constexpr std::uint32_t link_offset(unsigned first, unsigned second) {
  const std::uint32_t s = first >> 10 & 1u, j1 = second >> 13 & 1u, j2 = second >> 11 & 1u;
  const std::uint32_t i1 = ~(j1 ^ s) & 1u, i2 = ~(j2 ^ s) & 1u;
  return sign_extend(
      (s << 24) | (i1 << 23) | (i2 << 22) | ((first & 0x3ffu) << 12) | ((second & 0x7ffu) << 1),
      25);
}

}  // namespace

Core::Core(int id, Bus& bus, TimeWheel& wheel, IrqLines& irqs, const Timing& timing,
           NotModelled not_modelled)
    : wheel_(wheel),
      irqs_(irqs),
      bus_(bus),
      id_(id),
      master_(id == 0 ? Master::core0 : Master::core1),
      timing_(timing),
      not_modelled_(std::move(not_modelled)),
      systick_(wheel, [this] { systick_expired(); }) {
  bus_.share_code_windows(window_, memory_, pc_);
  bus_.arbiter().attach_flag(static_cast<Requester>(master_), attention_);
}

void Core::reset(std::uint32_t vector_table) {
  r_.fill(0);
  r_[14] = 0xffff'ffff;
  n_ = 0;
  z_ = 1;
  c_ = v_ = false;
  takeable_ = locked_up_ = stop_ = primask_ = event_ = nmi_level_ = false;
  sleep_ = Sleep::awake;
  pause_ = Pause::none;
  ipsr_ = 0;
  control_ = other_sp_ = vtor_ = scr_ = 0;
  mpu_.reset();
  unchecked_end_ = ppb_base;
  nvic_.reset();
  cycle_ = std::max(cycle_, wheel_.now());
  systick_.reset(cycle_);
  forget_code();
  const Access stack = read_bus(vector_table, Width::word);
  const Access entry = read_bus(vector_table + 4, Width::word);
  r_[13] = stack.value & ~3u;
  pc_ = entry.value & ~1u;
  thumb_ = (entry.value & 1) != 0;
  sample(cycle_);
  if (stack.fault || entry.fault) lock_up(FaultCause::vector, vector_table, r_[14]);
}

void Core::set_reg(unsigned number, std::uint32_t value) {
  if (number == 15)
    pc_ = value & ~1u;
  else
    r_[number] = number == 13 ? value & ~3u : value;
}

std::uint32_t Core::xpsr() const {
  return (n_ & (1u << 31)) | (z_ == 0 ? 1u << 30 : 0) | (c_ ? 1u << 29 : 0) | (v_ ? 1u << 28 : 0) |
         (thumb_ ? psr_thumb : 0) | ipsr_;
}

// IPSR between thread and handler changes the stack pointer in use only in entry and return.
void Core::set_xpsr(std::uint32_t value) {
  n_ = value;
  z_ = (value >> 30) & 1 ? 0 : 1;
  c_ = ((value >> 29) & 1) != 0;
  v_ = ((value >> 28) & 1) != 0;
  thumb_ = (value & psr_thumb) != 0;
  ipsr_ = value & 0x3f;
  update_attention();
}

void Core::set_primask(bool masked) {
  if (masked == primask_) return;
  primask_ = masked;
  refresh(never_cycle);
  if (listener_ != nullptr) listener_->masked(id_, masked, cycle_);
}

void Core::set_control(std::uint32_t value) {
  const bool before = uses_psp();
  control_ = ipsr_ == 0 ? value & (control_npriv | control_spsel) : value & control_npriv;
  if (uses_psp() != before) std::swap(r_[13], other_sp_);
}

void Core::set_nmi_mask(std::uint32_t mask) {
  nmi_mask_ = mask;
  sample(cycle_);
}

std::vector<Core::NativeRange>::const_iterator Core::native_above(std::uint32_t address) const {
  return std::upper_bound(
      natives_.begin(), natives_.end(), address,
      [](std::uint32_t at, const NativeRange& range) { return at < range.first; });
}

void Core::add_native(std::uint32_t first, std::uint32_t last, NativeFunction function) {
  natives_.insert(native_above(first), {first, last, std::move(function)});
  forget_code();
}

// --- Fetch ---------------------------------------------------------------------------------------

// Fetches an instruction outside the window: another region, a native function, or no memory at
// all. Empty: something other than an instruction took place.
std::optional<std::uint16_t> Core::fetch_outside(std::uint32_t pc) {
  if (const auto instruction = fetch_from_memory(pc)) return instruction;
  const auto above = native_above(pc);
  if (above != natives_.begin() && pc <= std::prev(above)->last) {
    call_native(std::prev(above)->function);
    return std::nullopt;
  }
  return fetch_code(pc);
}

// Fetches beyond the present window.
std::optional<std::uint16_t> Core::fetch_code(std::uint32_t pc) {
  const bool refused = mpu_.enabled() && !permits(pc, MpuAccess::fetch);
  if (!executable(pc) || refused) {
    window_.size = 0;
    hard_fault(refused ? FaultCause::refused_by_mpu : FaultCause::failed_fetch, pc);
    return std::nullopt;
  }
  // Regions of the MPU are larger than a word, which is fetched, and permitted, as one.
  if (mpu_.enabled()) return fetch_word(pc);
  if (bus_.contended()) {
    memory_ = bus_.memory_code_at(pc);
    if (memory_.size != 0) cut_natives(pc, memory_);
    if (const auto instruction = fetch_from_memory(pc)) return instruction;
  }
  window_ = bus_.code_at(pc);
  if (window_.size == 0) return fetch_word(pc);
  std::uint16_t instruction;
  std::memcpy(&instruction, window_.bytes + (pc - window_.first), sizeof instruction);
  cut_natives(pc, window_);
  return instruction;
}

// Where ROM or SRAM is contended: one word at a time, in the cycle in which the core reaches it.
// Empty: it is not the memory in which words were fetched last.
std::optional<std::uint16_t> Core::fetch_from_memory(std::uint32_t pc) {
  const std::uint32_t word = (pc & ~3u) - memory_.first;
  if (word >= memory_.size || memory_.size - word < 4) return std::nullopt;
  if (bus_.contended()) {
    cycle_ += bus_.fetch_wait(pc, master_, cycle_);
    window_ = {memory_.bytes + word, pc & ~3u, 4};
  } else {
    window_ = memory_;
  }
  std::uint16_t instruction;
  std::memcpy(&instruction, memory_.bytes + word + (pc & 2), sizeof instruction);
  return instruction;
}

// The memory map or the permission to fetch has changed.
void Core::forget_code() { window_.size = memory_.size = 0; }

// Leaves the part of the window around pc that has no native function in it.
void Core::cut_natives(std::uint32_t pc, Bus::CodeWindow& window) const {
  const auto above = native_above(pc);
  if (above != natives_.begin() && std::prev(above)->last + 2 > window.first) {
    const std::uint32_t cut = std::prev(above)->last + 2 - window.first;
    window = {window.bytes + cut, window.first + cut, window.size - cut};
  }
  if (above != natives_.end() && above->first - window.first < window.size)
    window.size = above->first - window.first;
}

// Code that is not plain memory is fetched as the core does it: one word at a time, with two
// instructions in it. The core waits for a word when it reaches it; the hardware's request up to
// two cycles earlier, while an instruction runs, is not modelled.
std::optional<std::uint16_t> Core::fetch_word(std::uint32_t pc) {
  const Access access = bus_.fetch(pc & ~3u, master_, cycle_);
  if (access.fault) {
    window_.size = 0;
    hard_fault(FaultCause::failed_fetch, pc);
    return std::nullopt;
  }
  cycle_ += access.wait;
  std::memcpy(fetched_.data(), &access.value, fetched_.size());
  window_ = {fetched_.data(), pc & ~3u, 4};
  cut_natives(pc, window_);
  return static_cast<std::uint16_t>(access.value >> (8 * (pc & 2)));
}

std::optional<std::uint16_t> Core::fetch_second(std::uint32_t pc) {
  const std::uint32_t place = pc - window_.first;
  if (place < window_.size) {
    std::uint16_t instruction;
    std::memcpy(&instruction, window_.bytes + place, sizeof instruction);
    return instruction;
  }
  if (const auto instruction = fetch_from_memory(pc)) return instruction;
  return fetch_code(pc);
}

void Core::call_native(const NativeFunction& function) {
  const Native result = function(*this, pc_);
  cycle_ += result.cycles;
  if (result.then == Then::returns) branch_exchange(r_[14]);
}

// --- Access --------------------------------------------------------------------------------------

Access Core::read_bus(std::uint32_t address, Width width) {
  if (address < unchecked_end_) [[likely]]
    return bus_.read(address, width, master_, cycle_);
  return read_checked(address, width);
}

Access Core::read_checked(std::uint32_t address, Width width) {
  if (address < ppb_base) {
    if (!permits(address, MpuAccess::read)) return {0, 0, true};
    return bus_.read(address, width, master_, cycle_);
  }
  // The registers in the core are words only.
  Access access;
  access.fault = width != Width::word || !read_system(address, access.value);
  return access;
}

Access Core::write_bus(std::uint32_t address, Width width, std::uint32_t value) {
  if (address < unchecked_end_) [[likely]]
    return bus_.write(address, value, width, master_, cycle_);
  return write_checked(address, width, value);
}

Access Core::write_checked(std::uint32_t address, Width width, std::uint32_t value) {
  if (address < ppb_base) {
    if (!permits(address, MpuAccess::write)) return {0, 0, true};
    return bus_.write(address, value, width, master_, cycle_);
  }
  Access access;
  access.fault = width != Width::word || !write_system(address, value);
  return access;
}

bool Core::permits(std::uint32_t address, MpuAccess access) const {
  return mpu_.permits(address, access, privileged(), execution_priority() < 0);
}

// The cause is searched after the access has failed, so that a successful access costs nothing
// more.
bool Core::access_fault(std::uint32_t address, Width width, MpuAccess kind) {
  FaultCause cause = kind == MpuAccess::write ? FaultCause::failed_write : FaultCause::failed_read;
  if ((address & (static_cast<std::uint32_t>(width) - 1)) != 0)
    cause = FaultCause::unaligned_access;
  else if (address < ppb_base && mpu_.enabled() && !permits(address, kind))
    cause = FaultCause::refused_by_mpu;
  hard_fault(cause, address);
  return false;
}

// Adds the cost of a load or store beyond one cycle: 1, but 0 on the I/O port. False: it faulted.
inline bool Core::complete(std::uint32_t address, Width width, MpuAccess kind,
                           const Access& access) {
  if (access.fault) [[unlikely]]
    return access_fault(address, width, kind);
  cycle_ += access.wait + ((address >> 28) != sio_nibble ? 1u : 0u);
  return true;
}

bool Core::load(std::uint32_t address, Width width, std::uint32_t& value) {
  Access access{0, 0, true};
  if ((address & (static_cast<std::uint32_t>(width) - 1)) == 0) [[likely]]
    access = read_bus(address, width);
  if (!complete(address, width, MpuAccess::read, access)) return false;
  value = access.value;
  return true;
}

bool Core::store(std::uint32_t address, Width width, std::uint32_t value) {
  Access access{0, 0, true};
  if ((address & (static_cast<std::uint32_t>(width) - 1)) == 0) [[likely]]
    access = write_bus(address, width, value);
  return complete(address, width, MpuAccess::write, access);
}

// Fast path between two words of a multiple access: usually nothing interrupts it.
inline bool Core::word_may_begin(unsigned word) {
  if (other_ == nullptr && wheel_.next() > cycle_ && irqs_.changes() == seen_changes_ && !takeable_)
      [[likely]]
    return true;
  return !pause_or_abandon(word);
}

// An interrupt abandons the instruction, which starts again after the handler. Interrupts are
// checked only when the other core has reached the same cycle.
[[gnu::noinline]] bool Core::pause_or_abandon(unsigned word) {
  if (!waits()) {
    notice_access();
    run_events(cycle_);
    if (!waits()) return takeable_;
  }
  multiple_.next = word;
  pause_ = Pause::words;
  update_attention();
  return true;
}

// The first word that is not done, of an instruction that begins or continues.
inline unsigned Core::begin_words(std::uint16_t instruction) {
  if (pause_ != Pause::words) {
    multiple_.instruction = instruction;
    return 0;
  }
  pause_ = Pause::none;
  update_attention();
  return multiple_.next;
}

// The words of a multiple access from `first` on, one after the other. False: it faulted, pauses or
// was abandoned.
template <class Transfer>
inline bool Core::each_word(std::uint32_t address, unsigned first, unsigned count, MpuAccess kind,
                            const Transfer& transfer) {
  for (unsigned i = first; i < count; ++i) {
    if (i != 0 && !word_may_begin(i)) return false;
    const Access access = (address & 3) == 0 ? transfer(address + 4 * i, i) : Access{0, 0, true};
    if (access.fault) return access_fault(address + 4 * i, Width::word, kind);
    cycle_ += 1 + access.wait;
  }
  return true;
}

bool Core::load_block(std::uint32_t address, unsigned first, unsigned count) {
  return each_word(address, first, count, MpuAccess::read, [&](std::uint32_t at, unsigned i) {
    const Access access = read_bus(at, Width::word);
    multiple_.words[i] = access.value;
    return access;
  });
}

bool Core::store_block(std::uint32_t address, unsigned first, unsigned count, const Words& words) {
  return each_word(address, first, count, MpuAccess::write, [&](std::uint32_t at, unsigned i) {
    return write_bus(at, Width::word, words[i]);
  });
}

// --- Multiple accesses: 1 + N cycles, the N counted by the blocks --------------------------------

// Low registers of a list, lowest first, to and from words; how many there are.
unsigned Core::gather(unsigned list, Words& words) const {
  unsigned next = 0;
  for (unsigned i = 0; i < 8; ++i)
    if ((list >> i & 1) != 0) words[next++] = r_[i];
  return next;
}

unsigned Core::scatter(unsigned list, const Words& words) {
  unsigned next = 0;
  for (unsigned i = 0; i < 8; ++i)
    if ((list >> i & 1) != 0) r_[i] = words[next++];
  return next;
}

// The same for words in memory, without the bus; returns the end of the words.
inline std::uint8_t* Core::put(unsigned list, std::uint8_t* words) const {
  for (const std::uint32_t* from = r_.data(); list != 0; list >>= 1, ++from) {
    if ((list & 1) == 0) continue;
    std::memcpy(words, from, 4);
    words += 4;
  }
  return words;
}

inline void Core::take(unsigned list, const std::uint8_t* words) {
  for (std::uint32_t* to = r_.data(); list != 0; list >>= 1, ++to) {
    if ((list & 1) == 0) continue;
    std::memcpy(to, words, 4);
    words += 4;
  }
}

bool Core::load_multiple(std::uint16_t op) {
  const unsigned list = imm8(op), base = register8(op);
  if (list == 0) return unpredictable(op);
  const auto count = static_cast<unsigned>(std::popcount(list));
  const std::uint32_t address = r_[base];
  if (!load_block(address, begin_words(op), count)) return false;
  r_[base] = address + 4 * count;
  scatter(list, multiple_.words);
  return true;
}

bool Core::store_multiple(std::uint16_t op) {
  const unsigned list = imm8(op), base = register8(op);
  if (list == 0) return unpredictable(op);
  Words words;
  const unsigned count = gather(list, words);
  const std::uint32_t address = r_[base];
  if (!store_block(address, begin_words(op), count, words)) return false;
  r_[base] = address + 4 * count;
  return true;
}

bool Core::push(std::uint16_t op) {
  const unsigned list = op & 0x1ff;
  if (list == 0) return unpredictable(op);
  Words words;
  unsigned count = gather(list, words);
  if ((list & 0x100) != 0) words[count++] = r_[14];
  const std::uint32_t address = r_[13] - 4 * count;
  if (!store_block(address, begin_words(op), count, words)) return false;
  r_[13] = address;
  return true;
}

// Sets the program counter itself: POP {..., PC} is a branch. Its own cycle comes before the words,
// so that at most the two of the branch remain when it can no longer be abandoned.
void Core::pop(std::uint16_t op) {
  const unsigned list = op & 0x1ff;
  if (list == 0) {
    unpredictable(op);
    return;
  }
  const auto count = static_cast<unsigned>(std::popcount(list));
  if (pause_ != Pause::words) cycle_ += 1;
  const unsigned first = begin_words(op);
  if ((first == 0 && !word_may_begin(0)) || !load_block(r_[13], first, count)) return;
  r_[13] += 4 * count;
  const unsigned next = scatter(list, multiple_.words);
  if ((list & 0x100) == 0)
    pc_ += 2;
  else
    branch_exchange(multiple_.words[next]);
}

// --- Branches ------------------------------------------------------------------------------------

// BX, POP: two cycles, or a return from an exception.
void Core::branch_exchange(std::uint32_t target) {
  if (ipsr_ != 0 && (target >> 28) == 15) return exception_return(target);
  cycle_ += 2;
  pc_ = target & ~1u;
  if ((target & 1) == 0) {
    thumb_ = false;
    update_attention();
  }
  if (listener_ != nullptr) listener_->branched(id_, pc_, cycle_);
}

inline bool Core::condition(unsigned code) const {
  const bool n = (n_ >> 31) != 0, z = z_ == 0;
  bool met = false;
  switch (code >> 1) {
    case 0:
      met = z;
      break;
    case 1:
      met = c_;
      break;
    case 2:
      met = n;
      break;
    case 3:
      met = v_;
      break;
    case 4:
      met = c_ && !z;
      break;
    case 5:
      met = n == v_;
      break;
    default:
      met = n == v_ && !z;
      break;
  }
  return met != ((code & 1) != 0);
}

// --- Shifts by register: amounts 0..255 ----------------------------------------------------------

std::uint32_t Core::shift_left(std::uint32_t value, std::uint32_t amount) {
  if (amount == 0) return value;
  c_ = amount <= 32 && (value >> (32 - amount) & 1) != 0;
  return amount < 32 ? value << amount : 0;
}

std::uint32_t Core::shift_right(std::uint32_t value, std::uint32_t amount) {
  if (amount == 0) return value;
  c_ = amount <= 32 && (value >> (amount - 1) & 1) != 0;
  return amount < 32 ? value >> amount : 0;
}

std::uint32_t Core::shift_right_signed(std::uint32_t value, std::uint32_t amount) {
  if (amount == 0) return value;
  const unsigned capped = amount < 32 ? amount : 32;
  c_ = (value >> (capped - 1) & 1) != 0;
  const auto sign = static_cast<std::uint32_t>(-static_cast<std::int32_t>(value >> 31));
  return capped < 32 ? (value >> capped) | (sign << (32 - capped)) : sign;
}

std::uint32_t Core::rotate_right(std::uint32_t value, std::uint32_t amount) {
  if (amount == 0) return value;
  const std::uint32_t result = std::rotr(value, static_cast<int>(amount & 31));
  c_ = (result >> 31) != 0;
  return result;
}

// --- Faulting and rare instructions --------------------------------------------------------------

bool Core::undefined(FaultCause cause) {
  hard_fault(cause);
  return false;
}

bool Core::unpredictable(std::uint16_t instruction) {
  if (not_modelled_)
    not_modelled_("unpredictable instruction " + hex(instruction, 4) + " executed");
  return undefined(FaultCause::unpredictable_instruction);
}

// BX, BLX.
void Core::execute_exchange(std::uint16_t op) {
  const bool link = decode(op) == Op::blx;
  const unsigned m = high_m(op);
  if ((op & 7) != 0 || (link && m == 15)) {
    unpredictable(op);
    return;
  }
  const std::uint32_t target = m == 15 ? pc_ + 4 : r_[m];
  if (!link) return branch_exchange(target);
  const std::uint32_t from = pc_;
  r_[14] = (pc_ + 2) | 1;
  pc_ = target & ~1u;
  cycle_ += 2;
  thumb_ = (target & 1) != 0;
  update_attention();
  if (listener_ != nullptr) listener_->called(id_, from, pc_, cycle_);
}

// ADD and MOV with the program counter as an operand, and those that must not have it.
void Core::execute_high(std::uint16_t op) {
  const unsigned d = high_d(op), m = high_m(op);
  const std::uint32_t right = m == 15 ? pc_ + 4 : r_[m];
  const std::uint32_t left = d == 15 ? pc_ + 4 : r_[d];
  const Op kind = decode(op);
  if (kind == Op::cmp_high || (kind == Op::add_high && d == 15 && m == 15)) {
    unpredictable(op);
    return;
  }
  const std::uint32_t result = kind == Op::add_high ? left + right : right;
  if (d != 15) {
    r_[d] = d == 13 ? result & ~3u : result;
    pc_ += 2;
    cycle_ += 1;
    return;
  }
  pc_ = result & ~1u;
  cycle_ += 2;
  if (listener_ != nullptr) listener_->branched(id_, pc_, cycle_);
}

void Core::execute_hint(std::uint16_t op) {
  if ((op & 15) != 0) return hard_fault(FaultCause::undefined_instruction);  // IT of ARMv7-M
  Cycle cycles = 1;
  switch (op >> 4 & 15) {
    case 2:  // WFE
      cycles = 2;
      if (event_)
        event_ = false;
      else
        sleep(Sleep::wfe);
      break;
    case 3:  // WFI
      cycles = 2;
      sleep(Sleep::wfi);
      break;
    case 4:  // SEV
      event_ = true;
      if (on_event) on_event();
      break;
    default:  // NOP, YIELD and hints to come
      break;
  }
  pc_ += 2;
  cycle_ += cycles;
}

// MRS, MSR, barriers: three cycles each. False: it faulted.
bool Core::execute_wide(std::uint16_t first, std::uint16_t second) {
  if ((second & 0xd000) != 0x8000) return undefined();
  const unsigned control = first >> 4 & 0x7fu;
  const bool reserved = (second & 0x2000) != 0;
  if ((control & 0x7e) == 0x38)
    return reserved || (first & 0x10) != 0 || (second & 0xff00) != 0x8800
               ? unpredictable(first)
               : execute_msr(first, second);
  if ((control & 0x7e) == 0x3e)
    return reserved || first != 0xf3ef ? unpredictable(first) : execute_mrs(second);
  if (control == 0x3b) {
    const unsigned barrier = second >> 4 & 15u;  // 4 DSB, 5 DMB, 6 ISB
    if (barrier < 4 || barrier > 6) return undefined();
    return reserved || first != 0xf3bf || (second & 0x0f00) != 0x0f00 ? unpredictable(first) : true;
  }
  return undefined();
}

bool Core::execute_mrs(std::uint16_t second) {
  const unsigned d = second >> 8 & 15u, special = second & 0xffu;
  if (d == 13 || d == 15) return unpredictable(second);
  std::uint32_t value = 0;
  switch (special) {
    case 0:
    case 1:
    case 2:
    case 3:  // APSR, with IPSR if bit 0 is set; EPSR reads zero
      value = xpsr() & 0xf000'0000;
      [[fallthrough]];
    case 5:
    case 6:
    case 7:
      if ((special & 1) != 0) value |= ipsr_;
      break;
    case 8:
      value = privileged() ? msp() : 0;
      break;
    case 9:
      value = privileged() ? psp() : 0;
      break;
    case 16:
      value = privileged() && primask_ ? 1 : 0;
      break;
    case 20:
      value = control_;
      break;
    default:
      return unpredictable(second);
  }
  r_[d] = value;
  return true;
}

bool Core::execute_msr(std::uint16_t first, std::uint16_t second) {
  const unsigned n = first & 15u, special = second & 0xffu;
  if (n == 13 || n == 15) return unpredictable(first);
  const std::uint32_t value = r_[n];
  switch (special) {
    case 0:
    case 1:
    case 2:
    case 3:
      set_xpsr((value & 0xf000'0000) | (xpsr() & 0x0fff'ffff));
      break;
    case 5:
    case 6:
    case 7:
      break;  // IPSR and EPSR cannot be written
    case 8:
      if (privileged()) set_msp(value);
      break;
    case 9:
      if (privileged()) set_psp(value);
      break;
    case 16:
      if (privileged()) set_primask((value & 1) != 0);
      break;
    case 20:
      if (privileged()) set_control(value);
      break;
    default:
      return unpredictable(second);
  }
  return true;
}

// --- One instruction after the other -------------------------------------------------------------

// Executes instructions from pc_ on: at least one, more while the time is before `until`, when an
// event is due or the other core's turn begins. Time and program counter are in `cycle` and `pc`.
// That is the only check between two instructions as long as they touch only the core's registers
// and plain memory. Any other instruction, which may read the state of the core, change interrupt
// lines or the code window, calls leave() first and is the last one of this call.
//
// A switch over all instructions: long, but each case is a line of the manual. An instruction that
// faults, sleeps or returns from an exception has moved the program counter itself and returns.
void Core::execute(Cycle until) {
  std::uint32_t pc = pc_;
  Cycle cycle = cycle_;
  const Bus::CodeWindow window = window_;
  const auto leave = [&]() __attribute__((always_inline)) {
    pc_ = pc;
    cycle_ = cycle;
    until = 0;
  };
  do {
    const std::uint32_t place = pc - window.first;
    std::uint16_t op = 0;
    if (place < window.size) [[likely]] {
      std::memcpy(&op, window.bytes + place, sizeof op);
    } else {
      leave();
      const std::optional<std::uint16_t> fetched = fetch_outside(pc);
      if (!fetched) return;
      op = *fetched;
      cycle = cycle_;
    }
    std::uint32_t next = pc + 2;
    std::uint32_t cycles = 1;
    const auto arithmetic = [&](std::uint32_t left, std::uint32_t right, bool carry) {
      r_[low_d(op)] = add_with_carry(left, right, carry);
    };
    const auto logic = [&](std::uint32_t result) {
      r_[low_d(op)] = result;
      set_nz(result);
    };
    // A branch by register that is neither an exception return nor a fault, and has no listener.
    const auto stays_inside = [&](std::uint32_t target) {
      return (target & 1) != 0 && (target >> 28) != 15 && listener_ == nullptr;
    };
    // False: it faulted.
    const auto load_to = [&](unsigned target, std::uint32_t address, Width width)
        __attribute__((always_inline)) {
      if (address < unchecked_end_ && bus_.load_plain(address, width, r_[target])) [[likely]] {
        cycles = 2;
        return true;
      }
      leave();
      const bool done = load(address, width, r_[target]);
      cycle = cycle_;
      return done;
    };
    const auto store_from = [&](unsigned source, std::uint32_t address, Width width)
        __attribute__((always_inline)) {
      if (address < unchecked_end_ && bus_.store_plain(address, width, r_[source])) [[likely]] {
        cycles = 2;
        return true;
      }
      leave();
      const bool done = store(address, width, r_[source]);
      cycle = cycle_;
      return done;
    };
    // The words of a multiple access, if they are in plain memory and nothing is due before the
    // last one; else null.
    const auto words_at = [&](std::uint32_t address, unsigned count, bool to_write)
        __attribute__((always_inline)) {
      const bool alone = cycle + count < until && address < unchecked_end_;
      return alone ? bus_.plain_words(address, count, to_write) : nullptr;
    };
    const auto d = [&] { return r_[low_d(op)]; };
    const auto n = [&] { return r_[low_n(op)]; };
    const auto m = [&] { return r_[low_m(op)]; };
    const unsigned top = register8(op);
    const Op kind = decode(op);
    switch (kind) {
      // Shift, add, subtract, move, compare
      case Op::lsl_imm:
        logic(shift_left(n(), imm5(op)));
        break;
      case Op::lsr_imm:
        logic(shift_right(n(), imm5(op) == 0 ? 32 : imm5(op)));
        break;
      case Op::asr_imm:
        logic(shift_right_signed(n(), imm5(op) == 0 ? 32 : imm5(op)));
        break;
      case Op::add_reg:
        arithmetic(n(), m(), false);
        break;
      case Op::sub_reg:
        arithmetic(n(), ~m(), true);
        break;
      case Op::add_imm3:
        arithmetic(n(), low_m(op), false);
        break;
      case Op::sub_imm3:
        arithmetic(n(), ~low_m(op), true);
        break;
      case Op::mov_imm:
        r_[top] = imm8(op);
        set_nz(imm8(op));
        break;
      case Op::cmp_imm:
        add_with_carry(r_[top], ~imm8(op), true);
        break;
      case Op::add_imm8:
        r_[top] = add_with_carry(r_[top], imm8(op), false);
        break;
      case Op::sub_imm8:
        r_[top] = add_with_carry(r_[top], ~imm8(op), true);
        break;
      // Data processing on two registers
      case Op::and_reg:
        logic(d() & n());
        break;
      case Op::eor_reg:
        logic(d() ^ n());
        break;
      case Op::lsl_reg:
        logic(shift_left(d(), n() & 0xff));
        break;
      case Op::lsr_reg:
        logic(shift_right(d(), n() & 0xff));
        break;
      case Op::asr_reg:
        logic(shift_right_signed(d(), n() & 0xff));
        break;
      case Op::adc_reg:
        arithmetic(d(), n(), c_);
        break;
      case Op::sbc_reg:
        arithmetic(d(), ~n(), c_);
        break;
      case Op::ror_reg:
        logic(rotate_right(d(), n() & 0xff));
        break;
      case Op::tst_reg:
        set_nz(d() & n());
        break;
      case Op::rsb_imm:
        arithmetic(~n(), 0, true);
        break;
      case Op::cmp_reg:
        add_with_carry(d(), ~n(), true);
        break;
      case Op::cmn_reg:
        add_with_carry(d(), n(), false);
        break;
      case Op::orr_reg:
        logic(d() | n());
        break;
      case Op::mul_reg:
        logic(d() * n());
        break;
      case Op::bic_reg:
        logic(d() & ~n());
        break;
      case Op::mvn_reg:
        logic(~n());
        break;
      // High registers and branch exchange
      case Op::add_high:
      case Op::cmp_high:
      case Op::mov_high: {
        const unsigned high = high_d(op), other = high_m(op);
        if (high == 15 || other == 15 || (kind == Op::cmp_high && high < 8 && other < 8)) {
          leave();
          return execute_high(op);
        }
        if (kind == Op::cmp_high) {
          add_with_carry(r_[high], ~r_[other], true);
        } else {
          const std::uint32_t result = r_[other] + (kind == Op::add_high ? r_[high] : 0);
          r_[high] = high == 13 ? result & ~3u : result;
        }
        break;
      }
      case Op::bx:
      case Op::blx: {
        const unsigned other = high_m(op);
        const std::uint32_t target = other == 15 ? pc + 4 : r_[other];
        cycles = 2;
        if ((op & 7) == 0 && other != 15 && stays_inside(target)) [[likely]] {
          if (kind == Op::blx) r_[14] = next | 1;
          next = target & ~1u;
          break;
        }
        leave();
        return execute_exchange(op);
      }
      // Loads and stores
      case Op::ldr_literal:
        if (!load_to(top, ((pc + 4) & ~3u) + 4 * imm8(op), Width::word)) return;
        break;
      case Op::str_reg:
        if (!store_from(low_d(op), n() + m(), Width::word)) return;
        break;
      case Op::strh_reg:
        if (!store_from(low_d(op), n() + m(), Width::half)) return;
        break;
      case Op::strb_reg:
        if (!store_from(low_d(op), n() + m(), Width::byte)) return;
        break;
      case Op::ldrsb_reg:
        if (!load_to(low_d(op), n() + m(), Width::byte)) return;
        r_[low_d(op)] = sign_extend(r_[low_d(op)], 8);
        break;
      case Op::ldr_reg:
        if (!load_to(low_d(op), n() + m(), Width::word)) return;
        break;
      case Op::ldrh_reg:
        if (!load_to(low_d(op), n() + m(), Width::half)) return;
        break;
      case Op::ldrb_reg:
        if (!load_to(low_d(op), n() + m(), Width::byte)) return;
        break;
      case Op::ldrsh_reg:
        if (!load_to(low_d(op), n() + m(), Width::half)) return;
        r_[low_d(op)] = sign_extend(r_[low_d(op)], 16);
        break;
      case Op::str_imm:
        if (!store_from(low_d(op), n() + 4 * imm5(op), Width::word)) return;
        break;
      case Op::ldr_imm:
        if (!load_to(low_d(op), n() + 4 * imm5(op), Width::word)) return;
        break;
      case Op::strb_imm:
        if (!store_from(low_d(op), n() + imm5(op), Width::byte)) return;
        break;
      case Op::ldrb_imm:
        if (!load_to(low_d(op), n() + imm5(op), Width::byte)) return;
        break;
      case Op::strh_imm:
        if (!store_from(low_d(op), n() + 2 * imm5(op), Width::half)) return;
        break;
      case Op::ldrh_imm:
        if (!load_to(low_d(op), n() + 2 * imm5(op), Width::half)) return;
        break;
      case Op::str_sp:
        if (!store_from(top, r_[13] + 4 * imm8(op), Width::word)) return;
        break;
      case Op::ldr_sp:
        if (!load_to(top, r_[13] + 4 * imm8(op), Width::word)) return;
        break;
      // Addresses, extension, stack
      case Op::adr:
        r_[top] = ((pc + 4) & ~3u) + 4 * imm8(op);
        break;
      case Op::add_sp_imm8:
        r_[top] = r_[13] + 4 * imm8(op);
        break;
      case Op::add_sp:
        r_[13] += 4 * (op & 0x7fu);
        break;
      case Op::sub_sp:
        r_[13] -= 4 * (op & 0x7fu);
        break;
      case Op::sxth:
        r_[low_d(op)] = sign_extend(n(), 16);
        break;
      case Op::sxtb:
        r_[low_d(op)] = sign_extend(n(), 8);
        break;
      case Op::uxth:
        r_[low_d(op)] = n() & 0xffff;
        break;
      case Op::uxtb:
        r_[low_d(op)] = n() & 0xff;
        break;
      case Op::push: {
        const unsigned link = op >> 8 & 1u, count = list_sizes[imm8(op)] + link;
        const std::uint32_t address = r_[13] - 4 * count;
        if (std::uint8_t* words = words_at(address, count, true); words != nullptr && count != 0) {
          words = put(imm8(op), words);
          if (link != 0) std::memcpy(words, &r_[14], 4);
          r_[13] = address;
          cycles = 1 + count;
          break;
        }
        leave();
        if (!push(op)) return;
        cycle = cycle_;
        break;
      }
      case Op::pop: {
        const unsigned branches = op >> 8 & 1u, count = list_sizes[imm8(op)] + branches;
        const std::uint8_t* words = words_at(r_[13], count, false);
        std::uint32_t target = 1;
        if (branches != 0 && words != nullptr) std::memcpy(&target, words + 4 * (count - 1), 4);
        if (words == nullptr || count == 0 || !stays_inside(target)) {
          leave();
          return pop(op);
        }
        take(imm8(op), words);
        r_[13] += 4 * count;
        cycles = 1 + count;
        if (branches != 0) {
          next = target & ~1u;
          cycles += 2;
        }
        break;
      }
      case Op::stm: {
        const unsigned count = list_sizes[imm8(op)];
        std::uint8_t* words = words_at(r_[top], count, true);
        if (words != nullptr && count != 0) {
          put(imm8(op), words);
          r_[top] += 4 * count;
          cycles = 1 + count;
          break;
        }
        leave();
        if (!store_multiple(op)) return;
        cycle = cycle_;
        break;
      }
      case Op::ldm: {
        const unsigned count = list_sizes[imm8(op)];
        const std::uint32_t after = r_[top] + 4 * count;
        const std::uint8_t* words = words_at(r_[top], count, false);
        if (words != nullptr && count != 0) {
          r_[top] = after;
          take(imm8(op), words);
          cycles = 1 + count;
          break;
        }
        leave();
        if (!load_multiple(op)) return;
        cycle = cycle_;
        break;
      }
      case Op::rev:
        r_[low_d(op)] = (n() << 24) | ((n() & 0xff00) << 8) | ((n() >> 8) & 0xff00) | (n() >> 24);
        break;
      case Op::rev16:
        r_[low_d(op)] = ((n() & 0x00ff'00ff) << 8) | ((n() >> 8) & 0x00ff'00ff);
        break;
      case Op::revsh:
        r_[low_d(op)] = sign_extend(((n() & 0xff) << 8) | ((n() >> 8) & 0xff), 16);
        break;
      // System
      case Op::cps:
        leave();
        if ((op & 0xffef) != 0xb662) {
          (op & 0xffe0) == 0xb660 ? unpredictable(op) : undefined();
          return;
        }
        if (privileged()) set_primask((op & 0x10) != 0);
        break;
      case Op::hint:
        leave();
        return execute_hint(op);
      case Op::bkpt:
        leave();
        if (on_breakpoint && on_breakpoint()) return;
        // Without a debugger it is escalated (ARMv6-M, C1.6.1).
        return hard_fault(FaultCause::breakpoint);
      case Op::undefined:
        leave();
        return hard_fault(FaultCause::undefined_instruction);
      case Op::svc:
        leave();
        return supervisor_call(next);
      // Branches
      case Op::b_eq:
      case Op::b_ne:
      case Op::b_cs:
      case Op::b_cc:
      case Op::b_mi:
      case Op::b_pl:
      case Op::b_vs:
      case Op::b_vc:
      case Op::b_hi:
      case Op::b_ls:
      case Op::b_ge:
      case Op::b_lt:
      case Op::b_gt:
      case Op::b_le:
        if (condition(op >> 8 & 15u)) {
          next = pc + 4 + sign_extend((op & 0xffu) << 1, 9);
          cycles = 2;
        }
        break;
      case Op::b:
        next = pc + 4 + sign_extend((op & 0x7ffu) << 1, 12);
        cycles = 2;
        break;
      case Op::wide: {
        std::uint16_t second = 0;
        if (place + 2 < window.size) [[likely]] {
          std::memcpy(&second, window.bytes + place + 2, sizeof second);
        } else {
          leave();
          const std::optional<std::uint16_t> fetched = fetch_second(pc + 2);
          if (!fetched) return;
          second = *fetched;
          cycle = cycle_;
        }
        next = pc + 4;
        cycles = 3;
        if ((second & 0xd000) == 0xd000) {  // BL
          r_[14] = next | 1;
          next += link_offset(op, second);
          if (listener_ == nullptr) [[likely]]
            break;
          leave();
          listener_->called(id_, pc, next, cycle + cycles);
        } else {
          leave();
          if (!execute_wide(op, second)) return;
        }
        break;
      }
    }
    pc = next;
    cycle += cycles;
  } while (cycle < until);
  pc_ = pc;
  cycle_ = cycle;
}

// --- Many instructions ---------------------------------------------------------------------------

// One repayment may be followed by another: the master that goes first may do so repeatedly.
void Core::give_back() {
  if (!bus_.contended() && !owes()) return;
  run_events(cycle_);
  while (owes()) {
    cycle_ += bus_.arbiter().take_owed(static_cast<Requester>(master_));
    run_events(cycle_);
  }
  update_attention();
}

void Core::resume() {
  switch (pause_) {
    case Pause::none:
      break;
    case Pause::words:
      return resume_words();
    case Pause::entering:
      return finish_entry();
    case Pause::leaving:
      return finish_return();
  }
}

void Core::resume_words() {
  const std::uint16_t op = multiple_.instruction;
  switch (decode(op)) {
    case Op::pop:
      return pop(op);
    case Op::push:
      if (!push(op)) return;
      break;
    case Op::stm:
      if (!store_multiple(op)) return;
      break;
    default:
      if (!load_multiple(op)) return;
      break;
  }
  pc_ += 2;
  cycle_ += 1;
}

Cycle Core::step() {
  const Cycle start = cycle_;
  // A stop requested earlier has been handled; one requested from now on ends the step before the
  // instruction: a core that is reset executes no more.
  if (stop_) {
    stop_ = false;
    update_attention();
  }
  give_back();
  if (waits() || stop_) return cycle_ - start;
  if (pause_ != Pause::none)
    resume();
  else if (attention_needed() && attend())
    return cycle_ - start;
  else
    execute(0);
  notice_access();
  return cycle_ - start;
}

void Core::run_until(Cycle limit) {
  if (irqs_.changes() != seen_changes_) run_events(cycle_);
  give_back();
  while (cycle_ < limit) {
    if (attention_needed()) [[unlikely]] {
      notice_access();
      run_events(cycle_);
      give_back();
      if (attention_) {
        if (stop_) break;
        if (pause_ != Pause::none) {
          resume();
          continue;
        }
        if (idle()) {
          idle_to(limit);
          continue;
        }
        if (attend()) continue;
      }
    }
    execute(undisturbed_until(limit));
  }
  notice_access();
  stop_ = false;
  other_ = nullptr;
  update_attention();
}

// The same steps as step() makes, one core's after the other's.
void Core::run_two(Core& first, Core& second, Cycle limit) {
  first.other_ = &second;
  second.other_ = &first;
  for (;;) {
    Core& core = first.cycle_ <= second.cycle_ ? first : second;
    if (core.cycle_ >= limit) break;
    if (core.attention_needed()) [[unlikely]] {
      core.step();
    } else {
      core.execute(0);
      core.notice_access();
    }
    // A stop, falling asleep, or waking the other core so that it must be checked sets attention_.
    if (core.attention_ && (core.stop_ || core.idle())) [[unlikely]]
      break;
  }
  first.other_ = second.other_ = nullptr;
}

}  // namespace lamplock::sim::chip
