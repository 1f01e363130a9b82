// Shared by the parts of the boot ROM: the traps, one step of a core, addresses.
//
// In:  the registers and the bus of a core. Out: changed registers and memory, and the cycles of a
//      step.
// Who: the sources of the boot ROM only.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/chip/rom/boot_rom.hpp"

namespace lamplock::sim::chip {

/// Registers (RP2040 datasheet, 2.2) and fields that several parts use.
namespace rom {
inline constexpr std::uint32_t set_alias = 0x2000, clear_alias = 0x3000;

inline constexpr std::uint32_t clk_ref = 0x4000'8030, ref_crystal = 2;
inline constexpr std::uint32_t resets = 0x4000'c000, reset_done = resets + 8;
inline constexpr std::uint32_t reset_io_qspi = 1u << 6, reset_pads_qspi = 1u << 9;

inline constexpr std::uint32_t watchdog = 0x4005'8000, watchdog_load = watchdog + 0x04,
                               watchdog_scratch0 = watchdog + 0x0c, watchdog_tick = watchdog + 0x2c;
inline constexpr std::uint32_t tick_of_crystal = 1u << 9 | 12;  ///< 1 us of 12 MHz

inline constexpr std::uint32_t qspi_select_control = 0x4001'800c;
// Forcing of chip select (OUTOVER).
inline constexpr std::uint32_t force_none = 0, force_low = 2u << 8, force_high = 3u << 8;

inline constexpr std::uint32_t ssi_ctrlr0 = 0x1800'0000, ssi_enable = ssi_ctrlr0 + 0x08,
                               ssi_data = ssi_ctrlr0 + 0x60;
inline constexpr std::uint32_t bytes_both_ways = 7u << 16;
inline constexpr std::uint32_t read_data = 0x03;  ///< to the flash
inline constexpr std::uint32_t flash_page = 256, flash_sector = 4096;

inline constexpr std::uint32_t scs_vtor = 0xe000'ed08, scs_scr = 0xe000'ed10;

inline constexpr unsigned sp = 13, lr = 14, pc = 15;
}  // namespace rom

/// Numbers of the traps: the immediate of UDF.
enum class BootRom::Trap : std::uint8_t {
  lookup = 1,
  popcount,
  reverse,
  leading_zeros,
  trailing_zeros,
  memset_start,
  memset_block,
  memset4_block,
  memcpy_start,
  memcpy_block,
  memcpy44_block,
  connect,
  connect_wait,
  exit_xip_start,
  exit_xip,
  erase_start,
  program_start,
  flash_write,
  flush,
  enter_xip,
  reset_usb,
  usb_boot,
  boot_start,
  boot_main,
  boot_attempt,
  boot_read,
  boot_check,
  boot_enter,
  wait_start,
  wait,
  float_start,
  float_wait,
  float_finish,
  loader_scratch,
  loader_crystal,
  loader_pll,
  loader_blocks,
  loader_ready,
  loader_task,
  loader_done,
  loader_interrupt,
  range_arguments,
  sector_arguments,
  page_arguments,
  page_read_start,
  page_read,
  give_zero,
  bad
};

/// One step of one core: registers, accesses, and the cycles they cost.
class BootRom::Context {
 public:
  Context(RomCore& core, Cycle now) : core_(core), now_(now) {}

  std::uint32_t reg(unsigned number) const { return core_.reg(number); }
  void set(unsigned number, std::uint32_t value) { core_.set_reg(number, value); }
  std::uint32_t load(std::uint32_t address, Width width = Width::word) {
    return take(core_.load(address, width, now_ + cycles_)).value;
  }
  void store(std::uint32_t address, std::uint32_t value, Width width = Width::word) {
    take(core_.store(address, value, width, now_ + cycles_));
  }
  void spend(std::uint32_t cycles) { cycles_ += cycles; }
  /// Continues after the trap, or `halfwords` further.
  void leave(std::uint32_t halfwords = 0) { set(rom::pc, core_.reg(rom::pc) + 2 + 2 * halfwords); }
  unsigned core_id() const { return core_.id(); }
  Step result() const { return {std::max(cycles_, 1u), fault_}; }

 private:
  Access take(Access access) {
    cycles_ += 2 + access.wait;  // LDR and STR take two cycles (Cortex-M0+ TRM, 3.3)
    fault_ = fault_ || access.fault;
    return access;
  }
  RomCore& core_;
  Cycle now_;
  std::uint32_t cycles_ = 0;
  bool fault_ = false;
};

/// A core's accesses in the form that the loader needs.
class BootRom::LoaderView final : public LoaderBus {
 public:
  explicit LoaderView(Context& context) : context_(context) {}
  std::uint32_t load(std::uint32_t address, Width width) override {
    return context_.load(address, width);
  }
  void store(std::uint32_t address, std::uint32_t value, Width width) override {
    context_.store(address, value, width);
  }

 private:
  Context& context_;
};

}  // namespace lamplock::sim::chip
