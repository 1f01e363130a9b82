// The bus fabric: which block answers at which address, and what an access costs.
//
// In:  accesses of the cores and of DMA, with the cycle in which they begin.
// Out: values, wait states, bus faults. Memory is reached directly; registers through the
//      Peripheral that was mapped there, after time has been brought up to the access.
// Map (RP2040 datasheet, 2.2): ROM 0x00000000, XIP 0x10000000 (aliases 11 12 13, control 14, SRAM
// use of the cache 15, SSI 18), SRAM 0x20000000 (striped) 0x20040000 0x20041000 (banks 4, 5)
// 0x21000000 (banks 0-3 one after the other), APB 0x40000000, AHB-Lite 0x50000000, SIO 0xd0000000
// (cores only, single cycle, no aliases), PPB 0xe0000000 (inside a core).
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sim/chip/fabric/arbiter.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/fabric/timing.hpp"

namespace lamplock::sim::chip {

class XipMemory;

enum class Master : std::uint8_t { core0, core1, dma };

/// Width of an access in bytes.
enum class Width : std::uint8_t { byte = 1, half = 2, word = 4 };

/// Result of an access.
struct Access {
  std::uint32_t value = 0;  ///< of a read, zero-extended
  std::uint32_t wait = 0;   ///< cycles beyond the one that every access takes
  bool fault = false;       ///< no block at the address, or not permitted
};

/// The fabric of one chip. Flash is read-only here; the flash chip writes its own storage.
class Bus {
 public:
  static constexpr std::size_t rom_size = 16 * 1024;
  static constexpr std::size_t sram_size = 264 * 1024;
  static constexpr std::size_t usb_dpram_size = 4 * 1024;

  Bus(TimeWheel& wheel, const Timing& timing, NotModelled not_modelled);
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Maps a block at its base; `aliases` for APB and AHB-Lite blocks (16 KiB windows).
  void map(std::uint32_t base, Peripheral& block, bool aliases = true);
  /// SIO answers each core with registers of its own: one block for each.
  void map_sio(Peripheral& core0, Peripheral& core1);
  /// Plain memory at an address (DPRAM of USB, the cache's); must outlive the bus. Mapping again
  /// replaces.
  void map_memory(std::uint32_t base, std::span<std::uint8_t> memory, bool writable);
  /// The flash behind its cache, at all four aliases.
  void map_xip(XipMemory& memory) { xip_ = &memory; }
  /// Unmaps a memory: accesses there fault from now on.
  void unmap_memory(std::uint32_t base);
  /// Calls `stored` after each store to the memory mapped at `base` on APB or AHB-Lite (the DPRAM
  /// of USB), with the word's offset and its values before and after.
  using Stored =
      std::function<void(std::uint32_t offset, std::uint32_t before, std::uint32_t after)>;
  void watch_memory(std::uint32_t base, Stored stored);

  /// Access to memory that costs only the one cycle. False: nothing was done because the memory is
  /// not plain or the access is not aligned; call read() or write().
  bool load_plain(std::uint32_t address, Width width, std::uint32_t& value) const {
    const Window& window = windows_[address >> 24];
    const std::uint32_t offset = address & in_window;
    if (offset >= window.size || !aligned(address, width)) return false;
    value = load(window.bytes + offset, width);
    return true;
  }
  bool store_plain(std::uint32_t address, Width width, std::uint32_t value) {
    const Window& window = windows_[address >> 24];
    const std::uint32_t offset = address & in_window;
    if (offset >= window.writable_size || !aligned(address, width)) return false;
    store(window.bytes + offset, value, width);
    return true;
  }
  /// The same for words that follow each other: where the first one is, or null.
  std::uint8_t* plain_words(std::uint32_t address, unsigned count, bool to_write) const {
    const Window& window = windows_[address >> 24];
    const std::uint32_t offset = address & in_window;
    const std::uint32_t size = to_write ? window.writable_size : window.size;
    if (offset >= size || size - offset < 4 * count || !aligned(address, Width::word))
      return nullptr;
    return window.bytes + offset;
  }
  static bool aligned(std::uint32_t address, Width width) {
    return (address & (static_cast<std::uint32_t>(width) - 1)) == 0;
  }
  /// An aligned access. Time must have been advanced to `at` (TimeWheel::advance_to) before a
  /// register is touched: Bus does so for cores; the DMA runs inside an event, at the right time
  /// already.
  Access read(std::uint32_t address, Width width, Master master, Cycle at) {
    const Window& window = windows_[address >> 24];
    const std::uint32_t offset = address & in_window;
    if (offset < window.size) [[likely]]
      return {load(window.bytes + offset, width), 0, false};
    return read_block(address, width, master, at);
  }
  Access write(std::uint32_t address, std::uint32_t value, Width width, Master master, Cycle at) {
    const Window& window = windows_[address >> 24];
    const std::uint32_t offset = address & in_window;
    if (offset < window.writable_size) [[likely]] {
      store(window.bytes + offset, value, width);
      return {};
    }
    return write_block(address, value, width, master, at);
  }

  /// The aligned word of code at an address.
  Access fetch(std::uint32_t address, Master master, Cycle at);
  /// Cycles that a core waits for its port before it has the word of code in ROM or SRAM that it
  /// requests in cycle `at`, while contended().
  std::uint32_t fetch_wait(std::uint32_t address, Master master, Cycle at) {
    return arbiter_.request(*memory_port(address), static_cast<Requester>(master), at, 1);
  }

  /// On while both cores are awake: each access then asks for its port of the crossbar and may wait
  /// for it (2.1.1), as it does while the DMA has transfers to make. One core alone never waits.
  void set_two_cores(bool on) {
    if (two_cores_ != on) contend(two_cores_ = on, dma_active_);
  }
  void set_dma_active(bool on) {
    if (dma_active_ != on) contend(two_cores_, dma_active_ = on);
  }
  bool contended() const { return contended_; }
  Arbiter& arbiter() { return arbiter_; }

  /// The memory at an address, up to the end of its region, for loaders, debuggers and the USB
  /// controller; empty if the address is not memory.
  std::span<std::uint8_t> memory_at(std::uint32_t address);

  /// The present value of a register (Peripheral::peek), for debuggers: no side effects, no time.
  /// Empty if no block answers there.
  std::optional<std::uint32_t> peek(std::uint32_t address, Master master);

  /// Memory that instructions may be fetched from directly, around an address; size 0: none, fetch
  /// word by word through read() (flash behind its cache). The bus empties the windows it gave to
  /// cores when the map changes.
  struct CodeWindow {
    const std::uint8_t* bytes = nullptr;
    std::uint32_t first = 0;
    std::uint32_t size = 0;
  };
  CodeWindow code_at(std::uint32_t address) const;
  /// The same for ROM and SRAM, contended or not; size 0: the address is in neither.
  CodeWindow memory_code_at(std::uint32_t address) const;
  /// Registers what a core keeps for the life of the bus: its window, the part of memory_code_at()
  /// that it fetches from while memory is contended, and the address of its present instruction.
  void share_code_windows(CodeWindow& window, CodeWindow& memory, const std::uint32_t& pc) {
    fetchers_.push_back({&window, &memory, &pc});
  }

  std::span<std::uint8_t> sram() { return sram_; }
  std::span<std::uint8_t> rom() { return rom_; }

 private:
  /// Memory reached without arbitration: one window for each value of the top eight address bits;
  /// the other bits are the offset in it.
  static constexpr std::uint32_t in_window = 0x00ff'ffff;
  struct Window {
    std::uint8_t* bytes = nullptr;
    std::uint32_t size = 0;
    std::uint32_t writable_size = 0;
  };
  /// A block at a place on APB, AHB-Lite or the core's own port.
  struct Slot {
    Peripheral* block = nullptr;
    std::span<std::uint8_t> memory;
    bool writable = false;
    bool aliases = false;
    Stored stored;
    std::string_view name;  ///< of a block that exists; empty: no block
    std::uint32_t read_wait = 0;
    std::uint32_t write_wait = 0;
    std::optional<BusPort> port;
  };
  struct Fetcher {
    CodeWindow* window;
    CodeWindow* memory;
    const std::uint32_t* pc;
  };

  static std::uint32_t load(const std::uint8_t* at, Width width) {
    switch (width) {
      case Width::byte:
        return *at;
      case Width::half: {
        std::uint16_t half;
        std::memcpy(&half, at, sizeof half);
        return half;
      }
      case Width::word:
        break;
    }
    std::uint32_t word;
    std::memcpy(&word, at, sizeof word);
    return word;
  }
  static void store(std::uint8_t* at, std::uint32_t value, Width width) {
    std::memcpy(at, &value, static_cast<std::size_t>(width));
  }

  void contend(bool two_cores, bool dma_active);
  void show(std::uint32_t top);
  std::uint32_t slot_wait(const Slot& slot, Master master, bool write, Cycle at);
  std::uint32_t clash(BusPort port, Master master, bool write, Cycle at, std::uint32_t wait);
  static std::optional<BusPort> memory_port(std::uint32_t address);
  /// A byte of memory that is contended; null: none.
  std::uint8_t* contended_byte(std::uint32_t address, bool write);
  Access read_block(std::uint32_t address, Width width, Master master, Cycle at);
  Access write_block(std::uint32_t address, std::uint32_t value, Width width, Master master,
                     Cycle at);
  Access store_in_slot(Slot& slot, std::uint32_t offset, std::uint32_t value, Width width);
  /// The block that answers at an address in the register space, and the offset in it; null: none.
  Slot* slot_at(std::uint32_t address, Master master, std::uint32_t& offset);
  bool is_xip(std::uint32_t address) const {
    return xip_ != nullptr && (address >> 26) == (0x1000'0000u >> 26);
  }
  /// Registers that share the port of the flash with it (2.6.3): XIP_CTRL, the SSI's.
  bool behind_xip_port(const Slot& slot) const {
    return (&slot == &xip_control_ || &slot == &ssi_) && xip_ != nullptr;
  }
  /// The byte of the striped SRAM at an address in the windows of single banks.
  std::uint8_t* bank_byte(std::uint32_t address);
  void report(const Slot& slot, std::uint32_t address, std::string_view what);
  void map_changed();
  void leave_fetched_word(const Fetcher& fetcher);

  TimeWheel& wheel_;
  NotModelled not_modelled_;
  std::array<Window, 256> windows_{};
  std::array<Window, 256> memories_{};  ///< all; windows_ lacks contended memory
  Arbiter arbiter_;
  bool two_cores_ = false, dma_active_ = false, contended_ = false;
  std::array<Slot, 32> apb_{};    ///< 0x40000000, 16 KiB each
  std::array<Slot, 0x41> ahb_{};  ///< 0x50000000, by bits 23..16
  Slot xip_control_, ssi_;
  XipMemory* xip_ = nullptr;
  std::array<Slot, 2> sio_{};
  std::vector<std::uint8_t> sram_, rom_;
  std::vector<Fetcher> fetchers_;
};

}  // namespace lamplock::sim::chip
