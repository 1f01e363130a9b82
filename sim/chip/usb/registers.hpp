// Registers and DPRAM words of the USB controller (RP2040 datasheet, 4.1.2.5 and 4.1.4), written
// for this simulator independently of the firmware.
#pragma once

#include <cstdint>

namespace lamplock::sim::chip::usb {

/// Offsets from 0x50110000.
namespace reg {
inline constexpr std::uint32_t addr_endp = 0x00;
inline constexpr std::uint32_t addr_endp1 = 0x04;
inline constexpr std::uint32_t addr_endp15 = 0x3c;
inline constexpr std::uint32_t main_ctrl = 0x40;
inline constexpr std::uint32_t sof_wr = 0x44;
inline constexpr std::uint32_t sof_rd = 0x48;
inline constexpr std::uint32_t sie_ctrl = 0x4c;
inline constexpr std::uint32_t sie_status = 0x50;
inline constexpr std::uint32_t int_ep_ctrl = 0x54;
inline constexpr std::uint32_t buff_status = 0x58;
inline constexpr std::uint32_t buff_cpu_should_handle = 0x5c;
inline constexpr std::uint32_t ep_abort = 0x60;
inline constexpr std::uint32_t ep_abort_done = 0x64;
inline constexpr std::uint32_t ep_stall_arm = 0x68;
inline constexpr std::uint32_t nak_poll = 0x6c;
inline constexpr std::uint32_t ep_status_stall_nak = 0x70;
inline constexpr std::uint32_t usb_muxing = 0x74;
inline constexpr std::uint32_t usb_pwr = 0x78;
inline constexpr std::uint32_t usbphy_direct = 0x7c;
inline constexpr std::uint32_t usbphy_direct_override = 0x80;
inline constexpr std::uint32_t usbphy_trim = 0x84;
inline constexpr std::uint32_t intr = 0x8c;
inline constexpr std::uint32_t inte = 0x90;
inline constexpr std::uint32_t intf = 0x94;
inline constexpr std::uint32_t ints = 0x98;
}  // namespace reg

/// MAIN_CTRL.
namespace main_ctrl {
inline constexpr std::uint32_t controller_en = 1u << 0;
inline constexpr std::uint32_t host_ndevice = 1u << 1;
inline constexpr std::uint32_t sim_timing = 1u << 31;
}  // namespace main_ctrl

/// SIE_CTRL.
namespace sie_ctrl {
inline constexpr std::uint32_t resume = 1u << 12;  ///< self-clearing
inline constexpr std::uint32_t pullup_en = 1u << 16;
inline constexpr std::uint32_t transceiver_pd = 1u << 18;
inline constexpr std::uint32_t direct = 7u << 24;  ///< DIRECT_EN, DP, DM
inline constexpr std::uint32_t ep0_int_nak = 1u << 27;
inline constexpr std::uint32_t ep0_int_2buf = 1u << 28;
inline constexpr std::uint32_t ep0_int_1buf = 1u << 29;
inline constexpr std::uint32_t ep0_double_buf = 1u << 30;
inline constexpr std::uint32_t ep0_int_stall = 1u << 31;
/// Bits of host mode: pull-downs, VBUS, SOF, transactions.
inline constexpr std::uint32_t host_bits = 0x0000af5fu;
inline constexpr std::uint32_t writable = 0xff07af5eu;
}  // namespace sie_ctrl

/// SIE_STATUS.
namespace sie_status {
inline constexpr std::uint32_t vbus_detected = 1u << 0;
inline constexpr std::uint32_t line_state_shift = 2;
inline constexpr std::uint32_t suspended = 1u << 4;
inline constexpr std::uint32_t resume = 1u << 11;
inline constexpr std::uint32_t connected = 1u << 16;
inline constexpr std::uint32_t setup_rec = 1u << 17;
inline constexpr std::uint32_t trans_complete = 1u << 18;
inline constexpr std::uint32_t bus_reset = 1u << 19;
inline constexpr std::uint32_t crc_error = 1u << 24;
inline constexpr std::uint32_t bit_stuff_error = 1u << 25;
inline constexpr std::uint32_t rx_overflow = 1u << 26;
inline constexpr std::uint32_t rx_timeout = 1u << 27;
inline constexpr std::uint32_t nak_rec = 1u << 28;
inline constexpr std::uint32_t stall_rec = 1u << 29;
inline constexpr std::uint32_t ack_rec = 1u << 30;
inline constexpr std::uint32_t data_seq_error = 1u << 31;
/// Kept until a 1 is written to them.
inline constexpr std::uint32_t latched = resume | setup_rec | trans_complete | bus_reset |
                                         crc_error | bit_stuff_error | rx_overflow | rx_timeout |
                                         nak_rec | stall_rec | ack_rec | data_seq_error;
/// States, whose written 1 clears the interrupt of their change.
inline constexpr std::uint32_t states = suspended | connected;
}  // namespace sie_status

/// INTR, INTE, INTF, INTS.
namespace interrupt {
inline constexpr std::uint32_t trans_complete = 1u << 3;
inline constexpr std::uint32_t buff_status = 1u << 4;
inline constexpr std::uint32_t error_data_seq = 1u << 5;
inline constexpr std::uint32_t error_rx_timeout = 1u << 6;
inline constexpr std::uint32_t error_rx_overflow = 1u << 7;
inline constexpr std::uint32_t error_bit_stuff = 1u << 8;
inline constexpr std::uint32_t error_crc = 1u << 9;
inline constexpr std::uint32_t stall = 1u << 10;
inline constexpr std::uint32_t vbus_detect = 1u << 11;
inline constexpr std::uint32_t bus_reset = 1u << 12;
inline constexpr std::uint32_t dev_conn_dis = 1u << 13;
inline constexpr std::uint32_t dev_suspend = 1u << 14;
inline constexpr std::uint32_t dev_resume_from_host = 1u << 15;
inline constexpr std::uint32_t setup_req = 1u << 16;
inline constexpr std::uint32_t dev_sof = 1u << 17;
inline constexpr std::uint32_t abort_done = 1u << 18;
inline constexpr std::uint32_t ep_stall_nak = 1u << 19;
inline constexpr std::uint32_t all = 0xfffffu;
}  // namespace interrupt

/// USB_MUXING, USB_PWR, USBPHY_DIRECT and its override enables.
namespace phy {
inline constexpr std::uint32_t to_phy = 1u << 0;
inline constexpr std::uint32_t to_extphy = 1u << 1;
inline constexpr std::uint32_t to_digital_pad = 1u << 2;
inline constexpr std::uint32_t vbus_detect = 1u << 2;
inline constexpr std::uint32_t vbus_detect_override = 1u << 3;
inline constexpr std::uint32_t dp_pullup_en = 1u << 1;
inline constexpr std::uint32_t dp_pullup_override = 1u << 2;
}  // namespace phy

/// Endpoint control word (datasheet, table "Endpoint control register layout").
namespace ep_control {
inline constexpr std::uint32_t int_nak = 1u << 16;
inline constexpr std::uint32_t int_stall = 1u << 17;
inline constexpr std::uint32_t type_shift = 26;
inline constexpr std::uint32_t type_isochronous = 1;
inline constexpr std::uint32_t type_bulk = 2;
inline constexpr std::uint32_t int_2buf = 1u << 28;
inline constexpr std::uint32_t int_1buf = 1u << 29;
inline constexpr std::uint32_t double_buffered = 1u << 30;
inline constexpr std::uint32_t enable = 1u << 31;
inline constexpr std::uint32_t address_mask = 0xffc0u;
}  // namespace ep_control

/// One half of a buffer control word; bits 11 and 12 exist in the lower half only.
namespace buffer_control {
inline constexpr std::uint16_t length_mask = 0x3ff;
inline constexpr std::uint16_t available = 1u << 10;
inline constexpr std::uint16_t stall = 1u << 11;
inline constexpr std::uint16_t select_reset = 1u << 12;
inline constexpr std::uint16_t pid = 1u << 13;
inline constexpr std::uint16_t last = 1u << 14;
inline constexpr std::uint16_t full = 1u << 15;
}  // namespace buffer_control

/// Layout of the DPRAM in device mode.
namespace dpram {
inline constexpr std::uint32_t size = 4096;
inline constexpr std::uint32_t setup_packet = 0x000;
inline constexpr std::uint32_t ep_control = 0x008;      ///< EP1 IN, EP1 OUT, EP2 IN ...
inline constexpr std::uint32_t buffer_control = 0x080;  ///< EP0 IN, EP0 OUT, EP1 IN ...
inline constexpr std::uint32_t ep0_buffer = 0x100;
inline constexpr std::uint32_t buffers = 0x180;
}  // namespace dpram

}  // namespace lamplock::sim::chip::usb
