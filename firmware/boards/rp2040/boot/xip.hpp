// How the flash is read as memory: one function for the second-stage boot and for the flash driver.
#pragma once

#include "firmware/boards/rp2040/registers/ssi.hpp"

namespace lamplock::rp2040 {

/// Sets the SSI up for execute-in-place with the plain read command, 03h, which every serial flash
/// has. The flash must be in its command state, as the ROM leaves it. What is in a hurry is copied
/// to SRAM, and the cache keeps the rest: speed matters little. 31.25 MHz at clk_sys 125 MHz, below
/// the 50 MHz of 03h.
[[gnu::always_inline]] inline void start_xip() {
  constexpr std::uint32_t read_data = 0x03;
  SsiRegisters& s = ssi();
  s.ssienr = 0;
  s.baudr = 4;
  // Half a period of SCK is 16 ns: too short for flash and pads together. One clk_sys more.
  s.rx_sample_dly = 1;
  s.ctrlr0 = ssi_field::one_wire_each_way | ssi_field::dfs_32_bits | ssi_field::tmod_eeprom_read;
  s.ctrlr1 = 0;  // one data frame a read
  s.spi_ctrlr0 = (read_data << ssi_field::instruction_shift) | ssi_field::address_24_bits |
                 ssi_field::instruction_8_bits;
  s.ser = 1;
  s.ssienr = 1;
}

}  // namespace lamplock::rp2040
