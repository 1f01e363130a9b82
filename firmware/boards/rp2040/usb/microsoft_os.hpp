// Descriptors for Windows beyond USB: the driver for each interface.
//
// In:  nothing. Out: descriptor bytes. The BOS descriptor (USB 3.2, 9.6.2; requested because the
//      device reports USB 2.1) contains the platform capability of Microsoft, which names the
//      vendor request for the descriptor set ("Microsoft OS 2.0 Descriptors Specification", 2018).
//      Who: ControlRequests. Constant data.
//
// The set assigns WinUSB to the pulse stream's interface, so that programs can open it without a
// driver file, and the GUID by which they find it. The serial port is left to its class. Linux and
// macOS request the BOS descriptor and ignore it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/boards/rp2040/usb/descriptors.hpp"

namespace lamplock::rp2040::usb {

/// bRequest of the vendor request, ours to choose, and its wIndex (specification, table 8).
inline constexpr std::uint8_t microsoft_request = 0x4D;
inline constexpr std::uint16_t microsoft_set_index = 7;

/// Interface GUID of the pulse stream; made for lamplock (version 4, random).
inline constexpr std::string_view stream_interface_guid = "{DF884B5E-C1E3-4649-AAC9-FCBA261F5FF0}";

namespace microsoft {

inline constexpr std::uint32_t windows_8_1 = 0x06030000;  ///< the first that supports it
// wDescriptorType (table 9).
inline constexpr std::uint16_t set_header = 0;
inline constexpr std::uint16_t configuration_subset = 1;
inline constexpr std::uint16_t function_subset = 2;
inline constexpr std::uint16_t compatible_id = 3;
inline constexpr std::uint16_t registry_property = 4;
inline constexpr std::uint16_t several_strings = 7;  ///< wPropertyDataType REG_MULTI_SZ (table 15)

// Sizes (tables 10 to 14).
inline constexpr std::uint16_t set_header_size = 10;
inline constexpr std::uint16_t subset_header_size = 8;
inline constexpr std::uint16_t compatible_id_size = 20;
inline constexpr std::string_view property_name = "DeviceInterfaceGUIDs";
inline constexpr std::uint16_t name_size = 2 * (property_name.size() + 1);
/// A list of one string: its terminator, and the list's.
inline constexpr std::uint16_t data_size = 2 * (stream_interface_guid.size() + 2);
inline constexpr std::uint16_t property_size = 10 + name_size + data_size;
inline constexpr std::uint16_t function_size =
    subset_header_size + compatible_id_size + property_size;
inline constexpr std::uint16_t configuration_subset_size = subset_header_size + function_size;
inline constexpr std::uint16_t set_size = set_header_size + configuration_subset_size;

/// Writes little-endian fields in sequence.
template <std::size_t size>
struct Writer {
  std::array<std::uint8_t, size> bytes{};
  std::size_t at = 0;

  constexpr void byte(std::uint8_t value) { bytes[at++] = value; }
  constexpr void half(std::uint16_t value) {
    byte(low_byte(value));
    byte(high_byte(value));
  }
  constexpr void word(std::uint32_t value) {
    half(static_cast<std::uint16_t>(value & 0xffff));
    half(static_cast<std::uint16_t>(value >> 16));
  }
  /// ASCII, padded with zeros.
  constexpr void text(std::string_view text, std::size_t characters) {
    for (std::size_t i = 0; i < characters; ++i)
      byte(i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0});
  }
  /// The same in UTF-16.
  constexpr void wide(std::string_view text, std::size_t characters) {
    for (std::size_t i = 0; i < characters; ++i)
      half(i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0});
  }
};

}  // namespace microsoft

/// Tables 10 to 14 of the specification.
inline constexpr auto microsoft_set = [] {
  using namespace microsoft;
  Writer<set_size> out;
  out.half(set_header_size);
  out.half(set_header);
  out.word(windows_8_1);
  out.half(set_size);
  // The number of the configuration, which Windows counts from 0, unlike the table.
  out.half(subset_header_size);
  out.half(configuration_subset);
  out.half(0);
  out.half(configuration_subset_size);
  out.half(subset_header_size);
  out.half(function_subset);
  out.half(stream_interface);
  out.half(function_size);
  out.half(compatible_id_size);
  out.half(compatible_id);
  out.text("WINUSB", 16);  // ID and sub-ID, of 8 characters each
  out.half(property_size);
  out.half(registry_property);
  out.half(several_strings);
  out.half(name_size);
  out.wide(property_name, name_size / 2);
  out.half(data_size);
  out.wide(stream_interface_guid, data_size / 2);
  return out.bytes;
}();
static_assert(microsoft_set.size() == 178);

/// BOS header and platform capability (USB 3.2, tables 9-12 and 9-20; specification, table 4). The
/// UUID D8DD60DF-4589-4CC7-9CD2-659D9E648A9F is stored like a GUID, its first three parts little
/// endian.
inline constexpr std::array<std::uint8_t, 33> bos_descriptor = {
    5,
    descriptor_type::bos,
    33,
    0,
    1,  // capabilities
    28,
    descriptor_type::device_capability,
    0x05,  // platform
    0,
    0xDF,
    0x60,
    0xDD,
    0xD8,
    0x89,
    0x45,
    0xC7,
    0x4C,
    0x9C,
    0xD2,
    0x65,
    0x9D,
    0x9E,
    0x64,
    0x8A,
    0x9F,
    0x00,
    0x00,
    0x03,
    0x06,  // Windows 8.1
    low_byte(microsoft::set_size),
    high_byte(microsoft::set_size),
    microsoft_request,
    0,  // no other enumeration
};
static_assert(bos_descriptor[2] == bos_descriptor.size());

}  // namespace lamplock::rp2040::usb
