// The one wire between the UART of the chip and the drives on a board: TX through a resistor, and
// RX directly, on the wire of all drives.
//
// In:  levels of the pads; the row of the board. Out: the drives (sim/world/tmc2209.hpp); levels of
// RX while one of them replies. Who: ChipBoard.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>

#include "shared/boards/board_row.hpp"
#include "sim/chip/chip.hpp"
#include "sim/chip/serial/uart_frame.hpp"
#include "sim/world/tmc2209.hpp"

namespace lamplock::sim {

class DriveWire final : private chip::PadListener, private chip::Timed {
 public:
  DriveWire(chip::Chip& chip, const boards::UartDrives& row);
  DriveWire(const DriveWire&) = delete;
  DriveWire& operator=(const DriveWire&) = delete;

  TmcWire& drives() { return drives_; }
  /// Changes bytes of replies on their way to the chip; nothing: the byte is lost.
  std::function<std::optional<std::uint8_t>(std::uint8_t)> disturb;

 private:
  /// Of the image; the drives of the model do not search for it.
  static constexpr Picoseconds bit = ps_per_s / 115'200;
  static constexpr std::uint32_t eight_bits = 3u << 5;  ///< as LCR_H

  void pad_changed(unsigned gpio, bool level, chip::Cycle at) override;
  void run(chip::Cycle to) override;
  void clock_changed() override { schedule(); }
  void take(std::optional<std::uint32_t> character, Picoseconds at);
  void send(Picoseconds at);
  void echo();
  void put(chip::External level);
  void schedule();

  chip::Chip& chip_;
  chip::TimeWheel::Slot slot_;
  const unsigned tx_;  ///< RX is the next pin
  TmcWire drives_;
  chip::UartFormat format_ = chip::UartFormat::from(eight_bits, bit);
  chip::UartReceiver receiver_;
  std::deque<std::uint8_t> reply_;
  chip::UartFrame frame_;
  Picoseconds frame_end_ = 0, next_edge_ = never;
  bool replies_ = false;  ///< a drive
  bool echoes_ = false;   ///< TX has changed
};

}  // namespace lamplock::sim
