// The USB boot loader on core 0 (RP2040 datasheet, 2.8.1, 2.8.3.1.4, 2.8.5): clocks and pins, the
// loop that calls flash functions, the interrupt that serves the USB controller.
#include "sim/chip/rom/rom_context.hpp"

#include <bit>

namespace lamplock::sim::chip {

using namespace rom;

namespace {

constexpr std::uint32_t reset_io_bank0 = 1u << 5, reset_pads_bank0 = 1u << 8,
                        reset_pll_usb = 1u << 13, reset_usb = 1u << 24;
constexpr std::uint32_t loader_blocks = reset_io_bank0 | reset_pads_bank0 | reset_usb;

// 2.16.7, 2.18.4, 2.15.7.
constexpr std::uint32_t xosc = 0x4002'4000, xosc_status = xosc + 4, xosc_startup = xosc + 0x0c;
constexpr std::uint32_t xosc_range = 0xaa0, xosc_enable = 0xfabu << 12;
constexpr std::uint32_t xosc_millisecond = 47;  ///< x 256 cycles of 12 MHz
constexpr std::uint32_t pll_usb = 0x4002'c000, pll_power = pll_usb + 4, pll_feedback = pll_usb + 8,
                        pll_dividers = pll_usb + 0x0c;
constexpr std::uint32_t pll_off = 1u << 0 | 1u << 5, pll_dividers_off = 1u << 3;
constexpr std::uint32_t pll_multiplier = 100, pll_divide_by_25 = 5u << 16 | 5u << 12;  // 48 MHz
constexpr std::uint32_t stable = 1u << 31;
constexpr std::uint32_t clk_sys = 0x4000'803c, clk_usb = 0x4000'8054;
constexpr std::uint32_t sys_auxiliary = 1, sys_pll_usb = 1u << 5, clock_enable = 1u << 11;

constexpr std::uint32_t gpio_control = 0x4001'4004, function_sio = 5;
constexpr std::uint32_t gpio_out_clear = 0xd000'0018, gpio_enable_set = 0xd000'0024;
constexpr std::uint32_t nvic_enable = 0xe000'e100, usb_interrupt = 1u << 5;

constexpr std::uint32_t flash_block = 1u << 16, block_erase = 0xd8;  ///< 64 KiB
constexpr std::uint32_t interrupt_cycles = 80;  ///< in addition to its accesses; assumed

}  // namespace

void BootRom::enter_boot_loader(Context& c) {
  // r0 = the pin that shows mass storage at work, r1 = interfaces not wanted; kept in r8, r10.
  state_ = RomState::bootsel;
  c.set(8, c.reg(0));
  c.set(10, c.reg(1));
  if ((c.reg(1) & UsbLoader::no_mass_storage) == 0 && not_modelled_)
    not_modelled_("ROM USB boot loader: mass storage (UF2) is not modelled, PICOBOOT only");
  c.store(xosc, xosc_range);
  c.store(xosc_startup, xosc_millisecond);
  c.store(xosc + set_alias, xosc_enable);
  c.leave();
}

void BootRom::loader_clocks(Context& c) {
  if ((c.load(xosc_status) & stable) == 0) {
    c.spend(6);
    return;
  }
  c.store(clk_ref, ref_crystal);
  c.store(watchdog_tick, tick_of_crystal);
  c.store(resets + set_alias, reset_pll_usb);
  c.store(resets + clear_alias, reset_pll_usb);
  c.store(pll_usb, 1);
  c.store(pll_feedback, pll_multiplier);
  c.store(pll_power + clear_alias, pll_off);
  c.leave();
}

void BootRom::loader_pll(Context& c) {
  if ((c.load(pll_usb) & stable) == 0) {
    c.spend(6);
    return;
  }
  c.store(pll_dividers, pll_divide_by_25);
  c.store(pll_power + clear_alias, pll_dividers_off);
  c.store(clk_sys, sys_pll_usb);
  c.store(clk_sys, sys_pll_usb | sys_auxiliary);
  c.store(clk_usb, clock_enable);
  c.store(resets + set_alias, reset_usb);
  c.store(resets + clear_alias, loader_blocks);
  c.leave();
}

void BootRom::loader_ready(Context& c) {
  const std::uint32_t activity = c.reg(8);
  if (std::has_single_bit(activity) && activity < 1u << 30) {
    // Low until mass storage is active, which it never is here.
    const auto pin = static_cast<std::uint32_t>(std::countr_zero(activity));
    c.store(gpio_out_clear, activity);
    c.store(gpio_enable_set, activity);
    c.store(gpio_control + 8 * pin, function_sio);
  }
  c.store(scs_vtor, loader_vectors_);
  LoaderView view(c);
  loader_.start(c.reg(10), view);
  c.set(0, nvic_enable);
  c.set(1, usb_interrupt);
  c.leave();
}

void BootRom::loader_task(Context& c) {
  // Interrupts are masked. Nothing to do: WFI follows; otherwise continue after the loop's three
  // instructions.
  constexpr std::uint32_t to_call = 3;
  c.spend(4);
  const std::optional<picoboot::Call> call = loader_.take_call();
  if (!call) {
    c.leave();
    return;
  }
  const auto index = static_cast<std::uint32_t>(call->service);
  const std::uint32_t vectors = loader_.vectors();
  const std::uint32_t function =
      vectors == 0 ? loader_functions_[index] : c.load(vectors + 4 + 4 * index);
  c.set(0, call->arguments[0]);
  c.set(1, call->arguments[1]);
  c.set(9, function | 1u);
  c.leave(to_call);
}

void BootRom::page_read(Context& c) {
  if (static_cast<Trap>(memory_[c.reg(pc)]) == Trap::page_read_start) {
    const std::uint32_t address = c.reg(0) & 0xff'ffffu;
    c.set(7, c.reg(1));
    begin_command(c, read_data, address, flash_page);
    c.leave();
    return;
  }
  if (put_get(c, Send::zeros, 4, true)) c.leave();
}

void BootRom::run_loader(Trap trap, Context& c) {
  LoaderView view(c);
  switch (trap) {
    case Trap::loader_scratch:  // the arguments of reset_to_usb_boot
      c.set(0, c.load(watchdog_scratch0));
      c.set(1, c.load(watchdog_scratch0 + 4));
      break;
    case Trap::loader_blocks:
      if ((c.load(reset_done) & loader_blocks) != loader_blocks) return;
      c.set(sp, UsbLoader::stack_top);
      break;
    case Trap::loader_done:
      loader_.returned(c.reg(0), view);
      break;
    case Trap::loader_interrupt:
      loader_.interrupt(view);
      c.spend(interrupt_cycles);
      break;
    // The loader's functions take fewer arguments than the public ones.
    case Trap::range_arguments:
      c.set(2, flash_block);
      c.set(3, block_erase);
      break;
    case Trap::sector_arguments:
      c.set(1, flash_sector);
      c.set(2, flash_block);
      c.set(3, block_erase);
      break;
    case Trap::page_arguments:
      c.set(2, flash_page);
      break;
    default:  // give_zero: success
      c.set(0, 0);
      break;
  }
  c.spend(2);
  c.leave();
}

}  // namespace lamplock::sim::chip
