// An image into the flash of a board in its boot loader, so that no moment leaves half an image
// that starts.
//
// In:  a session with the loader, an image. Out: the flash holds it, read back and compared.
// Who: Update.
//
// Only sectors that differ are written. The sector of the second-stage boot code is erased, and
// read back, before the first and written behind the last of them, its page with the code last of
// all, when everything else has been read back: until then the ROM finds no code to start and comes
// up in its loader (RP2040 datasheet, 2.8.1). What was cut off is repeated from there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "host/flash/flash_image.hpp"
#include "host/flash/picoboot.hpp"

namespace lamplock::flash {

/// How far it is; sectors, counted within a step.
struct FlashProgress {
  enum class Step : std::uint8_t { reading, writing };
  Step step = Step::reading;
  std::size_t done = 0, total = 0;
};
using OnFlashProgress = std::function<void(const FlashProgress&)>;

/// What was to be done; both in sectors.
struct FlashResult {
  std::size_t sectors = 0;  ///< of the image
  std::size_t written = 0;  ///< of these, those that differed; the boot sector with any other
};

/// One image into one board.
class Flasher {
 public:
  /// All must outlive the flasher.
  Flasher(Picoboot& loader, const FlashImage& image, OnFlashProgress on_progress);

  /// Does it; does not restart the board. Throws PicobootError; also if what is read back differs.
  FlashResult run();

 private:
  std::vector<const Sector*> differing();
  void check_erased(std::uint32_t address);
  void write(const Sector& sector);
  void write_boot_sector();
  void write_pages(const Sector& sector, std::size_t first, std::size_t end);
  void verify(const Sector& sector, std::size_t first, std::size_t end);
  void tell(FlashProgress::Step step, std::size_t done, std::size_t total) const;

  Picoboot& loader_;
  const FlashImage& image_;
  OnFlashProgress on_progress_;
};

}  // namespace lamplock::flash
