#include "sim/chip/fabric/bus.hpp"

#include <bit>
#include <stdexcept>
#include <string>

#include "sim/chip/fabric/hex.hpp"
#include "sim/chip/fabric/xip_memory.hpp"

namespace lamplock::sim::chip {

static_assert(std::endian::native == std::endian::little, "memory is kept as the chip has it");

namespace {

// RP2040 datasheet, 2.2.
constexpr std::uint32_t xip_base = 0x1000'0000;
constexpr std::uint32_t xip_control_base = 0x1400'0000;
constexpr std::uint32_t ssi_base = 0x1800'0000;
constexpr std::uint32_t rom_base = 0x0000'0000;
constexpr std::uint32_t sram_base = 0x2000'0000, sram_base_single = 0x2100'0000;
constexpr std::uint32_t striped_size = 256 * 1024, small_bank_size = 4 * 1024;
constexpr std::uint32_t apb_base = 0x4000'0000;
constexpr std::uint32_t ahb_base = 0x5000'0000;
constexpr std::uint32_t sio_base = 0xd000'0000;
constexpr std::uint32_t block_size = 0x4000;
constexpr std::uint32_t register_mask = 0xffc;
constexpr std::uint32_t xip_flush = 0x04;  // XIP_CTRL FLUSH (2.6.3.6)

// The blocks on APB, one each 16 KiB (datasheet, 2.2.4).
constexpr std::array<std::string_view, 28> apb_names = {"SYSINFO",   "SYSCFG",
                                                        "CLOCKS",    "RESETS",
                                                        "PSM",       "IO_BANK0",
                                                        "IO_QSPI",   "PADS_BANK0",
                                                        "PADS_QSPI", "XOSC",
                                                        "PLL_SYS",   "PLL_USB",
                                                        "BUSCTRL",   "UART0",
                                                        "UART1",     "SPI0",
                                                        "SPI1",      "I2C0",
                                                        "I2C1",      "ADC",
                                                        "PWM",       "TIMER",
                                                        "WATCHDOG",  "RTC",
                                                        "ROSC",      "VREG_AND_CHIP_RESET",
                                                        "",          "TBMAN"};

struct AhbName {
  std::uint32_t index;
  std::string_view name;
};
// The blocks on AHB-Lite (datasheet, 2.2.5), by bits 23..16 of the address.
constexpr std::array<AhbName, 6> ahb_names = {{{0x00, "DMA"},
                                               {0x10, "USBCTRL_DPRAM"},
                                               {0x11, "USBCTRL_REGS"},
                                               {0x20, "PIO0"},
                                               {0x30, "PIO1"},
                                               {0x40, "XIP_AUX"}}};

// What each write alias does to a register (datasheet, 2.1.2).
std::uint32_t combine(std::uint32_t old, std::uint32_t value, std::uint32_t alias) {
  switch (alias) {
    case 1:
      return old ^ value;
    case 2:
      return old | value;
    case 3:
      return old & ~value;
    default:
      return value;
  }
}

// A narrow write reaches a register as the whole bus word, on which the masters repeat the written
// data (datasheet, 2.1.4).
std::uint32_t replicate(std::uint32_t value, Width width) {
  switch (width) {
    case Width::byte:
      return (value & 0xff) * 0x0101'0101u;
    case Width::half:
      return (value & 0xffff) * 0x0001'0001u;
    case Width::word:
      break;
  }
  return value;
}

std::uint32_t lane(std::uint32_t word, std::uint32_t address, Width width) {
  const std::uint32_t shifted = word >> (8 * (address & 3));
  switch (width) {
    case Width::byte:
      return shifted & 0xff;
    case Width::half:
      return shifted & 0xffff;
    case Width::word:
      break;
  }
  return word;
}

}  // namespace

Bus::Bus(TimeWheel& wheel, const Timing& timing, NotModelled not_modelled)
    : wheel_(wheel), not_modelled_(std::move(not_modelled)), sram_(sram_size), rom_(rom_size) {
  for (std::size_t i = 0; i < apb_names.size(); ++i) {
    apb_[i].name = apb_names[i];
    apb_[i].port = BusPort::apb;
    apb_[i].read_wait = timing.apb_read_wait;
    apb_[i].write_wait = timing.apb_write_wait;
  }
  for (const AhbName& entry : ahb_names) {
    ahb_[entry.index].name = entry.name;
    ahb_[entry.index].port = BusPort::fast_peripherals;
    ahb_[entry.index].read_wait = ahb_[entry.index].write_wait = timing.ahb_wait;
  }
  xip_control_.name = "XIP_CTRL";
  xip_control_.read_wait = xip_control_.write_wait = timing.ahb_wait;
  // The SSI's own registers are on APB inside the XIP block (datasheet, 2.6.3).
  ssi_.name = "XIP_SSI";
  ssi_.read_wait = timing.apb_read_wait;
  ssi_.write_wait = timing.apb_write_wait;
  for (Slot& slot : sio_) slot.name = "SIO";
  map_memory(0, rom_, false);
  map_memory(sram_base, sram_, true);
}

void Bus::map(std::uint32_t base, Peripheral& block, bool aliases) {
  std::uint32_t offset = 0;
  Slot* slot = slot_at(base, Master::core0, offset);
  if (slot == nullptr || offset != 0) throw std::invalid_argument("no block at " + hex(base));
  slot->block = &block;
  slot->aliases = aliases;
}

void Bus::map_sio(Peripheral& core0, Peripheral& core1) {
  sio_[0].block = &core0;
  sio_[1].block = &core1;
}

void Bus::map_memory(std::uint32_t base, std::span<std::uint8_t> memory, bool writable) {
  if (base >= apb_base) {
    std::uint32_t offset = 0;
    Slot* slot = slot_at(base, Master::core0, offset);
    if (slot == nullptr || offset != 0) throw std::invalid_argument("no memory at " + hex(base));
    slot->memory = memory;
    slot->writable = writable;
    return;
  }
  if ((base & 0x00ff'ffff) != 0 || memory.size() > 0x0100'0000)
    throw std::invalid_argument("memory does not fit at " + hex(base));
  const auto size = static_cast<std::uint32_t>(memory.size());
  memories_[base >> 24] = {memory.data(), size, writable ? size : 0};
  show(base >> 24);
  map_changed();
}

void Bus::unmap_memory(std::uint32_t base) {
  memories_[base >> 24] = {};
  show(base >> 24);
  map_changed();
}

// --- Two masters ---------------------------------------------------------------------------------

void Bus::contend(bool two_cores, bool dma_active) {
  if (contended_ == (two_cores || dma_active)) return;
  contended_ = two_cores || dma_active;
  show(rom_base >> 24);
  show(sram_base >> 24);
  if (!contended_) return;
  for (const Fetcher& fetcher : fetchers_) leave_fetched_word(fetcher);
}

// Reduces a window of many instructions to the word that the core has fetched already.
void Bus::leave_fetched_word(const Fetcher& fetcher) {
  CodeWindow& window = *fetcher.window;
  if (!memory_port(window.first)) return;
  const std::uint32_t word = *fetcher.pc & ~3u;
  const bool inside = word >= window.first && word + 4 - window.first <= window.size;
  window = inside ? CodeWindow{window.bytes + (word - window.first), word, 4} : CodeWindow{};
}

// Memory is reached directly unless it is contended.
void Bus::show(std::uint32_t top) {
  const bool asked = contended_ && memory_port(top << 24).has_value();
  windows_[top] = asked ? Window{} : memories_[top];
}

// The port of a memory (2.1.1, 2.6.2): banks 0 to 3 by the word, or one after the other.
std::optional<BusPort> Bus::memory_port(std::uint32_t address) {
  const auto bank = [](std::uint32_t number) {
    return static_cast<BusPort>(static_cast<std::uint32_t>(BusPort::sram0) - number);
  };
  switch (address >> 24) {
    case rom_base >> 24:
      return BusPort::rom;
    case sram_base >> 24: {
      const std::uint32_t offset = address - sram_base;
      if (offset < striped_size) return bank(offset >> 2 & 3u);
      return offset - striped_size < small_bank_size ? BusPort::sram4 : BusPort::sram5;
    }
    case sram_base_single >> 24:
      return bank(address >> 16 & 3u);
    default:
      return std::nullopt;
  }
}

// Cycles that an access with `wait` wait states waits for its port. A core's data follow one cycle
// after the address, which it puts out in the first cycle of its instruction.
std::uint32_t Bus::clash(BusPort port, Master master, bool write, Cycle at, std::uint32_t wait) {
  if (!contended_) return 0;
  if (master == Master::dma)
    return arbiter_.request(port, write ? Requester::dma_write : Requester::dma_read, at, 1 + wait);
  return arbiter_.request(port, static_cast<Requester>(master), at + 1, 1 + wait);
}

std::uint32_t Bus::slot_wait(const Slot& slot, Master master, bool write, Cycle at) {
  const std::uint32_t wait = write ? slot.write_wait : slot.read_wait;
  return wait + (slot.port ? clash(*slot.port, master, write, at, wait) : 0);
}

std::uint8_t* Bus::contended_byte(std::uint32_t address, bool write) {
  const Window& memory = memories_[address >> 24];
  if (!contended_ || windows_[address >> 24].size != 0) return nullptr;
  const std::uint32_t offset = address & in_window;
  return offset < (write ? memory.writable_size : memory.size) ? memory.bytes + offset : nullptr;
}

Access Bus::fetch(std::uint32_t address, Master master, Cycle at) {
  if (const std::uint8_t* byte = contended_byte(address, false))
    return {load(byte, Width::word), fetch_wait(address, master, at), false};
  return read(address, Width::word, master, at);
}

void Bus::watch_memory(std::uint32_t base, Stored stored) {
  std::uint32_t offset = 0;
  Slot* slot = slot_at(base, Master::core0, offset);
  if (slot == nullptr || offset != 0) throw std::invalid_argument("no memory at " + hex(base));
  slot->stored = std::move(stored);
}

void Bus::map_changed() {
  for (const Fetcher& fetcher : fetchers_) fetcher.window->size = fetcher.memory->size = 0;
}

std::span<std::uint8_t> Bus::memory_at(std::uint32_t address) {
  const Window& window = memories_[address >> 24];
  const std::uint32_t offset = address & in_window;
  if (offset < window.size) return {window.bytes + offset, window.size - offset};
  if (is_xip(address)) return xip_->flash_at(address);
  std::uint32_t inside = 0;
  const Slot* slot = slot_at(address, Master::core0, inside);
  if (slot == nullptr || inside >= slot->memory.size()) return {};
  return slot->memory.subspan(inside);
}

std::optional<std::uint32_t> Bus::peek(std::uint32_t address, Master master) {
  std::uint32_t offset = 0;
  const Slot* slot = slot_at(address, master, offset);
  if (slot == nullptr || slot->block == nullptr) return std::nullopt;
  if (offset > register_mask + 3 && !slot->aliases) return std::nullopt;
  return slot->block->peek(offset & register_mask);
}

Bus::CodeWindow Bus::code_at(std::uint32_t address) const {
  const Window& window = windows_[address >> 24];
  const std::uint32_t offset = address & in_window;
  if (offset >= window.size) return {};
  return {window.bytes, address - offset, window.size};
}

Bus::CodeWindow Bus::memory_code_at(std::uint32_t address) const {
  const Window& memory = memories_[address >> 24];
  const std::uint32_t offset = address & in_window;
  if (!memory_port(address) || offset >= memory.size) return {};
  return {memory.bytes, address - offset, memory.size};
}

std::uint8_t* Bus::bank_byte(std::uint32_t address) {
  // Bank b of the four holds every fourth word of the striped region (datasheet, 2.6.2).
  if ((address >> 18) != (sram_base_single >> 18)) return nullptr;
  const std::uint32_t bank = (address >> 16) & 3;
  const std::uint32_t word = (address & 0xffff) >> 2;
  return sram_.data() + (((word << 2) | bank) << 2) + (address & 3);
}

Bus::Slot* Bus::slot_at(std::uint32_t address, Master master, std::uint32_t& offset) {
  Slot* slot = nullptr;
  offset = address & (block_size - 1);
  switch (address >> 24) {
    case xip_control_base >> 24:
      slot = &xip_control_;
      break;
    case ssi_base >> 24:
      slot = &ssi_;
      break;
    case apb_base >> 24:
      if (((address >> 14) & 0x3ff) < apb_.size()) slot = &apb_[(address >> 14) & 31];
      break;
    case ahb_base >> 24:
      if (const std::uint32_t index = (address >> 16) & 0xff; index < ahb_.size()) {
        slot = &ahb_[index];
        offset = address & 0xffff;
      }
      break;
    case sio_base >> 24:
      if (master != Master::dma) slot = &sio_[master == Master::core0 ? 0 : 1];
      offset = address & 0x00ff'ffff;
      break;
    default:
      break;
  }
  if (slot == nullptr || slot->name.empty() || offset >= block_size) return nullptr;
  return slot;
}

void Bus::report(const Slot& slot, std::uint32_t address, std::string_view what) {
  if (not_modelled_)
    not_modelled_(std::string(slot.name) + " " + std::string(what) + " at " + hex(address & ~3u));
}

Access Bus::read_block(std::uint32_t address, Width width, Master master, Cycle at) {
  if (is_xip(address)) return xip_->read(address, width, master, at);
  const std::uint8_t* byte = contended_byte(address, false);
  if (byte == nullptr) byte = bank_byte(address);
  if (byte != nullptr)
    return {load(byte, width), clash(*memory_port(address), master, false, at, 0), false};
  std::uint32_t offset = 0;
  const Slot* slot = slot_at(address, master, offset);
  if (slot == nullptr) {
    if ((address >> 26) == (xip_base >> 26) && not_modelled_)
      not_modelled_("XIP read while no flash is mapped");
    return {0, 0, true};
  }
  if (offset < slot->memory.size())
    return {load(slot->memory.data() + offset, width), slot_wait(*slot, master, false, at), false};
  if (slot->block == nullptr) {
    report(*slot, address, "read");
    return {0, slot_wait(*slot, master, false, at), false};
  }
  if (offset > register_mask + 3 && !slot->aliases) return {0, 0, true};
  if (master != Master::dma) wheel_.advance_to(at);
  std::uint32_t wait = slot_wait(*slot, master, false, at);
  // A read of FLUSH holds the bus until the flush is done (2.6.3.6).
  if (slot == &xip_control_ && xip_ != nullptr && (offset & register_mask) == xip_flush)
    wait += xip_->flush_wait(at);
  if (behind_xip_port(*slot)) wait += xip_->port_wait(master, at);
  return {lane(slot->block->read(offset & register_mask), address, width), wait, false};
}

Access Bus::write_block(std::uint32_t address, std::uint32_t value, Width width, Master master,
                        Cycle at) {
  if (is_xip(address)) return xip_->write(address, master, at);
  std::uint8_t* byte = contended_byte(address, true);
  if (byte == nullptr) byte = bank_byte(address);
  if (byte != nullptr) {
    store(byte, value, width);
    return {0, clash(*memory_port(address), master, true, at, 0), false};
  }
  // Writes to read-only memory, the ROM, are ignored (assumed: the manual is silent).
  if ((address & in_window) < memories_[address >> 24].size) return {};
  std::uint32_t offset = 0;
  Slot* slot = slot_at(address, master, offset);
  if (slot == nullptr) return {0, 0, true};
  if (offset < slot->memory.size()) {
    // A listener to the memory sees the store in its cycle, as with a register.
    if (slot->stored && master != Master::dma) wheel_.advance_to(at);
    Access access = store_in_slot(*slot, offset, value, width);
    access.wait = slot_wait(*slot, master, true, at);
    return access;
  }
  if (slot->block == nullptr) {
    report(*slot, address, "written");
    return {0, slot_wait(*slot, master, true, at), false};
  }
  const std::uint32_t alias = offset >> 12;
  if (alias != 0 && !slot->aliases) return {0, 0, true};
  if (master != Master::dma) wheel_.advance_to(at);
  std::uint32_t word = replicate(value, width);
  if (alias != 0) {
    const std::uint32_t as_written = slot->block->write_clear_bits(offset & register_mask);
    const std::uint32_t combined = combine(slot->block->peek(offset & register_mask), word, alias);
    word = (combined & ~as_written) | (word & as_written);
  }
  slot->block->write(offset & register_mask, word);
  const std::uint32_t port_wait = behind_xip_port(*slot) ? xip_->port_wait(master, at) : 0;
  return {0, slot_wait(*slot, master, true, at) + port_wait, false};
}

Access Bus::store_in_slot(Slot& slot, std::uint32_t offset, std::uint32_t value, Width width) {
  if (!slot.writable) return {0, 0, true};
  std::uint8_t* word = slot.memory.data() + (offset & ~3u);
  const std::uint32_t before = load(word, Width::word);
  store(slot.memory.data() + offset, value, width);
  if (slot.stored) slot.stored(offset & ~3u, before, load(word, Width::word));
  return {0, 0, false};
}

}  // namespace lamplock::sim::chip
