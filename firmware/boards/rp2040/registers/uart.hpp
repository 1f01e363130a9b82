// UARTs, Arm PL011 (RP2040 datasheet, 4.2.8).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct UartRegisters {
  Register dr;   ///< a read removes a byte and its error bits from the FIFO
  Register rsr;  ///< a write clears the overrun
  Register reserved0[4];
  Register fr;
  Register reserved1;
  Register ilpr;
  Register ibrd;
  Register fbrd;  ///< in 1/64
  Register lcr_h;
  Register cr;
  Register ifls;
  Register imsc;
  Register ris;
  Register mis;
  Register icr;
  Register dmacr;
};
static_assert(offsetof(UartRegisters, fr) == 0x18);
static_assert(offsetof(UartRegisters, ibrd) == 0x24);
static_assert(offsetof(UartRegisters, lcr_h) == 0x2c);
static_assert(offsetof(UartRegisters, cr) == 0x30);
static_assert(offsetof(UartRegisters, imsc) == 0x38);
static_assert(offsetof(UartRegisters, icr) == 0x44);

/// UART 0 or 1.
inline UartRegisters& uart_registers(unsigned number) {
  return number == 0 ? *reinterpret_cast<UartRegisters*>(0x40034000)
                     : *reinterpret_cast<UartRegisters*>(0x40038000);
}

namespace uart_field {
inline constexpr std::uint32_t data_framing_error = 1u << 8;  // DR
inline constexpr std::uint32_t data_parity_error = 1u << 9;   // DR
inline constexpr std::uint32_t data_break_error = 1u << 10;   // DR
inline constexpr std::uint32_t data_overrun = 1u << 11;       // DR: bytes were lost before this one

inline constexpr std::uint32_t flag_busy = 1u << 3;           // FR
inline constexpr std::uint32_t flag_receive_empty = 1u << 4;  // FR
inline constexpr std::uint32_t flag_send_full = 1u << 5;      // FR

inline constexpr std::uint32_t fifo_enable = 1u << 4;           // LCR_H
inline constexpr std::uint32_t eight_bits = 3u << 5;            // LCR_H
inline constexpr std::uint32_t uart_enable = 1u << 0;           // CR
inline constexpr std::uint32_t send_enable = 1u << 8;           // CR
inline constexpr std::uint32_t receive_enable = 1u << 9;        // CR
inline constexpr std::uint32_t send_below_eighth = 0u;          // IFLS: 4 of 32 bytes left
inline constexpr std::uint32_t receive_from_quarter = 1u << 3;  // IFLS: 8 of 32 bytes received

// IMSC, RIS, MIS, ICR
inline constexpr std::uint32_t int_receive = 1u << 4;
inline constexpr std::uint32_t int_send = 1u << 5;
inline constexpr std::uint32_t int_receive_timeout = 1u << 6;
inline constexpr std::uint32_t int_overrun = 1u << 10;
}  // namespace uart_field

}  // namespace lamplock::rp2040
