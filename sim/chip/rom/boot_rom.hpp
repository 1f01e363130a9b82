// The boot ROM's behaviour (RP2040 datasheet, 2.8), rewritten: it contains nothing of the real ROM.
//
// In:  a core that executes a trap at an address in the ROM; the registers and the bus of that
//      core.
// Out: the image of 16 KiB with vectors, tables and short Thumb frames; what the functions do, in
//      steps of some tens of cycles, through the same registers as the real ROM (SSI, QSPI pins,
//      SIO FIFO, watchdog), so that time, flash and interrupts behave.
// Who: a core, when it executes an undefined instruction (UDF #n) inside the ROM, calls step().
//
// A function's state is in the core's registers and on its stack, as on the chip: it may be
// interrupted between any two steps, and both cores may be inside at once.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/flash/qspi_pins.hpp"
#include "sim/chip/rom/soft_float.hpp"
#include "sim/chip/rom/usb_loader.hpp"

namespace lamplock::sim::chip {

/// The ROM's interface to a core.
class RomCore {
 public:
  virtual ~RomCore() = default;
  /// r0..r12, 13 = current stack pointer, 14 = link, 15 = address of the trap (a write jumps).
  virtual std::uint32_t reg(unsigned number) const = 0;
  virtual void set_reg(unsigned number, std::uint32_t value) = 0;
  /// An aligned access, the core's own registers at 0xe0000000 included.
  virtual Access load(std::uint32_t address, Width width, Cycle at) = 0;
  virtual Access store(std::uint32_t address, std::uint32_t value, Width width, Cycle at) = 0;
  /// 0 or 1.
  virtual unsigned id() const = 0;
};

/// Cycles of the functions. The datasheet gives none that are exact; the averages over all inputs
/// are those noted in the published source of the ROM, the rest is assumed.
struct RomTiming {
  std::uint32_t popcount = 20;
  std::uint32_t reverse = 13;
  std::uint32_t leading_zeros = 15;
  std::uint32_t trailing_zeros = 14;
  std::uint32_t lookup_entry = 11;        ///< per table entry looked at
  std::uint32_t copy_start = 20;          ///< memset, memcpy: entry and exit
  std::uint32_t copy_block = 18;          ///< 16 bytes by LDM/STM
  std::uint32_t copy_byte = 7;            ///< LDRB, STRB, SUB, BNE
  std::uint32_t flash_step = 14;          ///< around a status read or a byte moved
  std::uint32_t boot2_checksum = 13'500;  ///< from "about 4 ms an attempt at 6.5 MHz"
  std::uint32_t float_step = 8;           ///< an interrupt is taken within so many cycles
  /// Of the functions in 'SF' and 'SD', in their order. The datasheet has a table of averages
  /// (2.8.3.2.2); these are near it, of version 2, and not for exact work.
  std::array<std::uint16_t, soft_float::functions> float_cycles = {
      71,  74,  58,  71,  25,  25, 63,  40, 39, 39, 38, 55, 53, 54, 53, 587,
      577, 653, 600, 524, 789, 25, 599, 62, 63, 48, 46, 53, 53, 42, 41, 15};
  std::array<std::uint16_t, soft_float::functions> double_cycles = {
      91,   95,   155,  183, 39,  39, 169,  75, 74, 63, 62, 69, 68, 64, 62, 1617,
      1618, 1891, 2200, 804, 428, 39, 2168, 55, 56, 50, 49, 54, 53, 52, 52, 23};
};

/// Where a chip is in its start.
enum class RomState : std::uint8_t {
  reset,    ///< no instruction of the ROM has run since the reset
  booting,  ///< in the ROM
  running,  ///< in boot2 or later, or started by a boot vector
  bootsel,  ///< in the USB boot loader (usb_loader.hpp)
  rescue,   ///< halted by the rescue flag
};

class BootRom {
 public:
  static constexpr std::uint32_t boot2_address = 0x2004'1f00;
  static constexpr std::uint32_t boot2_size = 256;
  /// An undefined instruction that is not a trap.
  static constexpr std::uint32_t fault_address = 0x3ffe;

  /// Versions of the ROM: 1 in stepping B0, 2 in B1, 3 in B2.
  static constexpr unsigned latest_version = 3;

  /// Writes the image into `memory` (16 KiB, Bus::rom()). `pins` has the state of BOOTSEL.
  BootRom(std::span<std::uint8_t> memory, const QspiPins& pins, NotModelled not_modelled,
          unsigned version = latest_version);
  BootRom(const BootRom&) = delete;
  BootRom& operator=(const BootRom&) = delete;

  struct Step {
    std::uint32_t cycles = 1;  ///< all of it, waits of the accesses included
    bool fault = false;        ///< an access failed: the core takes a HardFault
  };
  /// Whether an address holds a trap of the ROM.
  bool is_trap(std::uint32_t address) const;
  /// Executes the trap at r15 in the cycle `now`; leaves the next address in r15.
  Step step(RomCore& core, Cycle now);

  /// The ROM has read a boot block whose checksum is wrong; it tries again, then waits in its USB
  /// boot loader. Called for the first attempt of a start: the flash does not change in between.
  std::function<void()> on_bad_boot_block;

  RomState state() const { return state_; }
  /// The chip has been reset.
  void reset() { state_ = RomState::reset; }
  /// Address of a function or datum (with the Thumb bit for functions); 0 if there is none.
  std::uint32_t function(char first, char second) const;
  std::uint32_t datum(char first, char second) const;

 private:
  enum class Trap : std::uint8_t;
  class Context;
  class Assembler;
  class LoaderView;

  struct Entry;
  struct Shared;

  void build();
  Shared build_functions(Assembler& code, std::vector<Entry>& table);
  void build_wait(Assembler& code, std::vector<Entry>& table);
  std::uint32_t build_start(Assembler& code, const Shared& shared);
  std::vector<Entry> build_data(Assembler& code);
  std::uint32_t build_float(Assembler& code, soft_float::Precision precision);
  void build_loader(Assembler& code, const Shared& shared);
  void run(Trap trap, Context& context);
  void bit_function(Trap trap, Context& context);
  void lookup(Context& context);
  void fill_start(Context& context, bool copy);
  void fill_block(Context& context, bool copy, bool words);
  void connect_flash(Context& context);
  void exit_xip_start(Context& context);
  void exit_xip(Context& context);
  void erase_start(Context& context);
  void program_start(Context& context);
  void flash_write(Context& context);
  void next_write(Context& context);
  void flush_cache(Context& context);
  void enter_command_xip(Context& context);
  void usb_boot(Context& context);
  void float_start(Context& context);
  void float_wait(Context& context);
  void float_finish(Context& context);
  void run_loader(Trap trap, Context& context);
  void enter_boot_loader(Context& context);
  void loader_clocks(Context& context);
  void loader_pll(Context& context);
  void loader_ready(Context& context);
  void loader_task(Context& context);
  void page_read(Context& context);
  void boot_start(Context& context);
  void boot_main(Context& context);
  void enter_loader_cold(Context& context);
  void boot_attempt(Context& context);
  void boot_read(Context& context);
  void boot_check(Context& context);
  void boot_enter(Context& context);
  void wait_start(Context& context);
  void wait_for_vector(Context& context);
  /// Selects the flash and sends a command, with 24 bits of address if given; put_get() moves the
  /// `more` bytes after it. r5 = bytes to send, r6 = bytes to receive, r12 = received.
  void begin_command(Context& context, std::uint32_t command, std::optional<std::uint32_t> address,
                     std::uint32_t more);
  /// Moves a byte each way; true when none is left. `last`: the byte received, if any.
  enum class Send : std::uint8_t { zeros, ones, memory };
  bool put_get(Context& context, Send send, std::uint32_t skip, bool keep,
               std::uint32_t* last = nullptr);

  std::span<std::uint8_t> memory_;
  const QspiPins& pins_;
  NotModelled not_modelled_;
  const RomTiming timing_{};
  unsigned version_;
  UsbLoader loader_;
  RomState state_ = RomState::reset;
  std::uint32_t function_table_ = 0, data_table_ = 0;
  std::uint32_t main_ = 0, dead_ = 0, usb_boot_ = 0, usb_reset_ = 0, wait_ = 0, attempt_ = 0;
  std::uint32_t loader_vectors_ = 0;
  std::array<std::uint32_t, picoboot::services> loader_functions_{};
};

}  // namespace lamplock::sim::chip
