// Functions of the boot ROM, found by their two-letter codes (datasheet, 2.8.3).
//
// Half-words at 0x14 and 0x18 of the ROM point to the table of functions and to its lookup
// function.
#pragma once

#include <cstdint>

namespace lamplock::rp2040 {

constexpr std::uint32_t rom_code(char a, char b) {
  return static_cast<std::uint32_t>(a) | (static_cast<std::uint32_t>(b) << 8);
}

/// A ROM function as a pointer; null if this ROM lacks it.
template <class Function>
[[gnu::always_inline]] inline Function* rom_function(std::uint32_t code) {
  using Lookup = void*(const std::uint16_t* table, std::uint32_t code);
  // Hides these pointers from the compiler: it treats an access so close to address 0 as one
  // through a null pointer, even after a cast from an integer.
  const volatile std::uint16_t* pointers = nullptr;
  asm("" : "=r"(pointers) : "0"(0x14));
  const std::uint16_t* table = nullptr;
  Lookup* lookup = nullptr;
  asm("" : "=r"(table) : "0"(std::uint32_t{pointers[0]}));
  asm("" : "=r"(lookup) : "0"(std::uint32_t{pointers[2]}));
  return reinterpret_cast<Function*>(lookup(table, code));
}

/// Starts the ROM's USB boot loader, as a mass-storage drive and for picotool; does not return.
[[gnu::always_inline]] inline void reset_to_usb_boot() {
  rom_function<void(std::uint32_t activity_pins, std::uint32_t disabled_interfaces)>(
      rom_code('U', 'B'))(0, 0);
}

}  // namespace lamplock::rp2040
