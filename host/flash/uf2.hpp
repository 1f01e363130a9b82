// UF2 files for the RP2040, read strictly: a file with any damage is refused as a whole.
//
// In:  the bytes of a file. Out: bytes by address, or an error that names the block; and back.
// Who: readers of image files; the copy to a boot loader's drive.
// Format: Microsoft, "USB Flashing Format (UF2)"; limits of the ROM: RP2040 datasheet, 2.8.4.2.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/error.hpp"
#include "host/flash/flash_image.hpp"

namespace lamplock::flash {

inline constexpr std::size_t uf2_block_size = 512;
inline constexpr std::uint32_t rp2040_family = 0xe48b'ff56;

/// Faults of a file.
enum class Uf2Fault : std::uint8_t {
  size,           ///< not a number of whole blocks, or empty
  magic,          ///< a block without magic numbers
  flags,          ///< a file container, or not for the main flash
  family,         ///< for another chip, or without a chip
  payload,        ///< not the 256 bytes that the ROM accepts
  alignment,      ///< not at a page
  address,        ///< not in flash
  count,          ///< the announced number of blocks is wrong
  number,         ///< beyond the announced number
  repeated,       ///< a number for the second time: another block is missing
  repeated_place  ///< an address for the second time
};

/// `block`: counted from 0 in the file.
class Uf2Error : public Error {
 public:
  Uf2Error(Uf2Fault fault, std::size_t block, const std::string& where, const std::string& what,
           const std::string& remedy)
      : Error(Exit::bad_input, where, what, remedy), fault_(fault), block_(block) {}
  Uf2Fault fault() const { return fault_; }
  std::size_t block() const { return block_; }

 private:
  Uf2Fault fault_;
  std::size_t block_;
};

/// True if the file begins like a UF2 file.
bool is_uf2(std::string_view file);

/// The pages of a file in its order. Blocks may have any order. `where`: for errors. Throws
/// Uf2Error.
std::vector<Part> read_uf2(std::string_view file, const std::string& where);

/// A UF2 file of an image with all of its sectors.
std::string write_uf2(const FlashImage& image);

}  // namespace lamplock::flash
