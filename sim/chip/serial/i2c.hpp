// I2C0 and I2C1: the DW_apb_i2c of the RP2040 as a master or a slave (RP2040 datasheet, 4.3).
//
// In:  registers; acknowledges and bytes of the devices on the bus, whole or by the level of SDA.
// Out: conditions and bytes for the devices, each at its end; SCL and SDA, pulled low or released;
//      the interrupt line; the DREQs.
// Who: the bus; the wheel at the ends of conditions and bytes, and at each edge that a pin shows.
//
// With devices of whole bytes the bus is assumed to have its pull-ups, and their answers do not
// show on SDA. Without such devices, the levels of the pins count: an address or byte is
// acknowledged by a low SDA, a low SCL stretches the clock, and a transfer waits until both lines
// are high.
//
// All times are cycles of clk_sys, which is ic_clk (4.3): SCL is high for HCNT + SPKLEN + 7 and low
// for LCNT + 1 of them (4.3.14.1, edges without rise and fall time). START holds SDA for the high
// time before SCL falls; a byte is nine periods, and its value is known at their end; a RESTART is
// low time, low time as set-up and high time as hold; a STOP is low time and high time as set-up,
// and the bus stays free for a low time. With an empty transmit FIFO and no STOP requested, SCL is
// held low.
//
// As a slave it follows the levels of the pins (I2cSlave); its FIFOs, their interrupts and DREQs
// are those of the master. Spikes are not suppressed, and the delay of their filter is not
// modelled.
//
// Not modelled: other masters (no arbitration is lost), START bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/peripheral.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/gpio/function_pins.hpp"
#include "sim/chip/serial/i2c_slave.hpp"
#include "sim/chip/serial/i2c_wires.hpp"
#include "sim/chip/serial/serial_requests.hpp"

namespace lamplock::sim::chip {

/// A slave on the bus. Each call comes at the end of the ninth clock of a byte (or at the STOP).
class I2cDevice {
 public:
  virtual ~I2cDevice() = default;
  /// Its address has come after START or RESTART, for reading or for writing. Returns whether it
  /// acknowledges.
  virtual bool addressed(bool for_reading, Cycle at) = 0;
  /// A byte was written to it. Returns whether it acknowledges.
  virtual bool byte_written(std::uint8_t byte, Cycle at) = 0;
  /// A byte is read from it.
  virtual std::uint8_t byte_read(Cycle at) = 0;
  /// The STOP that ends the transfer in which it was addressed, or the address of another device
  /// after a RESTART.
  virtual void stopped(Cycle at) { static_cast<void>(at); }
};

/// I2C0 or I2C1.
class I2c final : public Peripheral,
                  private Timed,
                  private FunctionPins::User,
                  private I2cSlavePort {
 public:
  /// The address of devices that respond to general calls.
  static constexpr unsigned general_call = 0;

  I2c(int number, TimeWheel& wheel, FunctionPins& pins, IrqLines& irqs, NotModelled not_modelled);
  I2c(const I2c&) = delete;
  I2c& operator=(const I2c&) = delete;

  void connect(DreqLines& lines) { requests_.connect(lines); }
  /// Connects a device at a 7-bit or a 10-bit address.
  void connect(I2cDevice& device, unsigned address, bool ten_bits = false) {
    devices_.push_back({&device, address, ten_bits});
  }
  /// Cycles of clk_sys in which SCL is high and low, as configured.
  Cycle high_cycles() const;
  Cycle low_cycles() const;

  std::string_view name() const override { return name_; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;

 private:
  static constexpr std::size_t fifo_depth = 16;

  struct Slave {
    I2cDevice* device = nullptr;
    unsigned address = 0;
    bool ten_bits = false;
  };
  /// Phase of the master; due_ is its end. idle and held have no end of their own.
  enum class Phase : std::uint8_t {
    idle,
    start,           ///< from SDA down to SCL down
    address,         ///< 7 bits, or the first byte of 10 bits for writing
    address_low,     ///< second byte of 10 bits
    restart_inside,  ///< of a 10-bit address for reading
    address_again,   ///< first byte of 10 bits for reading
    data,
    rx_held,  ///< SCL low: the receive FIFO is full
    held,     ///< SCL low: waits for a command
    restart,
    stop,
    bus_free
  };

  /// The devices on the pins, in the form of one device of whole bytes: the levels sampled in this
  /// byte.
  class WiredDevice final : public I2cDevice {
   public:
    explicit WiredDevice(const std::uint32_t& sampled) : sampled_(sampled) {}
    bool addressed(bool /*for_reading*/, Cycle /*at*/) override { return acknowledged(); }
    bool byte_written(std::uint8_t /*byte*/, Cycle /*at*/) override { return acknowledged(); }
    std::uint8_t byte_read(Cycle /*at*/) override {
      return static_cast<std::uint8_t>(sampled_ >> 1);
    }
    bool acknowledged() const { return (sampled_ & 1u) == 0; }

   private:
    const std::uint32_t& sampled_;
  };

  void run(Cycle to) override;
  void pins_changed(Cycle at) override;
  void pins_connecting(Cycle at) override;

  void started(bool addressed) override;
  void stopped(bool addressed) override;
  void addressed(bool for_reading, bool generally) override;
  bool byte_received(std::uint8_t byte) override { return push_received(byte); }
  std::optional<std::uint8_t> byte_wanted(bool first) override;
  void byte_refused() override;
  void contended() override;
  bool is_slave() const;
  bool line(unsigned signal) const { return !pins_.connected(signal) || pins_.input(signal); }
  void begin_slave();
  void serve_slave();
  void leave_slave();

  unsigned scl() const { return first_signal_ + 1; }
  unsigned sda() const { return first_signal_; }
  bool wired() const;
  bool lines_are_high() const;
  std::uint32_t bits_of(Phase phase) const;
  void shape_wires(Phase phase, Cycle at);
  void step_wires(Cycle at);
  void put_wires(Cycle at);
  bool enabled() const { return (enable_ & 1u) != 0; }
  bool active() const { return phase_ != Phase::idle && phase_ != Phase::bus_free; }
  bool on(std::uint32_t control_bit) const { return (control_ & control_bit) != 0; }
  bool shifting() const;
  void enter(Phase phase, Cycle at);
  Cycle length(Phase phase) const;
  void phase_ended(Cycle at);
  void begin(Cycle at);
  bool refused(std::uint32_t command);
  void address_ended(Cycle at);
  bool targets_all() const;
  bool targets_ten_bits() const;
  bool first_address_acknowledged() const;
  bool address_device(Cycle at);
  void begin_data(Cycle at);
  void data_ended(Cycle at);
  void byte_done(Cycle at);
  void next(Cycle at);
  void stop_ended(Cycle at);
  void abort(std::uint32_t source);
  bool push_received(std::uint8_t byte);

  std::uint32_t raw_interrupts() const;
  std::uint32_t status() const;
  std::uint32_t take_interrupts(std::uint32_t bits);
  std::uint32_t pop_received();
  std::uint32_t read_clear(std::uint32_t offset);
  void write_command(std::uint32_t value);
  void write_enable(std::uint32_t value);
  bool write_settings(std::uint32_t offset, std::uint32_t value);
  void update_lines();
  void settle();

  TimeWheel& wheel_;
  TimeWheel::Slot slot_;
  IrqLines& irqs_;
  NotModelled not_modelled_;
  std::string name_;
  Irq irq_;
  SerialRequests requests_;
  std::vector<Slave> devices_;
  FunctionPins& pins_;
  unsigned first_signal_;
  std::uint32_t sampled_ = 0;  ///< levels of SDA in this byte, the ninth lowest
  WiredDevice wired_device_{sampled_};
  I2cSlave slave_{*this};
  I2cWires wires_;
  Cycle wires_since_ = 0;
  Cycle edge_at_ = never_cycle;          ///< the next of SCL or SDA, if they are seen
  Cycle stretched_since_ = never_cycle;  ///< a device holds SCL low
  bool sda_ = true;

  Phase phase_ = Phase::idle;
  Cycle due_ = never_cycle;
  I2cDevice* addressed_ = nullptr;
  std::deque<std::uint32_t> transmit_, receive_;
  std::uint32_t command_ = 0;  ///< under way
  bool first_byte_ = false;    ///< the next byte received is the first after an address
  bool reads_ = false;         ///< direction of the address under way
  bool flushed_ = false;       ///< the FIFOs are held empty after an abort
  std::uint8_t received_ = 0;  ///< waits for room in the receive FIFO

  std::uint32_t control_ = 0, target_ = 0, slave_address_ = 0;
  std::uint32_t slow_high_ = 0, slow_low_ = 0, fast_high_ = 0, fast_low_ = 0, spike_ = 0;
  std::uint32_t mask_ = 0, raised_ = 0, abort_source_ = 0, enable_ = 0;
  std::uint32_t rx_level_ = 0, tx_level_ = 0;
  std::uint32_t dma_tx_level_ = 0, dma_rx_level_ = 0;
  std::uint32_t hold_ = 0, setup_ = 0, acknowledge_general_ = 0, slave_nack_ = 0;
  std::uint32_t slave_cut_off_ = 0;  ///< IC_ENABLE_STATUS: data lost when it was disabled
};

}  // namespace lamplock::sim::chip
