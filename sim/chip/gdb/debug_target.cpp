#include "sim/chip/gdb/debug_target.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "sim/chip/gdb/accesses.hpp"

namespace lamplock::sim::chip::gdb {

namespace {

constexpr std::uint32_t flash_base = 0x1000'0000;
constexpr std::uint8_t flash_blank = 0xff;
constexpr std::uint32_t ppb_base = 0xe000'0000;

std::uint64_t filter_bit(std::uint32_t address) { return std::uint64_t{1} << (address >> 1 & 63); }

bool overlap(std::uint32_t a, std::uint32_t a_size, std::uint32_t b, std::uint32_t b_size) {
  return a - b < b_size || b - a < a_size;
}

Master master_of(int core) { return core == 0 ? Master::core0 : Master::core1; }

/// The part of the flash from an address on; empty if it exceeds the flash.
std::span<std::uint8_t> flash_part(Chip& chip, std::uint32_t address, std::size_t size) {
  const auto storage = chip.flash().storage();
  const std::uint32_t offset = address - flash_base;
  if (offset > storage.size() || size > storage.size() - offset) return {};
  return storage.subspan(offset, size);
}

}  // namespace

DebugTarget::DebugTarget(Chip& chip) : chip_(chip) {
  for (int id = 0; id < 2; ++id)
    chip_.core(id).on_breakpoint = [this, id] { return take_breakpoint(chip_.core(id)); };
}

DebugTarget::~DebugTarget() {
  chip_.watch_steps(nullptr);
  for (int id = 0; id < 2; ++id) chip_.core(id).on_breakpoint = nullptr;
}

// --- Breakpoints and watchpoints -----------------------------------------------------------------

void DebugTarget::place_filter() {
  filter_ = 0;
  for (const Breakpoint& each : breakpoints_) filter_ |= filter_bit(each.address);
}

void DebugTarget::set_breakpoint(std::uint32_t address, bool hardware) {
  clear_breakpoint(address, hardware);
  breakpoints_.push_back({address & ~1u, hardware});
  place_filter();
}

void DebugTarget::clear_breakpoint(std::uint32_t address, bool hardware) {
  std::erase(breakpoints_, Breakpoint{address & ~1u, hardware});
  place_filter();
}

void DebugTarget::set_watch(std::uint32_t address, std::uint32_t size, WatchKind kind) {
  clear_watch(address, size, kind);
  watches_.push_back({address, std::max(size, 1u), kind, {}});
  poll_memory(watches_.back());
}

void DebugTarget::clear_watch(std::uint32_t address, std::uint32_t size, WatchKind kind) {
  size = std::max(size, 1u);
  std::erase_if(watches_, [&](const Watch& each) {
    return each.address == address && each.size == size && each.kind == kind;
  });
  passed_.reset();
}

void DebugTarget::clear_all() {
  breakpoints_.clear();
  watches_.clear();
  stepping_.reset();
  at_breakpoint_ = {};
  attached_ = false;
  place_filter();
}

const DebugTarget::Breakpoint* DebugTarget::breakpoint_at(std::uint32_t address) const {
  if ((filter_ & filter_bit(address)) == 0) return nullptr;
  const auto found = std::find_if(breakpoints_.begin(), breakpoints_.end(),
                                  [&](const Breakpoint& each) { return each.address == address; });
  return found == breakpoints_.end() ? nullptr : &*found;
}

void DebugTarget::poll_memory(Watch& watch) {
  const auto memory = chip_.bus().memory_at(canonical_address(watch.address));
  watch.contents.assign(memory.begin(),
                        memory.begin() + static_cast<std::ptrdiff_t>(
                                             std::min<std::size_t>(memory.size(), watch.size)));
}

/// A watch whose memory has changed; reported once.
const DebugTarget::Watch* DebugTarget::watch_changed() {
  const Watch* changed = nullptr;
  for (Watch& watch : watches_) {
    if (watch.kind == WatchKind::read) continue;
    const auto memory = chip_.bus().memory_at(canonical_address(watch.address));
    if (memory.size() >= watch.contents.size() &&
        std::equal(watch.contents.begin(), watch.contents.end(), memory.begin()))
      continue;
    poll_memory(watch);
    if (changed == nullptr) changed = &watch;
  }
  return changed;
}

const DebugTarget::Watch* DebugTarget::watch_hit(Core& core) {
  const auto access = next_access(core, chip_.bus());
  if (!access) return nullptr;
  const std::uint32_t address = canonical_address(access->address);
  const auto hit = std::find_if(watches_.begin(), watches_.end(), [&](const Watch& watch) {
    const bool kind =
        watch.kind == WatchKind::access || (watch.kind == WatchKind::write) == access->write;
    return kind && overlap(address, access->size, canonical_address(watch.address), watch.size);
  });
  return hit == watches_.end() ? nullptr : &*hit;
}

/// The watch to stop for before a step. After one stop the step is allowed: not every debugger
/// removes its watchpoints to continue.
const DebugTarget::Watch* DebugTarget::watch_before(Core& core) {
  const bool passes = passed_ && passed_->core == core.id() && passed_->cycle == core.cycle();
  const Watch* watch = watch_changed();
  if (passed_ && !passes && (watch != nullptr || passed_->core == core.id())) {
    passed_.reset();
    watch = nullptr;  // the change was made by the step
  }
  if (watch != nullptr || passes) return watch;
  watch = watch_hit(core);
  if (watch != nullptr) passed_ = Passed{core.id(), core.cycle()};
  return watch;
}

// --- Running -------------------------------------------------------------------------------------

void DebugTarget::resume(std::optional<int> step) {
  stepping_ = step;
  stepped_.reset();
  attached_ = true;
  if (step) step_level_ = chip_.core(*step).exception();
  for (int id = 0; id < 2; ++id) {
    const auto at = std::exchange(at_breakpoint_[static_cast<std::size_t>(id)], std::nullopt);
    Core& core = chip_.core(id);
    if (!at || core.reg(15) != *at) continue;
    core.set_reg(15, *at + 2);
    if (step == id) stepped_ = *at;
  }
  for (Watch& watch : watches_) poll_memory(watch);
}

Stop DebugTarget::run(Cycle until) {
  stop_ = {};
  const bool watched = !breakpoints_.empty() || !watches_.empty() || stepping_;
  chip_.watch_steps(watched ? this : nullptr);
  chip_.run_until(until);
  chip_.watch_steps(nullptr);
  if (at_breakpoint_[static_cast<std::size_t>(stop_.core)]) {
    Core& core = chip_.core(stop_.core);
    core.run_events(core.cycle());
    halt(core, stop_);
  }
  if (stop_.reason != Stop::Reason::none) stepping_.reset();
  return stop_;
}

// Between two steps all due events have been run, so that the debugger sees the present. The run
// does not change: the core would have run them first, too.
bool DebugTarget::halt(Core& core, Stop stop) {
  chip_.wheel().advance_to(core.cycle());
  stop.core = core.id();
  stop_ = stop;
  return false;
}

/// From inside the execution of a BKPT.
bool DebugTarget::take_breakpoint(Core& core) {
  if (!attached_) return false;
  const std::uint32_t pc = core.reg(15);
  at_breakpoint_[static_cast<std::size_t>(core.id())] = pc;
  stop_ = {Stop::Reason::software_breakpoint, core.id(), pc, WatchKind::write};
  core.request_stop();
  chip_.halt();
  return true;
}

/// The stepped core has made its step and is before the next one.
bool DebugTarget::step_ends(const Core& core) {
  if (stepping_ != core.id()) return false;
  if (stepped_) {
    // An interrupt may abandon an instruction, which begins again afterwards.
    const bool abandoned = core.exception_waits() && core.reg(15) == *stepped_;
    if (!abandoned) return true;
    stepped_.reset();
  }
  const bool at_level = core.exception() == step_level_ || core.exception() == 0;
  if (at_level && !core.exception_waits()) stepped_ = core.reg(15);
  return false;
}

bool DebugTarget::before_step(Core& core) {
  core.run_events(core.cycle());
  const std::uint32_t pc = core.reg(15);
  if (!core.exception_waits()) {
    if (const Breakpoint* here = breakpoint_at(pc))
      return halt(core, {here->hardware ? Stop::Reason::hardware_breakpoint
                                        : Stop::Reason::software_breakpoint,
                         0, pc, WatchKind::write});
  }
  if (!watches_.empty()) {
    if (const Watch* watch = watch_before(core))
      return halt(core, {Stop::Reason::watch, 0, watch->address, watch->kind});
  }
  if (step_ends(core)) return halt(core, {Stop::Reason::step, 0, pc, WatchKind::write});
  return true;
}

// --- Registers -----------------------------------------------------------------------------------

std::uint32_t DebugTarget::reg(int core, unsigned number) {
  const Core& from = chip_.core(core);
  switch (number) {
    case 16:
      return from.xpsr();
    case 17:
      return from.msp();
    case 18:
      return from.psp();
    case 19:
      return from.primask() ? 1 : 0;
    case 20:
      return from.control();
    default:
      return number < 16 ? from.reg(number) : 0;
  }
}

void DebugTarget::set_reg(int core, unsigned number, std::uint32_t value) {
  Core& to = chip_.core(core);
  switch (number) {
    case 16:
      return to.set_xpsr(value);
    case 17:
      return to.set_msp(value);
    case 18:
      return to.set_psp(value);
    case 19:
      return to.set_primask((value & 1) != 0);
    case 20:
      return to.set_control(value);
    default:
      if (number < 16) to.set_reg(number, value);
  }
}

// --- Memory --------------------------------------------------------------------------------------

std::optional<std::uint32_t> DebugTarget::register_word(int core, std::uint32_t address) {
  if (address >= ppb_base) return chip_.core(core).peek_system(address);
  return chip_.bus().peek(address, master_of(core));
}

std::size_t DebugTarget::read(int core, std::uint32_t address, std::span<std::uint8_t> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const std::uint32_t at = address + static_cast<std::uint32_t>(done);
    if (done != 0 && at < address) break;  // wrapped at the end of the address space
    const std::size_t in_word = std::min<std::size_t>(4 - (at & 3), bytes.size() - done);
    const auto memory = chip_.bus().memory_at(canonical_address(at));
    if (!memory.empty()) {
      std::copy_n(memory.begin(), in_word, bytes.begin() + static_cast<std::ptrdiff_t>(done));
    } else {
      const auto word = register_word(core, at & ~3u);
      if (!word) break;
      std::array<std::uint8_t, 4> parts;
      std::memcpy(parts.data(), &*word, sizeof *word);
      std::copy_n(parts.begin() + (at & 3), in_word,
                  bytes.begin() + static_cast<std::ptrdiff_t>(done));
    }
    done += in_word;
  }
  return done;
}

bool DebugTarget::write(int core, std::uint32_t address, std::span<const std::uint8_t> bytes) {
  Bus& bus = chip_.bus();
  while (!bytes.empty()) {
    if (address >= ppb_base) return false;
    const bool word = (address & 3) == 0 && bytes.size() >= 4;
    const bool half = (address & 1) == 0 && bytes.size() >= 2;
    const Width width = word ? Width::word : half ? Width::half : Width::byte;
    const auto size = static_cast<std::uint32_t>(width);
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data(), size);
    if (bus.write(address, value, width, master_of(core), chip_.now()).fault) return false;
    address += size;
    bytes = bytes.subspan(size);
  }
  return true;
}

bool DebugTarget::erase_flash(std::uint32_t address, std::uint32_t size) {
  const auto part = flash_part(chip_, address, size);
  std::fill(part.begin(), part.end(), flash_blank);
  return part.size() == size;
}

bool DebugTarget::program_flash(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  const auto part = flash_part(chip_, address, bytes.size());
  std::copy_n(bytes.begin(), part.size(), part.begin());
  return part.size() == bytes.size();
}

void DebugTarget::reset() {
  chip_.power_on();
  chip_.run_until(chip_.now());
  stepping_.reset();
  passed_.reset();
}

}  // namespace lamplock::sim::chip::gdb
