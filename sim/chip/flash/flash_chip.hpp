// A serial NOR flash of the W25Q16JV kind, clock by clock on its four data lines.
//
// In:  chip select, clocks with the levels of IO0..IO3, the time; a cut of its power at any moment.
// Out: the levels it drives; its storage, which the bus maps for execution in place.
// Who: the SSI clocks it; tests clock it directly.
//
// Rules of the datasheet (Winbond W25Q16JV, chapters 6 to 9): programming only clears bits, inside
// one page of 256 bytes with the address wrapping; erasing sets whole sectors or blocks; each needs
// a write enable before it; commands other than reading status are ignored while the chip is busy;
// a write command counts only if chip select rises after a whole byte. A power cut leaves what a
// real chip may leave: after a cut program only some bits programmed, after a cut erase any value.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/chip/fabric/peripheral.hpp"
#include "sim/world/random.hpp"
#include "sim/world/time.hpp"

namespace lamplock::sim::chip {

/// Times for which the chip is busy: typical times of the W25Q16JV datasheet, table "AC electrical
/// characteristics"; the maximum times are in the comments.
struct FlashTiming {
  Picoseconds page_program = 400 * ps_per_us;      ///< tPP, 3 ms at most
  Picoseconds sector_erase = 45 * ps_per_ms;       ///< tSE, 400 ms
  Picoseconds block_erase_32k = 120 * ps_per_ms;   ///< tBE1, 1.6 s
  Picoseconds block_erase_64k = 150 * ps_per_ms;   ///< tBE2, 2 s
  Picoseconds chip_erase = 5 * ps_per_s;           ///< tCE, 25 s
  Picoseconds write_status = 10 * ps_per_ms;       ///< tW, 15 ms
  Picoseconds release_power_down = 3 * ps_per_us;  ///< tRES1
  Picoseconds reset = 30 * ps_per_us;              ///< tRST
};

/// Operations of the chip, for tests of wear levelling and for reports.
struct FlashCounts {
  std::uint64_t pages_programmed = 0;
  std::uint64_t sectors_erased = 0;  ///< sectors of 4 KiB, those in blocks included
  std::uint64_t ignored = 0;         ///< write commands that were ignored (busy, not enabled, ...)
};

class FlashChip {
 public:
  static constexpr std::size_t default_size = 2 * 1024 * 1024;
  static constexpr std::size_t page_size = 256;
  static constexpr std::size_t sector_size = 4096;

  /// `size` in bytes, a power of two from 64 KiB to 16 MiB; throws std::invalid_argument.
  explicit FlashChip(std::size_t size = default_size, FlashTiming timing = {},
                     NotModelled not_modelled = {}, std::uint64_t seed = 1);

  /// Chip select falls and rises.
  void select(Picoseconds now);
  void deselect(Picoseconds now);
  /// One clock with the levels of IO0 (bit 0) to IO3 as the host and the pulls make them; returns
  /// the levels that the chip drives, high where it drives nothing.
  unsigned clock(unsigned lines, Picoseconds now);
  /// Eight clocks in plain SPI: a byte out, a byte in.
  std::uint8_t transfer(std::uint8_t out, Picoseconds now);

  bool busy(Picoseconds now) const { return now < busy_until_; }
  Picoseconds busy_until() const { return busy_until_; }

  /// Power fails and returns: a running operation stops part-way; volatile state is lost.
  void power_cut(Picoseconds now);

  /// Contents. A running program or erase shows its result already, but the chip permits no read
  /// before it is done.
  std::span<std::uint8_t> storage() { return storage_; }
  std::span<const std::uint8_t> storage() const { return storage_; }

  void set_unique_id(const std::array<std::uint8_t, 8>& id) { unique_id_ = id; }
  /// Quad enable (status 2, bit 1) as delivered; the parts on a Pico come with it set.
  void set_quad_enable(bool on);
  const FlashCounts& counts() const { return counts_; }
  /// The next command is omitted: the last read ended with mode bits M5-4 = 10.
  bool continuous_read() const { return protocol_.continuous != 0; }

  /// Whether reads that `read` clocks on this chip return the contents: `read(address)` is called
  /// with the chip answering a pattern of addresses; its state is restored afterwards.
  template <typename Read>
  bool would_read(Read&& read, Picoseconds now) {
    const Protocol saved = protocol_;
    probing_ = true;
    bool good = !busy(now);
    for (const std::uint32_t address : {0x100u, 0x12'3458u, 0x0u, 0x1'fff0u})
      good = good && read(address) == pattern_word(address);
    probing_ = false;
    protocol_ = saved;
    return good;
  }

 private:
  enum class Phase : std::uint8_t { ignore, command, address, mode, dummy, output, input, done };
  enum class Source : std::uint8_t {
    memory,
    status1,
    status2,
    status3,
    jedec,
    unique,
    device,
    ids
  };
  /// State on the wires.
  struct Protocol {
    Phase phase = Phase::ignore;
    Phase after_dummy = Phase::output;
    Source source = Source::memory;
    std::uint8_t command = 0;
    std::uint8_t continuous = 0;  ///< command that continues without being sent, 0 = none
    std::uint8_t lanes = 1;       ///< of the phase
    std::uint8_t output_lanes = 1;
    std::uint8_t mode = 0;
    std::uint8_t bit_count = 0;
    std::uint32_t bits = 0;
    std::uint32_t address = 0;
    std::uint32_t dummy_clocks = 0;
    std::uint32_t position = 0;  ///< of the byte being sent or received
  };
  enum class Work : std::uint8_t { none, program, erase, status };

  void start_command(std::uint8_t command, Picoseconds now);
  /// Commands that send an address first, then data; false: another command.
  bool start_read(std::uint8_t command);
  /// Commands that are answered without an address.
  bool start_answer(std::uint8_t command);
  void read_command(unsigned address_lanes, unsigned dummies, unsigned data_lanes);
  void begin(Phase phase, unsigned lanes);
  void after_address();
  void after_mode();
  void take_byte(std::uint8_t byte);
  std::uint8_t output_byte(Picoseconds now);
  std::uint8_t memory_byte(std::uint32_t address) const;
  static std::uint8_t pattern_byte(std::uint32_t address);
  static std::uint64_t pattern_word(std::uint32_t address);
  bool write_permitted(Picoseconds now);
  bool protected_now();
  void finish_write(Picoseconds now);
  void program(Picoseconds now);
  void erase(std::size_t from, std::size_t size, Picoseconds duration, Picoseconds now);
  void write_status(Picoseconds now);
  void start_work(Work work, std::size_t from, std::size_t size, Picoseconds duration,
                  Picoseconds now);
  void cut_program(double done);
  void cut_erase(double done);
  void report(const std::string& what) const;

  FlashTiming timing_;
  NotModelled not_modelled_;
  Random random_;
  std::vector<std::uint8_t> storage_;
  std::array<std::uint8_t, 8> unique_id_{};
  std::array<std::uint8_t, 3> status_{0, 2, 0x60};  ///< non-volatile bits; 3: driver strength 25 %
  Protocol protocol_;
  FlashCounts counts_;
  bool selected_ = false;
  bool probing_ = false;
  bool write_enabled_ = false;
  bool power_down_ = false;
  bool reset_enabled_ = false;
  std::array<std::uint8_t, page_size> page_{};
  std::array<bool, page_size> page_loaded_{};
  std::uint32_t page_bytes_ = 0;

  Work work_ = Work::none;
  Picoseconds busy_since_ = 0;
  Picoseconds busy_until_ = 0;
  std::size_t work_from_ = 0;
  std::vector<std::uint8_t> before_;  ///< contents of the area that is being changed
  std::array<std::uint8_t, 3> status_before_{};
};

}  // namespace lamplock::sim::chip
