// USB controller in device mode (RP2040 datasheet, 4.1.3 registers, 4.1.2.5 DPRAM).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"

namespace lamplock::rp2040 {

struct UsbRegisters {
  Register addr_endp;
  Register host_addr_endp[15];  ///< host mode only
  Register main_ctrl;
  Register sof_wr;
  Register sof_rd;  ///< frame number; reading it ends the DEV_SOF interrupt
  Register sie_ctrl;
  Register sie_status;
  Register int_ep_ctrl;
  Register buff_status;  ///< bit 2n endpoint n IN, 2n + 1 OUT
  Register buff_cpu_should_handle;
  Register ep_abort;
  Register ep_abort_done;
  Register ep_stall_arm;
  Register nak_poll;
  Register ep_status_stall_nak;
  Register usb_muxing;
  Register usb_pwr;
  Register usbphy_direct;
  Register usbphy_direct_override;
  Register usbphy_trim;
  Register reserved;
  Register intr;
  Register inte;
  Register intf;
  Register ints;
};
static_assert(offsetof(UsbRegisters, main_ctrl) == 0x40);
static_assert(offsetof(UsbRegisters, sie_status) == 0x50);
static_assert(offsetof(UsbRegisters, buff_status) == 0x58);
static_assert(offsetof(UsbRegisters, ep_stall_arm) == 0x68);
static_assert(offsetof(UsbRegisters, usb_muxing) == 0x74);
static_assert(offsetof(UsbRegisters, usbphy_direct) == 0x7c);
static_assert(offsetof(UsbRegisters, ints) == 0x98);

inline UsbRegisters& usb_registers() { return *reinterpret_cast<UsbRegisters*>(0x50110000); }

/// Half of a buffer control word: one of the two buffers of an endpoint. The DPRAM accepts narrow
/// writes, so that one buffer can be armed while the controller uses the other.
using BufferHalf = volatile std::uint16_t;

/// The 4 KiB shared with the controller. No atomic aliases here.
struct UsbDpram {
  struct EndpointControl {
    Register in;
    Register out;
  };
  struct BufferControl {
    BufferHalf in[2];
    BufferHalf out[2];
  };
  Register setup[2];                     ///< last SETUP packet
  EndpointControl endpoint_control[15];  ///< endpoint 1 first
  BufferControl buffer_control[16];      ///< endpoint 0 first
  Register control_buffer[2][16];        ///< endpoint 0, both directions
  Register data[(4096 - 0x180) / 4];
};
static_assert(offsetof(UsbDpram, endpoint_control) == 0x8);
static_assert(offsetof(UsbDpram, buffer_control) == 0x80);
static_assert(offsetof(UsbDpram, control_buffer) == 0x100);
static_assert(offsetof(UsbDpram, data) == 0x180);
static_assert(sizeof(UsbDpram) == 4096);

inline UsbDpram& usb_dpram() { return *reinterpret_cast<UsbDpram*>(0x50100000); }

namespace usb_field {
inline constexpr std::uint32_t controller_enable = 1u << 0;  // MAIN_CTRL

inline constexpr std::uint32_t pullup_enable = 1u << 16;    // SIE_CTRL
inline constexpr std::uint32_t ep0_each_buffer = 1u << 29;  // SIE_CTRL: EP0_INT_1BUF

inline constexpr std::uint32_t status_suspended = 1u << 4;  // SIE_STATUS
inline constexpr std::uint32_t status_resume = 1u << 11;    // SIE_STATUS
inline constexpr std::uint32_t status_setup = 1u << 17;     // SIE_STATUS: SETUP_REC
inline constexpr std::uint32_t status_reset = 1u << 19;     // SIE_STATUS: BUS_RESET
inline constexpr unsigned line_state_shift = 2;             // SIE_STATUS
inline constexpr std::uint32_t line_state_mask = 3;
inline constexpr std::uint32_t line_state_se0 = 0;
/// CRC, bit stuffing, overflow, time-out, data sequence (SIE_STATUS).
inline constexpr std::uint32_t status_errors = 1u << 24 | 1u << 25 | 1u << 26 | 1u << 27 | 1u << 31;

inline constexpr std::uint32_t stall_arm_ep0 = 3;  // EP_STALL_ARM: both directions

inline constexpr std::uint32_t to_phy = 1u << 0;          // USB_MUXING
inline constexpr std::uint32_t to_digital_pad = 1u << 2;  // USB_MUXING
inline constexpr std::uint32_t softcon = 1u << 3;         // USB_MUXING

inline constexpr std::uint32_t vbus_detect = 1u << 2;           // USB_PWR
inline constexpr std::uint32_t vbus_detect_override = 1u << 3;  // USB_PWR

inline constexpr std::uint32_t dp_pullup = 1u << 1;           // USBPHY_DIRECT
inline constexpr std::uint32_t dp_pullup_override = 1u << 2;  // USBPHY_DIRECT_OVERRIDE

// INTR, INTE, INTF, INTS
inline constexpr std::uint32_t int_buffer = 1u << 4;
inline constexpr std::uint32_t int_bus_reset = 1u << 12;
inline constexpr std::uint32_t int_suspend = 1u << 14;
inline constexpr std::uint32_t int_resume = 1u << 15;
inline constexpr std::uint32_t int_setup = 1u << 16;
inline constexpr std::uint32_t int_sof = 1u << 17;

// Endpoint control (datasheet, 4.1.2.5.2); bits 15:6 are the offset of the buffer in the DPRAM.
inline constexpr std::uint32_t endpoint_enable = 1u << 31;
inline constexpr std::uint32_t endpoint_double = 1u << 30;
inline constexpr std::uint32_t endpoint_each_buffer = 1u << 29;
inline constexpr std::uint32_t endpoint_bulk = 2u << 26;
inline constexpr std::uint32_t endpoint_interrupt = 3u << 26;

// Half of a buffer control word (4.1.2.5.3). STALL and RESET_SELECT are in buffer 0's half and
// apply to both.
inline constexpr std::uint16_t buffer_full = 1u << 15;
inline constexpr std::uint16_t buffer_last = 1u << 14;
inline constexpr std::uint16_t buffer_data1 = 1u << 13;
inline constexpr std::uint16_t buffer_reset_select = 1u << 12;
inline constexpr std::uint16_t buffer_stall = 1u << 11;
inline constexpr std::uint16_t buffer_available = 1u << 10;
inline constexpr std::uint16_t buffer_length = 0x3ff;
}  // namespace usb_field

}  // namespace lamplock::rp2040
