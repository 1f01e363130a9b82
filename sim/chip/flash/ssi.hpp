// The serial interface of the flash (RP2040 datasheet, 4.10: a Synopsys DW_apb_ssi) with its FIFOs,
// frame by frame at the speed of its clock.
//
// In:  registers; time; the pins' overrides.
// Out: chip select and clocks to the flash, frames into the receive FIFO; whether reads through the
//      XIP window work, found by clocking such a read on the flash's own state, so that a wrong
//      command, number of wait cycles or mode is detected.
// Brought up to date when a register is accessed, and at the end of each frame while the DMA is
// requested to fill or empty the FIFOs; otherwise nothing runs in between.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>

#include "sim/chip/fabric/dreq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/flash/flash_chip.hpp"
#include "sim/chip/flash/qspi_pins.hpp"

namespace lamplock::sim::chip {

/// The block at 0x18000000.
class Ssi final : public Peripheral, private Timed {
 public:
  static constexpr std::size_t fifo_depth = 16;

  /// `mapped(on)` is called when reads through the XIP window begin or cease to work.
  Ssi(TimeWheel& wheel, FlashChip& flash, QspiPins& pins, NotModelled not_modelled,
      std::function<void(bool on)> mapped);
  Ssi(const Ssi&) = delete;
  Ssi& operator=(const Ssi&) = delete;

  std::string_view name() const override { return "XIP_SSI"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;

  /// Cycles of clk_sys that filling a line of eight bytes takes at the present setting.
  std::uint32_t line_fill_cycles() const { return transfer_cycles(64); }
  /// The same for a single word.
  std::uint32_t word_cycles() const { return transfer_cycles(32); }
  /// Connects the requests to the DMA.
  void connect(DreqLines& dreqs) { dreqs_ = &dreqs; }
  /// Power has been cut: drops its own state and the flash's.
  void power_cut();

 private:
  enum class Stage : std::uint8_t { idle, transmit, instruction, address, wait, receive };

  void run(Cycle to) override;
  void clock_changed() override;
  void catch_up();
  std::uint32_t transfer_cycles(unsigned data_bits) const;
  void plan();
  void report_levels();
  /// Applies all consequences of the registers, the FIFOs and the time.
  void settle();
  void write_data(std::uint32_t value);
  bool start_frame(Cycle at);
  void start(Stage stage, unsigned bits, unsigned lanes, Cycle at);
  void finish_frame();
  void end_transfer();
  std::uint32_t shift(std::uint32_t out, unsigned bits, unsigned lanes, bool drive);
  std::uint64_t xip_read(std::uint32_t address);
  void update_select(Cycle at);
  void update_mapping();
  bool enabled() const { return enabled_ && slaves_ != 0 && divider() != 0; }
  std::uint32_t divider() const { return baud_ & 0xfffeu; }
  unsigned frame_bits() const { return ((control_ >> 16) & 31u) + 1; }
  unsigned transfer_mode() const { return (control_ >> 8) & 3u; }
  unsigned lanes() const { return 1u << ((control_ >> 21) & 3u); }
  unsigned instruction_bits() const;
  unsigned address_bits() const { return ((spi_control_ >> 2) & 15u) * 4; }
  unsigned wait_cycles() const { return (spi_control_ >> 11) & 31u; }
  unsigned instruction_lanes() const { return (spi_control_ & 3u) == 2 ? lanes() : 1; }
  unsigned address_lanes() const { return (spi_control_ & 3u) == 0 ? 1 : lanes(); }
  std::uint32_t status() const;
  void clear();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  FlashChip& flash_;
  QspiPins& pins_;
  NotModelled not_modelled_;
  std::function<void(bool)> mapped_changed_;
  DreqLines* dreqs_ = nullptr;

  std::uint32_t control_ = 0, frames_ = 0, slaves_ = 0, baud_ = 0, spi_control_ = 0;
  std::uint32_t tx_threshold_ = 0, rx_threshold_ = 0, rx_delay_ = 0, drive_edge_ = 0;
  std::uint32_t raw_interrupts_ = 0;
  std::uint32_t dma_control_ = 0, dma_tx_level_ = 0, dma_rx_level_ = 0;
  bool enabled_ = false;
  bool mapped_ = false;
  Cycle look_again_ = never_cycle;  ///< the flash is no longer busy

  std::deque<std::uint32_t> tx_, rx_;
  Stage stage_ = Stage::idle;
  bool in_frame_ = false;
  Cycle end_ = 0;          ///< of the frame, or of the last one
  std::uint32_t out_ = 0;  ///< bits of the frame
  unsigned out_bits_ = 0, out_lanes_ = 1;
  std::uint32_t left_ = 0;  ///< frames to receive
  bool selects_ = false;    ///< the SSI's own chip select
  bool selected_ = false;   ///< what the flash sees
};

}  // namespace lamplock::sim::chip
