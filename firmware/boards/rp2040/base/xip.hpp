// Reading flash as memory: one function for the second-stage boot and for the flash driver.
#pragma once

#include "firmware/boards/rp2040/registers/ssi.hpp"
#include "shared/units.hpp"

namespace lamplock::rp2040 {

/// Sets the SSI up for execute-in-place with fast read, dual output, 3Bh: command, address and
/// eight wait clocks on one wire, data on two. Serial flashes have it at 80 MHz and more (W25Q16JV
/// datasheet, 8.2.8 and 9.6: 133 MHz), and unlike the quad commands it needs no bit set in the
/// flash beforehand. 62.5 MHz at clk_sys 125 MHz, where a miss of the cache is 72 clocks of the
/// flash, 144 of ours; 50 MHz at 200 MHz. The flash must be in its command state, as the ROM leaves
/// it.
[[gnu::always_inline]] inline void start_xip() {
  constexpr std::uint32_t fast_read_dual_output = 0x3b;
  constexpr std::uint32_t max_flash_hz = 80'000'000;
  constexpr std::uint32_t even_divisor = (clock_hz + 2 * max_flash_hz - 1) / (2 * max_flash_hz) * 2;
  SsiRegisters& s = ssi();
  s.ssienr = 0;
  s.baudr = even_divisor;
  // Half a period of SCK is 8 or 10 ns: too short for flash and pads together. Adds one clk_sys.
  s.rx_sample_dly = 1;
  s.ctrlr0 = ssi_field::data_on_two_wires | ssi_field::dfs_32_bits | ssi_field::tmod_eeprom_read;
  s.ctrlr1 = 0;  // one data frame a read
  s.spi_ctrlr0 = (fast_read_dual_output << ssi_field::instruction_shift) |
                 ssi_field::address_24_bits | ssi_field::instruction_8_bits |
                 ssi_field::wait_8_clocks;
  s.ser = 1;
  s.ssienr = 1;
}

}  // namespace lamplock::rp2040
