// Flash pins (RP2040 datasheet, 2.19.6.2): used to move the chip select by hand.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct IoQspiRegisters {
  struct {
    Register status;
    Register ctrl;
  } gpio[6];  ///< SCLK, SS, SD0 to SD3
};
static_assert(offsetof(IoQspiRegisters, gpio[1].ctrl) == 0xc);

inline IoQspiRegisters& io_qspi() { return *reinterpret_cast<IoQspiRegisters*>(0x40018000); }

namespace io_qspi_field {
inline constexpr unsigned chip_select = 1;
inline constexpr std::uint32_t output_override = 3u << 8;
inline constexpr std::uint32_t output_low = 2u << 8;
inline constexpr std::uint32_t output_high = 3u << 8;
}  // namespace io_qspi_field

}  // namespace lamplock::rp2040
