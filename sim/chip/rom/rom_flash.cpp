// The flash functions of the ROM (RP2040 datasheet, 2.8.3.1.3), step by step.
#include "sim/chip/rom/rom_context.hpp"

namespace lamplock::sim::chip {

using namespace rom;

namespace {

constexpr std::uint32_t io_qspi = 0x4001'8000;
constexpr std::uint32_t pads_sd0 = 0x4002'0008;  // VOLTAGE_SELECT, SCLK, SD0...
constexpr std::uint32_t xip_ctrl = 0x1400'0000;
constexpr std::uint32_t ssi_ctrlr1 = ssi_ctrlr0 + 0x04, ssi_ser = ssi_ctrlr0 + 0x10,
                        ssi_baud = ssi_ctrlr0 + 0x14, ssi_tx_level = ssi_ctrlr0 + 0x20,
                        ssi_rx_level = ssi_ctrlr0 + 0x24, ssi_status = ssi_ctrlr0 + 0x28,
                        ssi_icr = ssi_ctrlr0 + 0x48, ssi_spi_ctrlr0 = ssi_ctrlr0 + 0xf4;
constexpr std::uint32_t boot_divider = 6;  // 2.8.3.1.3: "fixed SCK clock divisor of /6"
constexpr std::uint32_t in_flight = 14;    // less than the receive FIFO's 16

// Flash commands.
constexpr std::uint32_t page_program = 0x02, read_status = 0x05, write_enable = 0x06,
                        sector_erase = 0x20;

// In r3, beside the command: the data at r7 are programmed.
constexpr std::uint32_t programming = 0x100;
// Steps of a flash operation, in r4.
enum Phase : std::uint32_t { next, enable, enable_wait, command, data, poll, poll_wait };
// Steps of leaving XIP, in r4.
enum ExitPhase : std::uint32_t { delay_low, clocks_low, delay_high, clocks_high, ones };
constexpr std::uint32_t exit_delay_steps = 256, exit_delay_cycles = 24;  // 6000 in all, assumed

}  // namespace

void BootRom::erase_start(Context& c) {
  c.set(1, c.reg(0) + c.reg(1));  // r1 = end
  c.set(3, c.reg(3) & 0xffu);
  c.set(4, next);
  c.leave();
}

void BootRom::program_start(Context& c) {
  const std::uint32_t source = c.reg(1);
  c.set(1, c.reg(0) + c.reg(2));
  c.set(7, source);
  c.set(2, 0);
  c.set(3, programming | page_program);
  c.set(4, next);
  c.leave();
}

void BootRom::connect_flash(Context& c) {
  constexpr std::uint32_t blocks = reset_io_qspi | reset_pads_qspi;
  const bool first = static_cast<Trap>(memory_[c.reg(pc)]) == Trap::connect;
  if (first) {
    c.store(resets + set_alias, blocks);
    c.store(resets + clear_alias, blocks);
    c.spend(8);
    c.leave();
    return;
  }
  c.spend(6);
  if ((c.load(reset_done) & blocks) != blocks) return;
  for (std::uint32_t pin = 0; pin < 6; ++pin) c.store(io_qspi + 8 * pin + 4, 0);
  c.leave();
}

void BootRom::begin_command(Context& c, std::uint32_t command, std::optional<std::uint32_t> address,
                            std::uint32_t more) {
  const std::uint32_t header = address ? 4 : 1;
  const std::uint32_t word = command << 24 | address.value_or(0);
  c.store(qspi_select_control, force_low);
  for (std::uint32_t i = 0; i < header; ++i) c.store(ssi_data, word >> (24 - 8 * i) & 0xffu);
  c.set(5, more);
  c.set(6, header + more);
  c.set(12, 0);
}

bool BootRom::put_get(Context& c, Send send, std::uint32_t skip, bool keep, std::uint32_t* last) {
  std::uint32_t to_send = c.reg(5), to_take = c.reg(6);
  const std::uint32_t flying = c.load(ssi_tx_level);
  const std::uint32_t arrived = c.load(ssi_rx_level);
  c.spend(timing_.flash_step);
  if (to_send != 0 && flying + arrived < in_flight) {
    std::uint32_t byte = send == Send::ones ? 0xffu : 0u;
    if (send == Send::memory) {
      byte = c.load(c.reg(7), Width::byte);
      c.set(7, c.reg(7) + 1);
    }
    c.store(ssi_data, byte);
    c.set(5, --to_send);
  }
  if (arrived != 0 && to_take != 0) {
    const std::uint32_t byte = c.load(ssi_data) & 0xffu;
    if (last != nullptr) *last = byte;
    c.set(6, --to_take);
    // The first `skip` bytes answer the command; r12 counts them.
    if (c.reg(12) < skip)
      c.set(12, c.reg(12) + 1);
    else if (keep) {
      c.store(c.reg(7), byte, Width::byte);
      c.set(7, c.reg(7) + 1);
    }
  }
  if (to_send != 0 || to_take != 0) return false;
  c.store(qspi_select_control, force_high);
  return true;
}

void BootRom::exit_xip_start(Context& c) {
  c.store(ssi_enable, 0);
  c.load(ssi_status);
  c.load(ssi_icr);
  c.store(ssi_baud, boot_divider);
  c.store(ssi_ctrlr0, bytes_both_ways);
  c.store(ssi_ser, 1);
  c.store(ssi_enable, 1);
  const std::uint32_t pad = c.load(pads_sd0);
  c.set(7, pad);
  c.store(qspi_select_control, force_high);
  // Data lines cut off and pulled low, later high (2.8.1.2).
  for (std::uint32_t i = 0; i < 4; ++i) c.store(pads_sd0 + 4 * i, (pad & ~0x8cu) | 0x84u);
  c.set(4, delay_low);
  c.set(5, exit_delay_steps);
  c.leave();
}

void BootRom::exit_xip(Context& c) {
  const std::uint32_t phase = c.reg(4), pad = c.reg(7);
  const auto pads = [&](std::uint32_t value) {
    for (std::uint32_t i = 0; i < 4; ++i) c.store(pads_sd0 + 4 * i, value);
  };
  const auto begin = [&](std::uint32_t new_phase, std::uint32_t count) {
    c.set(4, new_phase);
    c.set(5, count);
    c.set(6, count);
    c.set(12, 0);
  };
  switch (phase) {
    case delay_low:
    case delay_high:
      c.spend(exit_delay_cycles);
      c.set(5, c.reg(5) - 1);
      if (c.reg(5) == 0) begin(phase + 1, 4);
      return;
    case clocks_low:
      if (!put_get(c, Send::zeros, 0, false)) return;
      c.store(qspi_select_control, force_low);
      pads((pad & ~0x8cu) | 0x88u);
      begin(delay_high, exit_delay_steps);
      return;
    case clocks_high:
      if (!put_get(c, Send::zeros, 0, false)) return;
      pads(pad);
      c.store(qspi_select_control, force_low);
      begin(ones, 2);
      return;
    default:
      if (!put_get(c, Send::ones, 0, false)) return;
      c.store(qspi_select_control, force_none);
      c.leave();
      return;
  }
}

void BootRom::next_write(Context& c) {
  const std::uint32_t at = c.reg(0), end = c.reg(1);
  if (at >= end) {
    c.leave();
    return;
  }
  c.set(4, enable);
  c.spend(8);
}

void BootRom::flash_write(Context& c) {
  // r0 = address, r1 = end, r2 = block size, r3 = block command or programming, r7 = data.
  const bool programs = (c.reg(3) & programming) != 0;
  const std::uint32_t at = c.reg(0), block = c.reg(2);
  const bool whole_block = !programs && (at & (block - 1)) == 0 && c.reg(1) - at >= block;
  const std::uint32_t step = programs ? flash_page : whole_block ? block : flash_sector;
  switch (c.reg(4)) {
    case next:
      next_write(c);
      return;
    case enable:
      begin_command(c, write_enable, std::nullopt, 0);
      c.set(4, enable_wait);
      return;
    case enable_wait:
      if (put_get(c, Send::zeros, 1, false)) c.set(4, command);
      return;
    case command:
      begin_command(c,
                    programs      ? page_program
                    : whole_block ? c.reg(3)
                                  : sector_erase,
                    at, programs ? flash_page : 0);
      c.set(4, data);
      return;
    case data:
      if (put_get(c, programs ? Send::memory : Send::zeros, 4, false)) c.set(4, poll);
      return;
    case poll:
      begin_command(c, read_status, std::nullopt, 1);
      c.set(4, poll_wait);
      return;
    default: {
      std::uint32_t status = 0;
      if (!put_get(c, Send::zeros, 1, false, &status)) return;
      if ((status & 1u) != 0) {
        c.set(4, poll);
        return;
      }
      c.set(0, at + step);
      c.set(4, next);
      return;
    }
  }
}

void BootRom::flush_cache(Context& c) {
  c.store(xip_ctrl + 4, 1);
  c.load(xip_ctrl + 4);
  c.store(xip_ctrl + set_alias, 1);
  c.store(qspi_select_control, force_none);
  c.spend(12);
  c.leave();
}

void BootRom::enter_command_xip(Context& c) {
  c.store(ssi_enable, 0);
  c.store(ssi_ctrlr0, 31u << 16 | 3u << 8);                      // 32 bits, command out and data in
  c.store(ssi_spi_ctrlr0, read_data << 24 | 2u << 8 | 6u << 2);  // 8 bits of command, 24 of address
  c.store(ssi_ctrlr1, 0);
  c.store(ssi_enable, 1);
  c.spend(12);
  c.leave();
}

}  // namespace lamplock::sim::chip
