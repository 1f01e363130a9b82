// The USB controller for UsbSerial: only register accesses.
//
// In:  calls of the USB interrupt and of the main loop. Out: register accesses (RP2040 datasheet,
//      4.1). A test gives UsbSerial a substitute with the same members.
#pragma once

#include <cstdint>

#include "firmware/boards/rp2040/registers/alias.hpp"
#include "firmware/boards/rp2040/registers/cortex_m0plus.hpp"
#include "firmware/boards/rp2040/registers/io_bank0.hpp"
#include "firmware/boards/rp2040/registers/pads_bank0.hpp"
#include "firmware/boards/rp2040/registers/resets.hpp"
#include "firmware/boards/rp2040/registers/sysinfo.hpp"
#include "firmware/boards/rp2040/registers/timer.hpp"
#include "firmware/boards/rp2040/registers/usb.hpp"
#include "firmware/boards/rp2040/usb/usb_serial.hpp"
#include "shared/boards/this_board.hpp"

namespace lamplock::rp2040 {

class UsbHardware {
 public:
  using Lock = AllMasked;

  /// Takes it out of reset, connects the transceiver, sets up interrupts; not yet on the bus.
  void start() {
    set_bits(resets().reset, reset_bit::usbctrl);
    release_reset(reset_bit::usbctrl);
    // The reset does not clear the DPRAM.
    auto* words = reinterpret_cast<Register*>(&dpram());
    for (std::uint32_t i = 0; i < sizeof(UsbDpram) / 4; ++i) words[i] = 0;
    UsbRegisters& usb = usb_registers();
    usb.usb_muxing = usb_field::to_phy | usb_field::softcon;
    // The Pico's VBUS sense (GPIO 24) is not connected to the controller: VBUS is forced on.
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
    if constexpr (boards::this_board.uses_e5_pin) return false;
    return sysinfo().chip_id >> 28 < revision_b2;
  }
  void hold_idle_line() {
    Register& control = io_bank0().gpio[borrowed_gpio].ctrl;
    saved_control_ = control;
    saved_pad_ = pads_bank0().gpio[borrowed_gpio];
    set_bits(pads_bank0().gpio[borrowed_gpio], pad::pull_up | pad::pull_down);
    control =
        io_ctrl::function(io_ctrl::Function::usb_debug) | io_ctrl::output_off | io_ctrl::input_high;
    set_bits(usb_registers().usbphy_direct, usb_field::dp_pullup);
    set_bits(usb_registers().usbphy_direct_override, usb_field::dp_pullup_override);
    usb_registers().usb_muxing = usb_field::to_digital_pad | usb_field::softcon;
  }
  void release_line() {
    usb_registers().usb_muxing = usb_field::to_phy | usb_field::softcon;
    clear_bits(usb_registers().usbphy_direct_override, usb_field::dp_pullup_override);
    io_bank0().gpio[borrowed_gpio].ctrl = saved_control_;
    pads_bank0().gpio[borrowed_gpio] = saved_pad_;
  }

 private:
  /// The only pin whose input the USB controller can use for its line (erratum E5).
  static constexpr unsigned borrowed_gpio = 15;

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
