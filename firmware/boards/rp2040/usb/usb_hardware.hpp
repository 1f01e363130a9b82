// The USB controller itself, as UsbSerial wants it: register accesses and nothing else.
//
// In:  calls of the USB interrupt and of the main loop. Out: register accesses (RP2040 datasheet,
//      4.1). A test hands UsbSerial something else that has the same members.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/resets.hpp"
#include "firmware/boards/rp2040/registers/sysinfo.hpp"
#include "firmware/boards/rp2040/registers/timer.hpp"
#include "firmware/boards/rp2040/registers/usb.hpp"
#include "firmware/boards/rp2040/usb/usb_serial.hpp"

namespace lamplock::rp2040 {

/// The controller.
class UsbHardware {
 public:
  using Lock = AllMasked;

  /// Out of reset, connected to the transceiver, interrupts set up; not yet on the bus.
  void start() {
    set_bits(resets().reset, reset_bit::usbctrl);
    release_reset(reset_bit::usbctrl);
    // The reset leaves the DPRAM as it was.
    auto* words = reinterpret_cast<Register*>(&dpram());
    for (std::uint32_t i = 0; i < sizeof(UsbDpram) / 4; ++i) words[i] = 0;
    UsbRegisters& usb = usb_registers();
    usb.usb_muxing = usb_field::to_phy | usb_field::softcon;
    // The Pico's VBUS sense (GPIO 24) has no way to the controller: it is told that there is VBUS.
    usb.usb_pwr = usb_field::vbus_detect | usb_field::vbus_detect_override;
    usb.main_ctrl = usb_field::controller_enable;
    usb.sie_ctrl = usb_field::ep0_each_buffer;
    usb.inte = usb_field::int_buffer | usb_field::int_bus_reset | usb_field::int_suspend |
               usb_field::int_resume | usb_field::int_setup | usb_field::int_sof;
  }
  void attach() { set_bits(usb_registers().sie_ctrl, usb_field::pullup_enable); }

  UsbDpram& dpram() { return usb_dpram(); }
  std::uint32_t interrupts() const { return usb_registers().ints; }
  std::uint32_t status() const { return usb_registers().sie_status; }
  void clear_status(std::uint32_t bits) { usb_registers().sie_status = bits; }
  std::uint32_t done() const { return usb_registers().buff_status; }
  void clear_done(std::uint32_t bits) { usb_registers().buff_status = bits; }
  void acknowledge_frame() { static_cast<void>(usb_registers().sof_rd); }
  void set_address(std::uint8_t address) { usb_registers().addr_endp = address; }
  void arm_stall() { usb_registers().ep_stall_arm = usb_field::stall_arm_ep0; }

  std::uint32_t microseconds() const { return timer().timerawl; }
  /// At least one clock of clk_usb (48 MHz): 12 cycles are enough up to 576 MHz.
  [[gnu::always_inline]] void settle() {
    asm volatile("nop\nnop\nnop\nnop\nnop\nnop\nnop\nnop\nnop\nnop\nnop\nnop" ::: "memory");
  }
  void pend() { nvic().ispr = irq_bit(Irq::usbctrl); }

  // Erratum E5 (bus_reset_exit.hpp).

  bool reset_exit_needed() const {
    constexpr std::uint32_t revision_b2 = 2;
    return sysinfo().chip_id >> 28 < revision_b2;
  }
  void hold_idle_line() {
    saved_control_ = gpio15_control();
    saved_pad_ = gpio15_pad();
    set_bits(gpio15_pad(), pad_pull_up | pad_pull_down);
    gpio15_control() = function_usb_debug | output_off | input_high;
    set_bits(usb_registers().usbphy_direct, usb_field::dp_pullup);
    set_bits(usb_registers().usbphy_direct_override, usb_field::dp_pullup_override);
    usb_registers().usb_muxing = usb_field::to_digital_pad | usb_field::softcon;
  }
  void release_line() {
    usb_registers().usb_muxing = usb_field::to_phy | usb_field::softcon;
    clear_bits(usb_registers().usbphy_direct_override, usb_field::dp_pullup_override);
    gpio15_control() = saved_control_;
    gpio15_pad() = saved_pad_;
  }

 private:
  // GPIO15_CTRL and its pad (datasheet, 2.19.6.1, 2.19.6.3).
  static Register& gpio15_control() { return *reinterpret_cast<Register*>(0x4001407c); }
  static Register& gpio15_pad() { return *reinterpret_cast<Register*>(0x4001c040); }
  static constexpr std::uint32_t function_usb_debug = 8;
  static constexpr std::uint32_t output_off = 2u << 12;  // OEOVER
  static constexpr std::uint32_t input_high = 3u << 16;  // INOVER
  static constexpr std::uint32_t pad_pull_down = 1u << 2;
  static constexpr std::uint32_t pad_pull_up = 1u << 3;

  std::uint32_t saved_control_ = 0;
  std::uint32_t saved_pad_ = 0;
};

/// The port of the image, with its hardware.
class UsbSerial : private UsbHardware, public BasicUsbSerial<UsbHardware> {
 public:
  UsbSerial() : BasicUsbSerial<UsbHardware>(static_cast<UsbHardware&>(*this)) {}
  using BasicUsbSerial<UsbHardware>::start;
};

}  // namespace lamplock::rp2040
