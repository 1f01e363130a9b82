// The USB side of the boot ROM's loader (RP2040 datasheet, 2.8.4, 2.8.5): a device 2E8A:0003 with
// the PICOBOOT interface.
//
// In:  interrupts of the USB controller; results of flash functions.
// Out: stores to the controller's registers and DPRAM, as a driver makes them; flash functions to
//      be called.
// Who: BootRom, on core 0.
//
// Not modelled, and reported: mass storage (UF2). The configuration is that of a chip whose mass
// storage is switched off (reset_to_usb_boot with interface mask 1): one interface. The endpoint
// numbers are those of the real ROM, which the datasheet does not promise. State is kept here and
// not in the chip's memory.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/chip/rom/picoboot.hpp"

namespace lamplock::sim::chip {

/// The device.
class UsbLoader final : private picoboot::Pipes {
 public:
  static constexpr std::uint16_t vendor = 0x2e8a, product = 0x0003;
  static constexpr std::uint8_t out_endpoint = 3, in_endpoint = 4;
  /// Bits of the interface mask of reset_to_usb_boot (2.8.3.1.4).
  static constexpr std::uint32_t no_mass_storage = 1, no_picoboot = 2;
  /// A page of flash; in the DPRAM, so that the host can use all of SRAM.
  static constexpr std::uint32_t page_buffer = 0x5010'0600;
  static constexpr std::uint32_t stack_top = 0x5010'1000;

  explicit UsbLoader(NotModelled not_modelled);

  /// The controller is out of reset and clocked: connects to the cable.
  void start(std::uint32_t disabled_interfaces, LoaderBus& bus);
  /// USBCTRL_IRQ.
  void interrupt(LoaderBus& bus);
  /// A flash function that waits to be called.
  std::optional<picoboot::Call> take_call() { return picoboot_.take_call(); }
  void returned(std::uint32_t result, LoaderBus& bus);
  std::uint32_t vectors() const { return picoboot_.vectors(); }
  void set_functions(const std::array<std::uint32_t, picoboot::services>& functions) {
    picoboot_.set_functions(functions);
  }

 private:
  using Setup = std::array<std::uint8_t, 8>;
  void bus_reset();
  void setup();
  bool request(const Setup& packet, std::size_t length);
  bool standard(const Setup& packet, std::size_t length);
  bool descriptor(const Setup& packet, std::size_t length);
  bool interface_request(const Setup& packet, std::size_t length);
  bool endpoint_request(const Setup& packet, std::size_t length);
  void configure(bool on);
  void answer(std::span<const std::uint8_t> data, std::size_t length);
  void send_control();
  void buffer_done(std::uint32_t index);
  std::vector<std::uint8_t> configuration_descriptor() const;

  // picoboot::Pipes
  void take() override;
  void give(std::span<const std::uint8_t> packet) override;
  void halt(picoboot::Pipe pipe) override;

  std::uint32_t reg(std::uint32_t offset);
  void set_reg(std::uint32_t offset, std::uint32_t value);
  void arm(std::uint32_t index, std::uint32_t fields);
  void put(std::uint32_t at, std::span<const std::uint8_t> bytes);

  Picoboot picoboot_;
  NotModelled not_modelled_;
  LoaderBus* bus_ = nullptr;  ///< during a call
  std::uint32_t disabled_ = 0;
  bool configured_ = false;
  bool halted_in_ = false, halted_out_ = false;
  bool in_data1_ = false, out_data1_ = false;
  bool taking_ = false;
  std::vector<std::uint8_t> control_data_;
  std::size_t control_sent_ = 0;
  bool control_data1_ = false, control_in_ = false, short_end_ = false;
  std::optional<std::uint8_t> new_address_;
};

}  // namespace lamplock::sim::chip
