// Synchronous serial interface of the flash (RP2040 datasheet, 4.10.13).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct SsiRegisters {
  Register ctrlr0;
  Register ctrlr1;
  Register ssienr;
  Register mwcr;
  Register ser;
  Register baudr;
  Register txftlr;
  Register rxftlr;
  Register txflr;
  Register rxflr;
  Register sr;
  Register interrupts_and_dma[13];
  Register dr0;
  Register dr_more[35];
  Register rx_sample_dly;
  Register spi_ctrlr0;
  Register txd_drive_edge;
};
static_assert(offsetof(SsiRegisters, sr) == 0x28);
static_assert(offsetof(SsiRegisters, dr0) == 0x60);
static_assert(offsetof(SsiRegisters, rx_sample_dly) == 0xf0);
static_assert(offsetof(SsiRegisters, spi_ctrlr0) == 0xf4);

inline SsiRegisters& ssi() { return *reinterpret_cast<SsiRegisters*>(0x18000000); }

namespace ssi_field {
inline constexpr std::uint32_t tmod_eeprom_read = 3u << 8;    // CTRLR0: command out, then data in
inline constexpr std::uint32_t dfs_32_bits = 31u << 16;       // CTRLR0: data frame size less one
inline constexpr std::uint32_t data_on_two_wires = 1u << 21;  // CTRLR0: SPI_FRF
inline constexpr std::uint32_t address_24_bits = 6u << 2;     // SPI_CTRLR0: in units of 4 bits
inline constexpr std::uint32_t instruction_8_bits = 2u << 8;  // SPI_CTRLR0
inline constexpr std::uint32_t wait_8_clocks = 8u << 11;  // SPI_CTRLR0: between address and data
inline constexpr std::uint32_t instruction_shift = 24;    // SPI_CTRLR0: XIP_CMD
}  // namespace ssi_field

}  // namespace lamplock::rp2040
