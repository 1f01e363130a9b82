// The USB identifiers of a board: of its descriptors, and for hosts that look for it.
#pragma once

#include <cstdint>
#include <string_view>

namespace lamplock::boards {

/// pid.codes, test identifiers: for development only, may clash with devices of other developers.
/// A product that is distributed needs its own identifier (https://pid.codes).
inline constexpr std::uint16_t usb_vendor_id = 0x1209;
inline constexpr std::uint16_t usb_product_id = 0x0001;

/// The product's text is this and the name of the board (BoardRow::name).
inline constexpr std::string_view usb_product_prefix{"lamplock ", 9};

}  // namespace lamplock::boards
