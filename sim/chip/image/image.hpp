// Images of programs for the chip: ELF, UF2 and plain binary files.
//
// In:  a file, possibly damaged. Out: bytes with their addresses, and the symbols, or one
//      std::runtime_error "WHERE: WHAT; REMEDY".
// Who: the chip before it starts; the profile for the names.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamplock::sim::chip {

/// Bytes for consecutive addresses.
struct ImagePart {
  std::uint32_t address = 0;
  std::vector<std::uint8_t> bytes;
};

/// A function or an object.
struct ImageSymbol {
  std::string name;           ///< demangled
  std::uint32_t address = 0;  ///< without the Thumb bit
  std::uint32_t size = 0;
  bool function = false;
};

/// A program.
struct Image {
  std::vector<ImagePart> parts;      ///< by address, not overlapping
  std::vector<ImageSymbol> symbols;  ///< by address; only ELF files have them
  /// Bytes of all parts.
  std::size_t size() const;
  /// The symbol with this (demangled) name; null if there is none.
  const ImageSymbol* find(std::string_view name) const;
};

/// Reads a file; its contents determine its kind, a name ending in .bin makes it a plain binary.
Image load_image(const std::string& path);

/// Readers for each kind; `where` begins the error texts. An ELF file's program headers are loaded
/// by physical address; a plain binary goes to the start of flash (0x10000000).
Image parse_elf(std::span<const std::uint8_t> file, const std::string& where);
Image parse_uf2(std::span<const std::uint8_t> file, const std::string& where);
Image parse_bin(std::span<const std::uint8_t> file, const std::string& where);

}  // namespace lamplock::sim::chip
