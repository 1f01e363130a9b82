// DMA requests of a serial block with a FIFO each way.
//
// In:  the DMA control register, room and contents of the FIFOs.
// Out: the levels of two DREQs.
// Who: Uart, Spi, I2c.
//
// DMACR of PL011 and PL022 and IC_DMA_CR have the same two bits: RXDMAE 0, TXDMAE 1 (RP2040
// datasheet, 4.2.8, 4.4.4, 4.3.17).
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/chip/fabric/dreq_lines.hpp"

namespace lamplock::sim::chip {

/// Both requests. The DMA may read and write the FIFOs within transmit() and receive(): the
/// argument of one must be read after the other has returned.
class SerialRequests {
 public:
  SerialRequests(Dreq transmit, Dreq receive) : transmit_(transmit), receive_(receive) {}

  void connect(DreqLines& lines) { lines_ = &lines; }
  bool connected() const { return lines_ != nullptr; }
  std::uint32_t control() const { return control_; }
  void set_control(std::uint32_t control) { control_ = control; }

  /// `room` transfers fit into the transmit FIFO.
  void transmit(std::size_t room) { set(transmit_, (control_ & 2u) != 0, room); }
  /// `waiting` words are in the receive FIFO.
  void receive(std::size_t waiting) { set(receive_, (control_ & 1u) != 0, waiting); }

 private:
  void set(Dreq line, bool on, std::size_t count) {
    lines_->set_level(line, on ? static_cast<unsigned>(count) : 0u);
  }

  DreqLines* lines_ = nullptr;
  Dreq transmit_, receive_;
  std::uint32_t control_ = 0;
};

}  // namespace lamplock::sim::chip
