// The start of the chip by the ROM (RP2040 datasheet, 2.8.1, 2.8.2), and the entry into the boot
// loader.
#include "sim/chip/rom/rom_context.hpp"

#include <array>
#include <span>

#include "shared/boards/boot2_crc32.hpp"
#include "sim/chip/rom/rom_reboot.hpp"

namespace lamplock::sim::chip {

using namespace rom;

namespace {

constexpr std::uint32_t syscfg = 0x4000'4000, clocks = 0x4000'8000, chip_reset = 0x4006'4008;
constexpr std::uint32_t sio = 0xd000'0000;

constexpr std::uint32_t reset_syscfg = 1u << 18, reset_timer = 1u << 21;
constexpr std::uint32_t rescue_flag = 1u << 24;
constexpr std::uint32_t sram_end = 0x2004'2000;
constexpr int flash_attempts = 128;

// Steps of core 1's launch, in r4; r5 = word to send.
enum WaitPhase : std::uint32_t {
  drain,
  send,
  receive_1,
  receive_vtor,
  receive_sp,
  receive_entry,
  launch
};
constexpr std::uint32_t fifo_status = sio + 0x50, fifo_write = sio + 0x54, fifo_read = sio + 0x58;
constexpr std::uint32_t fifo_valid = 1, fifo_ready = 2;

}  // namespace

void BootRom::boot_main(Context& c) {
  // Blocks that the ROM resets; the BOOTSEL button is read nine times, the majority counts.
  c.store(resets + set_alias, reset_io_qspi | reset_pads_qspi | reset_timer);
  c.store(resets + clear_alias, reset_io_qspi | reset_pads_qspi | reset_timer);
  c.spend(1200 + 9 * 15);
  if ((pins_.inputs() >> QspiPins::ss & 1u) != 0)
    c.leave();
  else
    enter_loader_cold(c);
}

void BootRom::enter_loader_cold(Context& c) {
  c.set(0, 0);  // no pin, all interfaces
  c.set(1, 0);
  c.set(pc, usb_boot_);
}

void BootRom::usb_boot(Context& c) {
  // By way of the watchdog, so that everything is reset.
  constexpr std::uint32_t delay_ms = 10;  // published source of the ROM
  c.store(watchdog_scratch0, c.reg(0));
  c.store(watchdog_scratch0 + 4, c.reg(1));
  LoaderView view(c);
  reboot(view, usb_reset_, sram_end, delay_ms);
  c.spend(60);
  c.leave();
}

void BootRom::boot_start(Context& c) {
  if (c.core_id() != 0) {
    c.set(pc, wait_);
    c.spend(6);
    return;
  }
  state_ = RomState::booting;
  c.store(clocks + 0xa0, 0xffff'ffff);  // WAKE_EN0, WAKE_EN1
  c.store(clocks + 0xa4, 0xffff'ffff);
  // No NMI for either core. The real ROM stores even where SYSCFG is still held in reset: such a
  // store is lost and not the image's fault, so it is omitted here.
  if ((c.load(resets) & reset_syscfg) == 0) {
    c.store(syscfg, 0);
    c.store(syscfg + 4, 0);
  }
  if ((c.load(chip_reset) & rescue_flag) != 0) {
    c.store(chip_reset, rescue_flag);
    state_ = RomState::rescue;
    c.set(pc, dead_);
    return;
  }
  std::array<std::uint32_t, 4> scratch{};
  for (std::uint32_t i = 0; i < 4; ++i) scratch[i] = c.load(boot_vector + 4 * i);
  c.spend(12);
  if (scratch[0] != boot_magic || (scratch[1] ^ scratch[3]) != 0u - boot_magic) {
    c.leave();
    return;
  }
  c.store(boot_vector, 0);
  c.set(sp, scratch[2] & ~3u);
  c.set(lr, main_ | 1u);  // a return leads to the ordinary start
  c.set(pc, scratch[3] & ~1u);
  state_ = RomState::running;
}

void BootRom::boot_attempt(Context& c) {
  // Each attempt tries the next of the four clock polarities and phases.
  const std::uint32_t attempt = c.reg(8);
  c.store(ssi_enable, 0);
  c.store(ssi_ctrlr0, bytes_both_ways | (attempt & 3u) << 6);
  c.store(ssi_enable, 1);
  begin_command(c, read_data, 0, boot2_size);
  c.set(7, boot2_address);
  c.leave();
}

void BootRom::boot_read(Context& c) {
  if (put_get(c, Send::zeros, 4, true)) c.leave();
}

void BootRom::boot_check(Context& c) {
  std::array<std::uint8_t, boot2_size> boot2{};
  const std::uint32_t before = c.result().cycles;
  for (std::uint32_t i = 0; i < boot2_size; ++i)
    boot2[i] = static_cast<std::uint8_t>(c.load(boot2_address + i, Width::byte));
  const std::uint32_t spent = c.result().cycles - before;
  if (spent < timing_.boot2_checksum) c.spend(timing_.boot2_checksum - spent);
  std::uint32_t wanted = 0;
  for (std::uint32_t i = 4; i-- > 0;) wanted = wanted << 8 | boot2[boot2_size - 4 + i];
  if (boards::boot2_crc32(std::span(boot2).first(boot2_size - 4)) == wanted) {
    c.leave();
    return;
  }
  const std::uint32_t attempt = c.reg(8) + 1;
  if (attempt == 1 && on_bad_boot_block) on_bad_boot_block();
  c.set(8, attempt);
  if (attempt < flash_attempts)
    c.set(pc, attempt_);
  else
    enter_loader_cold(c);
}

void BootRom::wait_for_vector(Context& c) {
  // The words 0, 0, 1, VTOR, SP, entry come from core 0 and each is answered (2.8.2).
  constexpr std::uint32_t to_wfe = 0, to_sev = 2;
  const std::uint32_t status = c.load(fifo_status);
  const std::uint32_t phase = c.reg(4) & 0xffu;
  c.spend(6);
  const auto answer = [&](std::uint32_t word, std::uint32_t then) {
    c.set(5, word);
    c.set(4, send | then << 8);
  };
  switch (phase) {
    case drain:
      if ((status & fifo_valid) != 0)
        c.load(fifo_read);
      else
        answer(0, receive_1);
      return;
    case send:
      if ((status & fifo_ready) == 0) {
        c.leave(to_wfe);
        return;
      }
      c.store(fifo_write, c.reg(5));
      c.set(4, c.reg(4) >> 8);
      c.leave(to_sev);
      return;
    case launch:
      c.store(scs_scr, 0);
      c.set(lr, dead_ | 1u);
      c.set(pc, c.reg(5) & ~1u);
      return;
    default:
      break;
  }
  if ((status & fifo_valid) == 0) {
    c.leave(to_wfe);
    return;
  }
  const std::uint32_t word = c.load(fifo_read);
  if (word == 0 || (phase == receive_1 && word != 1)) {
    c.set(4, drain);
    return;
  }
  if (phase == receive_vtor) c.store(scs_vtor, word);
  if (phase == receive_sp) c.set(sp, word & ~3u);
  answer(word, phase + 1);
}

void BootRom::boot_enter(Context& c) {
  state_ = RomState::running;
  c.set(0, boot2_address + 1);
  c.set(lr, 0);  // boot2 must find its target by itself
  c.set(pc, boot2_address);
  c.spend(5);
}

void BootRom::wait_start(Context& c) {
  c.store(scs_scr, 4);  // SLEEPDEEP
  c.set(4, drain);
  c.leave();
}

}  // namespace lamplock::sim::chip
