// Streaming from the flash in the background (RP2040 datasheet, 2.6.3.3): STREAM_ADDR, STREAM_CTR
// and the FIFO of two words that the DMA empties.
//
// In:  the registers, by way of XIP_CTRL; transfers of cache lines, which go first; the time that a
//      word occupies the serial interface.
// Out: words, through XIP_CTRL and the auxiliary slave, which never waits; the request
//      DREQ_XIP_STREAM. Who: Xip, XipMemory.
//
// Words are transferred one after the other as long as there is room. A miss of the cache waits for
// the word that is being transferred; a word waits until seven cycles after the last miss
// ("cooldown"). If a word and a miss would begin in the same cycle, the miss goes first.
// Not documented and assumed: each word is a transfer of its own that sends its address, does not
// ask the cache and does not count as an access; words follow each other without a gap.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "sim/chip/fabric/dreq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

class XipStream final : private Timed {
 public:
  /// "2 entries deep" (2.6.3.6, STAT).
  static constexpr unsigned fifo_depth = 2;
  /// From the end of a miss to the next word (2.6.3.3).
  static constexpr Cycle cooldown = 7;

  /// `flash`: size is a power of two; it repeats. `word_transfer` in cycles of clk_sys.
  XipStream(TimeWheel& wheel, std::span<std::uint8_t> flash,
            std::function<std::uint32_t()> word_transfer, NotModelled not_modelled);
  XipStream(const XipStream&) = delete;
  XipStream& operator=(const XipStream&) = delete;

  void connect(DreqLines& dreqs) { dreqs_ = &dreqs; }
  /// The SSI can read the flash.
  void set_readable(bool on);
  void reset();

  // Registers.
  void write_address(std::uint32_t value) { address_ = value & ~3u; }
  /// 0 halts and discards the word that is being transferred; the FIFO keeps its words.
  void write_count(std::uint32_t value);
  std::uint32_t address() const { return address_; }
  std::uint32_t count() const { return count_; }
  bool empty() const { return level_ == 0; }
  bool full() const { return level_ == fifo_depth; }
  std::uint32_t front() const { return level_ == 0 ? 0 : fifo_[0]; }
  std::uint32_t pop();

  /// More words will follow: a user of the flash first advances time to its access.
  bool active() const { return count_ != 0; }
  void bring_time_to(Cycle at) { wheel_.advance_to(at); }
  /// A miss needs the serial interface for `cycles` from `at` on; returns when its transfer begins.
  Cycle line_transfer(Cycle at, Cycle cycles);

  /// The auxiliary slave at 0x50400000: only the FIFO (2.6.3.3).
  Peripheral& auxiliary() { return auxiliary_; }

 private:
  struct Auxiliary final : Peripheral {
    explicit Auxiliary(XipStream& stream) : owner(stream) {}
    std::string_view name() const override { return "XIP_AUX"; }
    std::uint32_t read(std::uint32_t) override { return owner.pop(); }
    std::uint32_t peek(std::uint32_t) const override { return owner.front(); }
    void write(std::uint32_t, std::uint32_t) override {}
    std::uint32_t write_clear_bits(std::uint32_t) const override { return 0; }
    void reset() override {}
    XipStream& owner;
  };

  void run(Cycle to) override;
  bool needs() const { return count_ != 0 && level_ != fifo_depth && readable_; }
  void begin(Cycle at);
  void finish();
  void plan();
  void report_level();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  std::span<std::uint8_t> flash_;
  std::function<std::uint32_t()> word_transfer_;
  NotModelled not_modelled_;
  DreqLines* dreqs_ = nullptr;
  Auxiliary auxiliary_{*this};

  std::uint32_t address_ = 0, count_ = 0;
  std::array<std::uint32_t, fifo_depth> fifo_{};
  unsigned level_ = 0;
  bool readable_ = false;
  bool in_flight_ = false;
  Cycle start_ = 0;         ///< of the word that is being transferred
  Cycle end_ = 0;           ///< of the last transfer of a word, discarded or not
  Cycle previous_end_ = 0;  ///< of the one before
  Cycle resume_ = 0;        ///< the last miss and its cooldown are over
};

}  // namespace lamplock::sim::chip
