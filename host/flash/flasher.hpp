// Writes an image to the flash of a board in its boot loader, so that an incomplete image can never
// start.
//
// In:  a session with the loader, an image. Out: the image in flash, read back and compared.
// Who: Update.
//
// Only sectors that differ are written. The sector of the second-stage boot code is erased, and
// read back, before the others and written after them, its page with the code last of all, after
// all other bytes have been read back: until then the ROM finds no code to start and enters its
// loader (RP2040 datasheet, 2.8.1). After an interruption flashing is repeated from there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/flash/flash_image.hpp"
#include "host/flash/picoboot.hpp"

namespace lamplock::flash {

/// Progress; sectors, counted within a step.
struct FlashProgress {
  enum class Step : std::uint8_t { reading, writing };
  Step step = Step::reading;
  std::size_t done = 0, total = 0;
};
using OnFlashProgress = std::function<void(const FlashProgress&)>;

/// Result, in sectors.
struct FlashResult {
  std::size_t sectors = 0;  ///< of the image
  std::size_t written = 0;  ///< of these, those that differed; the boot sector with any other
};

/// One image into one board.
class Flasher {
 public:
  /// All must outlive the flasher.
  Flasher(Picoboot& loader, const FlashImage& image, OnFlashProgress on_progress);

  /// Writes the image; does not restart the board. Throws PicobootError, also if bytes read back
  /// differ.
  FlashResult run();

 private:
  std::vector<const Sector*> differing();
  void check_erased(std::uint32_t address);
  void write(const Sector& sector);
  void write_boot_sector();
  void write_pages(const Sector& sector, std::size_t first, std::size_t end);
  void verify(const Sector& sector, std::size_t first, std::size_t end);
  void report(FlashProgress::Step step, std::size_t done, std::size_t total) const;

  Picoboot& loader_;
  const FlashImage& image_;
  OnFlashProgress on_progress_;
};

}  // namespace lamplock::flash
