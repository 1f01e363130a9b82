// A flash that loses power during an operation.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

#include "firmware/settings/store.hpp"

namespace lamplock::test {

/// Thrown when the power fails.
struct PowerLoss {};

/// NOR flash: programming clears bits, erasing sets those of a sector. After `live_for(n)` the n-th
/// byte of work is the last: the operation in progress is left incomplete.
template <std::uint32_t n_sectors = 4>
class DyingFlash {
 public:
  static constexpr std::uint32_t sectors = n_sectors;
  static constexpr std::uint32_t size = n_sectors * settings::flash_sector;

  explicit DyingFlash(std::uint64_t seed = 1) : random_(seed) { bytes_.fill(0xff); }

  void read(std::uint32_t offset, std::span<std::uint8_t> out) const {
    std::copy_n(bytes_.begin() + offset, out.size(), out.begin());
  }
  void erase(std::uint32_t offset) {
    if (offset % settings::flash_sector != 0) ++misuses;
    const std::span sector = std::span(bytes_).subspan(offset, settings::flash_sector);
    if (spend(sector.size())) {
      for (std::uint8_t& byte : sector) byte = half_erased(byte);
      ++deaths_in_erase;
      throw PowerLoss{};
    }
    std::fill(sector.begin(), sector.end(), std::uint8_t{0xff});
    ++erases[offset / settings::flash_sector];
  }
  void program(std::uint32_t offset, std::span<const std::uint8_t, settings::flash_page> page) {
    if (offset % settings::flash_page != 0) ++misuses;
    const std::span old = std::span(bytes_).subspan(offset, page.size());
    if (std::any_of(old.begin(), old.end(), [](std::uint8_t b) { return b != 0xff; })) ++misuses;
    const bool dies = spend(page.size());
    for (std::size_t i = 0; i < page.size(); ++i) {
      const std::uint8_t wanted = page[i] | stuck;
      old[i] &= dies ? half_programmed(wanted) : wanted;
    }
    ++programs;
    if (!dies) return;
    ++deaths_in_program;
    throw PowerLoss{};
  }

  /// Power fails during the n-th byte from now; 0 = never.
  void live_for(std::uint64_t n) { left_ = n; }
  std::array<std::uint8_t, size>& bytes() { return bytes_; }
  /// Bytes of work done since the state `before`.
  std::uint64_t work_since(const DyingFlash& before) const {
    std::uint64_t work = (programs - before.programs) * settings::flash_page;
    for (std::size_t i = 0; i < sectors; ++i)
      work += std::uint64_t{erases[i] - before.erases[i]} * settings::flash_sector;
    return work;
  }

  std::uint32_t misuses = 0;  ///< unaligned, or a page programmed without an erase
  std::uint64_t programs = 0;
  std::uint32_t deaths_in_erase = 0;
  std::uint32_t deaths_in_program = 0;
  std::array<std::uint32_t, n_sectors> erases{};
  std::uint8_t stuck = 0;  ///< bits that can no longer be programmed

 private:
  bool spend(std::uint64_t work) {
    if (left_ == 0) return false;
    if (left_ <= work) {
      left_ = 0;
      return true;
    }
    left_ -= work;
    return false;
  }
  std::uint8_t random_byte() { return static_cast<std::uint8_t>(random_()); }
  /// A byte is written completely, not at all, or in some of its bits.
  std::uint8_t half_programmed(std::uint8_t wanted) {
    switch (random_() % 3) {
      case 0:
        return wanted;
      case 1:
        return 0xff;
      default:
        return wanted | random_byte();
    }
  }
  std::uint8_t half_erased(std::uint8_t old) {
    switch (random_() % 4) {
      case 0:
        return old;
      case 1:
        return 0xff;
      case 2:
        return old | random_byte();
      default:
        return random_byte();
    }
  }

  std::array<std::uint8_t, size> bytes_;
  std::mt19937_64 random_;
  std::uint64_t left_ = 0;
};

}  // namespace lamplock::test
