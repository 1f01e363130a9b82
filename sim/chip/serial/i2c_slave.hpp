// An I2C slave: what it receives over SCL and SDA, and what it drives there (RP2040 datasheet,
// 4.3.6, 4.3.10).
//
// In:  the levels of both lines, each change with its time; settings; bytes to send.
// Out: which lines are pulled low; conditions, addresses and bytes for the controller.
// Who: I2c, while it is enabled as a slave.
//
// A bit counts from the rise of SCL; SDA changes after the fall of SCL, by the hold time. A byte
// takes effect with the fall of SCL after its ninth bit. From there SCL is held low while a byte
// that the master requests is missing, or a byte that it sent has no room. A byte that comes late
// is on SDA for the setup time before SCL is released (4.3.10.1.2, IC_SDA_SETUP).
#pragma once

#include <cstdint>
#include <optional>

#include "sim/chip/fabric/time_wheel.hpp"

namespace lamplock::sim::chip {

/// The controller: its FIFOs and its interrupts. Its functions must not call the slave.
class I2cSlavePort {
 public:
  virtual ~I2cSlavePort() = default;
  /// START, or RESTART; `addressed`: of a transfer that this slave takes part in.
  virtual void started(bool addressed) = 0;
  /// STOP; `addressed`: the slave had been addressed by its own address.
  virtual void stopped(bool addressed) = 0;
  /// The address has been acknowledged.
  virtual void addressed(bool for_reading, bool general_call) = 0;
  /// A byte has come. False: no room; the slave offers it again.
  virtual bool byte_received(std::uint8_t byte) = 0;
  /// The master requests a byte, `first` after its address. Empty: there is none yet.
  virtual std::optional<std::uint8_t> byte_wanted(bool first) = 0;
  /// The master has not acknowledged a byte, which ends its reading.
  virtual void byte_refused() = 0;
  /// SDA was low where the slave sent a 1.
  virtual void contended() = 0;
};

struct I2cSlaveSettings {
  std::uint32_t address = 0;
  bool ten_bits = false;
  bool takes_general_calls = true;
  bool refuses_data = false;  ///< IC_SLV_DATA_NACK_ONLY
  Cycle hold = 0;             ///< SDA, after SCL has fallen
  Cycle setup = 0;            ///< SDA, before SCL is released
};

class I2cSlave {
 public:
  explicit I2cSlave(I2cSlavePort& port) : port_(port) {}

  /// Starts with the present levels of the lines; takes part from the next START on.
  void begin(const I2cSlaveSettings& settings, bool scl, bool sda);
  void take_general_calls(bool on) { settings_.takes_general_calls = on; }
  /// Releases both lines and leaves the transfer.
  void leave();
  /// A line has changed.
  void lines_changed(bool scl, bool sda, Cycle at);
  /// There is a byte to send, or room for one.
  void byte_ready(Cycle at);
  void room_ready();

  /// Cycle of its next own action.
  Cycle due() const { return sda_at_ < scl_at_ ? sda_at_ : scl_at_; }
  void run(Cycle to);

  bool pulls_scl() const { return pulls_scl_; }
  bool pulls_sda() const { return pulls_sda_; }
  /// Between START and STOP, and the transfer may concern this slave.
  bool active() const { return state_ != State::idle; }
  /// True while it receives an address or data that the master writes (IC_ENABLE_STATUS).
  bool listens() const { return active() && state_ != State::sending; }
  bool receives() const { return state_ == State::receiving; }

 private:
  enum class State : std::uint8_t {
    idle,         ///< or the transfer of others
    address,      ///< seven bits, or the first byte of ten
    address_low,  ///< second byte of ten
    receiving,
    sending
  };
  enum class Waits : std::uint8_t { not_at_all, for_byte, for_room };
  /// Effect of a received byte at its ninth clock.
  struct Verdict {
    bool acknowledged = false;
    State next = State::idle;
  };

  void ignore_rest();
  void start();
  void stop();
  void rise(bool sda);
  void fall(Cycle at);
  Verdict judge_address() const;
  Verdict judge() const;
  void byte_ended(Cycle at);
  void ninth_ended(Cycle at);
  void offer();
  void fetch(bool first, Cycle at);
  void put(bool level, Cycle at);

  std::uint8_t byte() const { return static_cast<std::uint8_t>(shift_); }

  I2cSlavePort& port_;
  I2cSlaveSettings settings_;
  bool scl_ = true, sda_ = true;
  State state_ = State::idle;
  Verdict verdict_;
  Waits waits_ = Waits::not_at_all;
  unsigned bit_ = 0;         ///< rises of SCL in this byte
  std::uint32_t shift_ = 0;  ///< received, or being sent
  bool matched_ = false;     ///< its own address has come since START
  bool known_ = false;       ///< all ten bits of it: a RESTART for reading repeats the first byte
  bool acknowledged_ = false;
  bool pulls_scl_ = false, pulls_sda_ = false;
  bool next_sda_ = true;  ///< from sda_at_ on
  Cycle fell_at_ = 0;     ///< SCL
  Cycle sda_at_ = never_cycle, scl_at_ = never_cycle;
};

}  // namespace lamplock::sim::chip
