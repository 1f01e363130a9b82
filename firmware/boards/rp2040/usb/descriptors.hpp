// Descriptors of the device: a serial port (CDC ACM) and the pulse stream's pair of bulk endpoints
// (vendor specific), full speed.
//
// In:  nothing. Out: descriptor bytes for the host (USB 2.0, 9.5 and 9.6; CDC 1.2, 5.2; PSTN 1.2,
//      5.3; Interface Association Descriptor ECN). Constant data; only the serial number is
//      assembled at start (control_requests.hpp).
//
// The device is composite by its classes (EF/02/01, an interface association for the serial port's
// two interfaces): Windows 10 and later, Linux and macOS bind their drivers to 02/02 by the class
// codes of the function. The vendor interface comes after it, so that the interface numbers of the
// serial port did not change; a program claims it, not a driver (microsoft_os.hpp). The device
// reports USB 2.1, because hosts request BOS descriptors only from such devices.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "shared/boards/this_board.hpp"
#include "shared/boards/usb_ids.hpp"

namespace lamplock::rp2040::usb {

using boards::usb_product_id;
using boards::usb_vendor_id;

/// Version of the device in binary-coded decimal; must increase with every change of these
/// descriptors, because Windows caches the properties of a device under its numbers and this.
inline constexpr std::uint16_t device_version = 0x0012;

inline constexpr std::uint16_t language_us_english = 0x0409;
inline constexpr std::size_t serial_number_size = 16;  ///< characters

inline constexpr std::uint8_t packet_size = 64;  ///< endpoint 0 and bulk, the maximum at full speed
inline constexpr std::uint8_t notify_packet_size = 16;

inline constexpr std::uint8_t configuration_value = 1;
inline constexpr std::uint8_t control_interface = 0;
inline constexpr std::uint8_t data_interface = 1;
inline constexpr std::uint8_t stream_interface = 2;
inline constexpr std::uint8_t interface_count = 3;

inline constexpr std::uint8_t direction_in = 0x80;
inline constexpr std::uint8_t notify_endpoint = 1;  ///< IN; never sends
inline constexpr std::uint8_t data_endpoint = 2;    ///< IN and OUT
inline constexpr std::uint8_t stream_endpoint = 3;  ///< IN and OUT

namespace descriptor_type {
inline constexpr std::uint8_t device = 1;
inline constexpr std::uint8_t configuration = 2;
inline constexpr std::uint8_t string = 3;
inline constexpr std::uint8_t interface = 4;
inline constexpr std::uint8_t endpoint = 5;
inline constexpr std::uint8_t interface_association = 11;
inline constexpr std::uint8_t bos = 15;                // USB 3.2, table 9-6
inline constexpr std::uint8_t device_capability = 16;  // USB 3.2, table 9-6
inline constexpr std::uint8_t class_interface = 0x24;
}  // namespace descriptor_type

namespace string_index {
inline constexpr std::uint8_t languages = 0;
inline constexpr std::uint8_t manufacturer = 1;
inline constexpr std::uint8_t product = 2;
inline constexpr std::uint8_t serial_number = 3;
inline constexpr std::uint8_t function = 4;
inline constexpr std::uint8_t stream = 5;
}  // namespace string_index

constexpr std::uint8_t low_byte(std::uint16_t value) {
  return static_cast<std::uint8_t>(value & 0xff);
}
constexpr std::uint8_t high_byte(std::uint16_t value) {
  return static_cast<std::uint8_t>(value >> 8);
}

/// USB 2.0, table 9-8.
inline constexpr std::array<std::uint8_t, 18> device_descriptor = {
    18,
    descriptor_type::device,
    0x01,
    0x02,  // USB 2.1
    0xEF,  // miscellaneous, common class, interface association
    0x02,
    0x01,
    packet_size,
    low_byte(usb_vendor_id),
    high_byte(usb_vendor_id),
    low_byte(usb_product_id),
    high_byte(usb_product_id),
    low_byte(device_version),
    high_byte(device_version),
    string_index::manufacturer,
    string_index::product,
    string_index::serial_number,
    1,  // configurations
};
static_assert(device_descriptor.size() == device_descriptor[0]);

inline constexpr std::uint16_t configuration_size =
    9 + 8 + 9 + 5 + 5 + 4 + 5 + 7 + 9 + 7 + 7 + 9 + 7 + 7;

/// USB 2.0, tables 9-10, 9-12, 9-13; CDC 1.2, tables 15, 16; PSTN 1.2, tables 3, 4.
inline constexpr std::array<std::uint8_t, configuration_size> configuration_descriptor = {
    // Configuration.
    9,
    descriptor_type::configuration,
    low_byte(configuration_size),
    high_byte(configuration_size),
    interface_count,
    configuration_value,
    0,
    0x80,  // powered by the bus, no remote wake-up
    50,    // 100 mA, in 2 mA
    // Association of the serial port's interfaces.
    8,
    descriptor_type::interface_association,
    control_interface,
    2,
    0x02,
    0x02,
    0x00,
    string_index::function,
    // Communications interface: abstract control model, no AT commands.
    9,
    descriptor_type::interface,
    control_interface,
    0,
    1,
    0x02,
    0x02,
    0x00,
    string_index::function,
    // Header: CDC 1.10.
    5,
    descriptor_type::class_interface,
    0x00,
    0x10,
    0x01,
    // Call management: none.
    5,
    descriptor_type::class_interface,
    0x01,
    0x00,
    data_interface,
    // Abstract control management: line coding and state, break.
    4,
    descriptor_type::class_interface,
    0x02,
    0x06,
    // Union.
    5,
    descriptor_type::class_interface,
    0x06,
    control_interface,
    data_interface,
    // Notifications: interrupt, every 16 ms.
    7,
    descriptor_type::endpoint,
    direction_in | notify_endpoint,
    0x03,
    notify_packet_size,
    0,
    16,
    // Data interface.
    9,
    descriptor_type::interface,
    data_interface,
    0,
    2,
    0x0A,
    0x00,
    0x00,
    0,
    7,
    descriptor_type::endpoint,
    data_endpoint,
    0x02,
    packet_size,
    0,
    0,
    7,
    descriptor_type::endpoint,
    direction_in | data_endpoint,
    0x02,
    packet_size,
    0,
    0,
    // Pulse stream: vendor specific.
    9,
    descriptor_type::interface,
    stream_interface,
    0,
    2,
    0xFF,
    0x00,
    0x00,
    string_index::stream,
    7,
    descriptor_type::endpoint,
    stream_endpoint,
    0x02,
    packet_size,
    0,
    0,
    7,
    descriptor_type::endpoint,
    direction_in | stream_endpoint,
    0x02,
    packet_size,
    0,
    0,
};

/// The descriptors in the configuration fill it exactly, each with its own length.
constexpr bool lengths_fit(std::size_t at) {
  while (at < configuration_descriptor.size()) {
    if (configuration_descriptor[at] < 2) return false;
    at += configuration_descriptor[at];
  }
  return at == configuration_descriptor.size();
}
static_assert(lengths_fit(0));
static_assert(configuration_size == 98);

/// String descriptor 0: the languages.
inline constexpr std::array<std::uint8_t, 4> language_descriptor = {
    4, descriptor_type::string, low_byte(language_us_english), high_byte(language_us_english)};

/// A string descriptor of two texts, one after the other: UTF-16, little-endian.
template <std::size_t size>
constexpr std::array<std::uint8_t, 2 + 2 * size> string_descriptor_of(std::string_view first,
                                                                      std::string_view second) {
  std::array<std::uint8_t, 2 + 2 * size> out{};
  static_assert(out.size() <= 255, "the length is one byte");
  out[0] = static_cast<std::uint8_t>(out.size());
  out[1] = descriptor_type::string;
  for (std::size_t i = 0; i < size; ++i)
    out[2 + 2 * i] =
        static_cast<std::uint8_t>(i < first.size() ? first[i] : second[i - first.size()]);
  return out;
}
template <std::size_t size_with_zero>
constexpr auto string_descriptor(const char (&text)[size_with_zero]) {
  return string_descriptor_of<size_with_zero - 1>({text, size_with_zero - 1}, {});
}
inline constexpr auto manufacturer_descriptor = string_descriptor("lamplock");
/// Names the board, so that a host knows it without opening the port.
inline constexpr auto product_descriptor =
    string_descriptor_of<boards::usb_product_prefix.size() + boards::this_board.name.size()>(
        boards::usb_product_prefix, boards::this_board.name);
inline constexpr auto function_descriptor = string_descriptor("lamplock serial port");
inline constexpr auto stream_descriptor = string_descriptor("lamplock pulse stream");
static_assert(manufacturer_descriptor.size() == 2 + 2 * 8);

}  // namespace lamplock::rp2040::usb
