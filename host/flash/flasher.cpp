#include "host/flash/flasher.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace lamplock::flash {
namespace {

constexpr std::size_t pages = sector_size / page_size;
/// The second-stage boot code is the first page of the flash (RP2040 datasheet, 2.8.1.3.1).
constexpr std::size_t boot_page = 0;

using Step = FlashProgress::Step;

std::span<const std::uint8_t> page_of(const Sector& sector, std::size_t page) {
  return std::span(sector.bytes).subspan(page * page_size, page_size);
}

bool is_blank(std::span<const std::uint8_t> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == erased; });
}

}  // namespace

Flasher::Flasher(Picoboot& loader, const FlashImage& image, OnFlashProgress on_progress)
    : loader_(loader), image_(image), on_progress_(std::move(on_progress)) {}

void Flasher::report(Step step, std::size_t done, std::size_t total) const {
  if (on_progress_) on_progress_({step, done, total});
}

FlashResult Flasher::run() {
  loader_.take_exclusive_access();
  loader_.exit_xip();
  const std::vector<const Sector*> sectors = differing();
  FlashResult result{image_.sectors.size(), 0};
  if (sectors.empty()) return result;

  const Sector& boot = image_.sectors.front();
  loader_.erase(boot.address, sector_size);
  check_erased(boot.address);
  result.written = sectors.size() + (sectors.front() == &boot ? 0 : 1);
  std::size_t done = 0;
  for (const Sector* sector : sectors) {
    if (sector == &boot) continue;
    report(Step::writing, done++, result.written);
    write(*sector);
  }
  report(Step::writing, done, result.written);
  write_boot_sector();
  report(Step::writing, result.written, result.written);
  return result;
}

std::vector<const Sector*> Flasher::differing() {
  std::vector<const Sector*> found;
  std::array<std::uint8_t, sector_size> present{};
  for (std::size_t i = 0; i < image_.sectors.size(); ++i) {
    const Sector& sector = image_.sectors[i];
    report(Step::reading, i, image_.sectors.size());
    loader_.read(sector.address, present);
    if (present != sector.bytes) found.push_back(&sector);
  }
  report(Step::reading, image_.sectors.size(), image_.sectors.size());
  return found;
}

/// The ROM acknowledges an erase even if it failed. While the boot code is intact no other sector
/// may be changed.
void Flasher::check_erased(std::uint32_t address) {
  std::array<std::uint8_t, sector_size> found{};
  loader_.read(address, found);
  const auto left =
      std::find_if(found.begin(), found.end(), [](std::uint8_t byte) { return byte != erased; });
  if (left == found.end()) return;
  const auto offset = static_cast<std::uint32_t>(left - found.begin());
  throw PicobootError(
      Exit::job_failed,
      fmt::format("the sector at 0x{:08x} was erased but 0x{:02x} was read back at 0x{:08x}; no "
                  "byte has been written",
                  address, *left, address + offset),
      "flash again; if the error remains, the flash chip is protected or worn out");
}

void Flasher::write(const Sector& sector) {
  loader_.erase(sector.address, sector_size);
  write_pages(sector, 0, pages);
  verify(sector, 0, pages);
}

void Flasher::write_boot_sector() {
  const Sector& sector = image_.sectors.front();
  write_pages(sector, boot_page + 1, pages);
  verify(sector, boot_page + 1, pages);
  write_pages(sector, boot_page, boot_page + 1);
  verify(sector, 0, pages);
}

/// Writes runs of pages that are not blank, in one command each; blank pages are erased already.
void Flasher::write_pages(const Sector& sector, std::size_t first, std::size_t end) {
  for (std::size_t page = first; page < end;) {
    std::size_t run_end = page;
    while (run_end < end && !is_blank(page_of(sector, run_end))) ++run_end;
    if (run_end > page)
      loader_.write(
          sector.address + static_cast<std::uint32_t>(page * page_size),
          std::span(sector.bytes).subspan(page * page_size, (run_end - page) * page_size));
    page = std::max(run_end, page + 1);
  }
}

void Flasher::verify(const Sector& sector, std::size_t first, std::size_t end) {
  const auto wanted = std::span(sector.bytes).subspan(first * page_size, (end - first) * page_size);
  std::vector<std::uint8_t> found(wanted.size());
  const std::uint32_t address = sector.address + static_cast<std::uint32_t>(first * page_size);
  loader_.read(address, found);
  const auto differs = std::mismatch(found.begin(), found.end(), wanted.begin());
  if (differs.first == found.end()) return;
  const auto offset = static_cast<std::uint32_t>(differs.first - found.begin());
  throw PicobootError(
      Exit::job_failed,
      fmt::format("0x{:02x} was written to 0x{:08x} but 0x{:02x} was read back; the board stays in "
                  "its boot loader",
                  *differs.second, address + offset, *differs.first),
      "flash again; if the error remains, the flash chip is worn out");
}

}  // namespace lamplock::flash
