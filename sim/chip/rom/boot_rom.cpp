#include "sim/chip/rom/boot_rom.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

#include "sim/chip/rom/rom_context.hpp"

namespace lamplock::sim::chip {

using namespace rom;

BootRom::BootRom(std::span<std::uint8_t> memory, const QspiPins& pins, NotModelled not_modelled,
                 unsigned version)
    : memory_(memory),
      pins_(pins),
      not_modelled_(std::move(not_modelled)),
      version_(version),
      loader_(not_modelled_) {
  if (version < 1 || version > latest_version)
    throw std::invalid_argument("boot ROM: versions are 1, 2 and 3");
  if (memory.size() != Bus::rom_size) throw std::invalid_argument("boot ROM: 16 KiB of memory");
  build();
}

bool BootRom::is_trap(std::uint32_t address) const {
  return address + 1 < memory_.size() && (address & 1u) == 0 && memory_[address + 1] == 0xde &&
         memory_[address] != static_cast<std::uint8_t>(Trap::bad);
}

BootRom::Step BootRom::step(RomCore& core, Cycle now) {
  const std::uint32_t at = core.reg(pc);
  Context context(core, now);
  if (!is_trap(at)) return {1, true};
  run(static_cast<Trap>(memory_[at]), context);
  return context.result();
}

void BootRom::run(Trap trap, Context& c) {
  switch (trap) {
    case Trap::lookup:
      return lookup(c);
    case Trap::popcount:
    case Trap::reverse:
    case Trap::leading_zeros:
    case Trap::trailing_zeros:
      return bit_function(trap, c);
    case Trap::memset_start:
      return fill_start(c, false);
    case Trap::memcpy_start:
      return fill_start(c, true);
    case Trap::memset_block:
      return fill_block(c, false, false);
    case Trap::memset4_block:
      return fill_block(c, false, true);
    case Trap::memcpy_block:
      return fill_block(c, true, false);
    case Trap::memcpy44_block:
      return fill_block(c, true, true);
    case Trap::connect:
    case Trap::connect_wait:
      return connect_flash(c);
    case Trap::exit_xip_start:
      return exit_xip_start(c);
    case Trap::exit_xip:
      return exit_xip(c);
    case Trap::erase_start:
      return erase_start(c);
    case Trap::program_start:
      return program_start(c);
    case Trap::flash_write:
      return flash_write(c);
    case Trap::flush:
      return flush_cache(c);
    case Trap::enter_xip:
      return enter_command_xip(c);
    case Trap::reset_usb:
      return usb_boot(c);
    case Trap::usb_boot:
      return enter_boot_loader(c);
    case Trap::boot_start:
      return boot_start(c);
    case Trap::boot_main:
      return boot_main(c);
    case Trap::boot_attempt:
      return boot_attempt(c);
    case Trap::boot_read:
      return boot_read(c);
    case Trap::boot_check:
      return boot_check(c);
    case Trap::boot_enter:
      return boot_enter(c);
    case Trap::wait_start:
      return wait_start(c);
    case Trap::wait:
      return wait_for_vector(c);
    case Trap::float_start:
      return float_start(c);
    case Trap::float_wait:
      return float_wait(c);
    case Trap::float_finish:
      return float_finish(c);
    case Trap::loader_crystal:
      return loader_clocks(c);
    case Trap::loader_pll:
      return loader_pll(c);
    case Trap::loader_ready:
      return loader_ready(c);
    case Trap::loader_task:
      return loader_task(c);
    case Trap::page_read_start:
    case Trap::page_read:
      return page_read(c);
    case Trap::loader_scratch:
    case Trap::loader_blocks:
    case Trap::loader_done:
    case Trap::loader_interrupt:
    case Trap::range_arguments:
    case Trap::sector_arguments:
    case Trap::page_arguments:
    case Trap::give_zero:
      return run_loader(trap, c);
    case Trap::bad:
      return;
  }
}

// --- bits ---

namespace {
std::uint32_t reversed(std::uint32_t word) {
  std::uint32_t result = 0;
  for (unsigned bit = 0; bit < 32; ++bit) result |= ((word >> bit) & 1u) << (31 - bit);
  return result;
}
}  // namespace

void BootRom::bit_function(Trap trap, Context& c) {
  const auto give = [&](std::uint32_t value, std::uint32_t cycles) {
    c.set(0, value);
    c.spend(cycles - 2);  // the BX LR that follows takes the other two
    c.leave();
  };
  const std::uint32_t word = c.reg(0);
  switch (trap) {
    case Trap::popcount:
      return give(static_cast<std::uint32_t>(std::popcount(word)), timing_.popcount);
    case Trap::reverse:
      return give(reversed(word), timing_.reverse);
    case Trap::leading_zeros:
      return give(static_cast<std::uint32_t>(std::countl_zero(word)), timing_.leading_zeros);
    default:
      return give(static_cast<std::uint32_t>(std::countr_zero(word)), timing_.trailing_zeros);
  }
}

// --- tables ---

namespace {
std::uint32_t half_at(std::span<const std::uint8_t> memory, std::uint32_t at) {
  return memory[at] | static_cast<std::uint32_t>(memory[at + 1]) << 8;
}
std::uint32_t find(std::span<const std::uint8_t> memory, std::uint32_t table, char first,
                   char second) {
  const std::uint32_t code = static_cast<std::uint8_t>(first) |
                             static_cast<std::uint32_t>(static_cast<std::uint8_t>(second)) << 8;
  for (; half_at(memory, table) != 0; table += 4)
    if (half_at(memory, table) == code) return half_at(memory, table + 2);
  return 0;
}
}  // namespace

std::uint32_t BootRom::function(char first, char second) const {
  return find(memory_, function_table_, first, second);
}
std::uint32_t BootRom::datum(char first, char second) const {
  return find(memory_, data_table_, first, second);
}

void BootRom::lookup(Context& c) {
  constexpr unsigned longest = 256;  // limit for a table without an end
  std::uint32_t table = c.reg(0);
  const std::uint32_t code = c.reg(1);
  std::uint32_t value = 0;
  for (unsigned i = 0; i < longest; ++i, table += 4) {
    const std::uint32_t entry = (table & 1u) != 0 ? 0 : c.load(table, Width::half);
    if (entry == 0) break;
    c.spend(timing_.lookup_entry - 4);
    const std::uint32_t address = c.load(table + 2, Width::half);
    if (entry == code) {
      value = address;
      break;
    }
  }
  if (value == 0 && not_modelled_) {
    std::string letters;
    for (const std::uint32_t letter : {code & 0xffu, code >> 8 & 0xffu})
      letters += letter >= 0x20 && letter < 0x7f ? static_cast<char>(letter) : '?';
    not_modelled_("ROM function or data '" + letters + "'");
  }
  c.set(0, value);
  c.spend(4);
  c.leave();
}

// --- memory ---

void BootRom::fill_start(Context& c, bool copy) {
  c.set(12, c.reg(0));  // r0 is returned; r12 moves
  if (!copy) c.set(1, (c.reg(1) & 0xffu) * 0x0101'0101u);
  c.spend(timing_.copy_start);
  c.leave();
}

void BootRom::fill_block(Context& c, bool copy, bool words) {
  const std::uint32_t left = c.reg(2);
  if (left == 0) {
    c.leave();
    return;
  }
  const std::uint32_t to = c.reg(12);
  const std::uint32_t from = c.reg(1);
  const bool aligned = words || (to % 4 == 0 && (!copy || from % 4 == 0));
  const std::uint32_t bytes = std::min(left, aligned && left >= 16 ? 16u : 4u);
  const std::uint32_t before = c.result().cycles;
  const bool by_words = aligned && bytes % 4 == 0;
  for (std::uint32_t i = 0; i < bytes; i += by_words ? 4 : 1) {
    const Width width = by_words ? Width::word : Width::byte;
    const std::uint32_t value = copy ? c.load(from + i, width) : from;
    c.store(to + i, value, width);
  }
  // The accesses have cost as much as single ones; the real function moves four words at a time.
  const std::uint32_t cost = bytes == 16 ? timing_.copy_block : bytes * timing_.copy_byte;
  const std::uint32_t spent = c.result().cycles - before;
  if (spent < cost) c.spend(cost - spent);
  c.set(12, to + bytes);
  if (copy) c.set(1, from + bytes);
  c.set(2, left - bytes);
}

}  // namespace lamplock::sim::chip
