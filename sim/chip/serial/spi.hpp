// SPI0 and SPI1: the PL022 of the RP2040 in Motorola format, as a master and as a slave (RP2040
// datasheet, 4.4; ARM PrimeCell Synchronous Serial Port PL022 manual).
//
// In:  registers; clk_peri; the levels of RX and, as a slave, of SCK and CSn; as a master, whole
//      words of a device instead of RX.
// Out: the levels of SCK, TX and CSn; whole words to that device, when their last bit has been
//      captured; the interrupt line; the DREQs.
// Who: the bus; the wheel at the ends of words, and at each half bit while a pin shows it. A device
//      that takes whole words and needs its chip select listens to that pin (PadListener).
//
// A bit takes CPSDVSR x (1 + SCR) cycles of clk_peri. The last bit is captured as many bits after
// the start as a word has. With SPH 1 words follow each other without a gap; with SPH 0 the chip
// select must go high between them, which takes 1.5 bits more (Spi::gap_half_bits).
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/function_pins.hpp"
#include "sim/chip/serial/primecell.hpp"
#include "sim/chip/serial/serial_requests.hpp"
#include "sim/chip/serial/spi_wires.hpp"
#include "sim/chip/system/clocks.hpp"

namespace lamplock::sim::chip {

/// What is at the other end while the chip is the master.
class SpiDevice {
 public:
  virtual ~SpiDevice() = default;
  /// The chip has sent a word of `bits` bits, right-aligned; `at` is when its last bit was
  /// captured. Returns the word received in the same frame: a device answers from what it knew
  /// before this word.
  virtual std::uint16_t word_exchanged(std::uint16_t word, unsigned bits, Cycle at) = 0;
};

/// SPI0 or SPI1.
class Spi final : public Peripheral,
                  private Timed,
                  private ClockListener,
                  private FunctionPins::User {
 public:
  /// Half bits between two words with SPH 0 that follow each other. The manual draws the pulse of
  /// the chip select without its length; it has been measured elsewhere: SCK is low for about two
  /// bits, half a bit of which belongs to the word.
  static constexpr unsigned gap_half_bits = 3;

  Spi(int number, TimeWheel& wheel, Clocks& clocks, FunctionPins& pins, IrqLines& irqs,
      NotModelled not_modelled);
  Spi(const Spi&) = delete;
  Spi& operator=(const Spi&) = delete;

  void connect(DreqLines& lines) { requests_.connect(lines); }
  /// Connects a device: words come from it instead of from the RX pin.
  void connect(SpiDevice& device) { device_ = &device; }
  /// Time of a bit as configured; 0: there is no clock.
  Picoseconds bit_time() const;

  std::string_view name() const override { return name_; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  void reset() override;
  /// clk_peri stops or starts behind its gate: a word under way stops; a slave sees no edges.
  void set_clock(bool runs);

 private:
  static constexpr std::size_t fifo_depth = 8;

  void run(Cycle to) override;
  void clock_changed() override { schedule(); }
  void clocks_changed() override;
  void pins_changed(Cycle at) override;
  void pins_connecting(Cycle at) override;

  /// Signals of each SPI (spi_signal).
  enum Signal : unsigned { signal_rx, signal_select, signal_clock, signal_tx };
  unsigned signal(Signal of) const { return first_signal_ + of; }
  bool wires_are_seen() const;
  bool on_wires() const { return frame_open_ && half_ < shape_.last_half(); }
  void shift_wires(Cycle at);
  void put_wires(Cycle at);
  void follow_master();
  void take_word_to_answer();
  bool enabled() const { return (control_1_ & 2u) != 0; }
  bool slave() const { return (control_1_ & 4u) != 0; }
  unsigned word_bits() const { return (control_0_ & 0xfu) + 1; }
  std::uint16_t word_mask() const {
    return static_cast<std::uint16_t>((2u << (control_0_ & 0xfu)) - 1);
  }
  Picoseconds half_bits(std::uint64_t count) const;
  bool wants_to_send() const;
  void begin();
  void start_word(Picoseconds at);
  void exchange();
  void push_received(std::uint16_t word);
  std::uint32_t pop_received();
  void restart_timeout();
  std::uint32_t raw_interrupts() const;
  std::uint32_t flags() const;
  void write_data(std::uint32_t value);
  void write_control_0(std::uint32_t value);
  void schedule();
  void update_lines();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  Clocks& clocks_;
  FunctionPins& pins_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  std::string name_;
  Irq irq_;
  unsigned first_signal_;
  PrimeCell cell_;
  SerialRequests requests_;
  SpiDevice* device_ = nullptr;

  std::deque<std::uint16_t> transmit_, receive_;
  bool stopped_ = false;        ///< no clock
  Picoseconds stopped_at_ = 0;  ///< time of the stop
  bool shifting_ = false;       ///< a word is on the wires
  bool frame_open_ = false;     ///< the chip select is low: until a bit after the last one
  bool timeout_running_ = false;
  std::uint16_t shift_ = 0;  ///< being sent
  SpiShape shape_;           ///< of that word
  unsigned half_ = 0;        ///< half bits of it that have passed on the wires
  Picoseconds word_start_ = 0;
  std::uint16_t sampled_ = 0;  ///< bits of RX
  bool sampling_ = false;      ///< all of them were seen
  bool tx_ = false;
  SpiSlaveShifter follower_;
  Picoseconds captured_at_ = 0, frame_end_at_ = 0, timeout_at_ = 0;
  Picoseconds free_at_ = 0;  ///< the chip select may go low again
  std::uint32_t control_0_ = 0, control_1_ = 0, prescale_ = 0;
  std::uint32_t raised_ = 0;
};

}  // namespace lamplock::sim::chip
