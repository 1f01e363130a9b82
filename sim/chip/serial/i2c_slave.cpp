#include "sim/chip/serial/i2c_slave.hpp"

#include <algorithm>

namespace lamplock::sim::chip {

namespace {

constexpr unsigned data_bits = 8, bits_of_byte = 9;
// First byte of an address (4.3.6.2): 0 is the general call; 11110xx0 and 11110xx1 have ten bits.
constexpr std::uint32_t general_call_byte = 0;
constexpr std::uint32_t ten_bits_mask = 0xf8, ten_bits_prefix = 0xf0;

}  // namespace

void I2cSlave::begin(const I2cSlaveSettings& settings, bool scl, bool sda) {
  leave();
  settings_ = settings;
  scl_ = scl;
  sda_ = sda;
}

void I2cSlave::leave() {
  ignore_rest();
  matched_ = known_ = false;
}

/// Ignores all until the next START; the STOP still counts as that of an addressed slave.
void I2cSlave::ignore_rest() {
  state_ = State::idle;
  waits_ = Waits::not_at_all;
  pulls_scl_ = pulls_sda_ = false;
  sda_at_ = scl_at_ = never_cycle;
}

void I2cSlave::run(Cycle to) {
  if (sda_at_ <= to) {
    sda_at_ = never_cycle;
    pulls_sda_ = !next_sda_;
  }
  if (scl_at_ <= to) {
    scl_at_ = never_cycle;
    pulls_scl_ = false;
  }
}

/// SDA gets its level after the hold time.
void I2cSlave::put(bool level, Cycle at) {
  next_sda_ = level;
  sda_at_ = std::max(at, fell_at_ + settings_.hold);
}

// --- the lines

void I2cSlave::lines_changed(bool scl, bool sda, Cycle at) {
  const bool clocked = scl != scl_, moved = sda != sda_;
  scl_ = scl;
  sda_ = sda;
  if (clocked && scl) return rise(sda);
  if (clocked) return fall(at);
  if (moved && scl) return sda ? stop() : start();
}

void I2cSlave::start() {
  port_.started(matched_);
  ignore_rest();
  matched_ = false;
  state_ = State::address;
  bit_ = 0;
  shift_ = 0;
}

void I2cSlave::stop() {
  port_.stopped(matched_);
  leave();
}

void I2cSlave::rise(bool sda) {
  if (!active()) return;
  ++bit_;
  if (bit_ == bits_of_byte) {
    acknowledged_ = !sda;
  } else if (state_ != State::sending) {
    shift_ = shift_ << 1 | (sda ? 1u : 0u);
  } else if (!sda && !pulls_sda_) {
    // "A fail safe check": the data line is not what is transmitted (IC_TX_ABRT_SOURCE[14]).
    port_.contended();
    ignore_rest();
  }
}

void I2cSlave::fall(Cycle at) {
  fell_at_ = at;
  if (!active() || bit_ == 0) return;
  if (bit_ == data_bits) return byte_ended(at);
  if (bit_ == bits_of_byte) return ninth_ended(at);
  if (state_ == State::sending) put((shift_ >> (data_bits - 1 - bit_) & 1u) != 0, at);
}

// --- bytes

I2cSlave::Verdict I2cSlave::judge_address() const {
  const bool reads = (byte() & 1u) != 0;
  const State next = reads ? State::sending : State::receiving;
  if (byte() == general_call_byte) return {settings_.takes_general_calls, State::receiving};
  if (!settings_.ten_bits) return {byte() >> 1 == (settings_.address & 0x7fu), next};
  const bool high_bits_match = (byte() & ten_bits_mask) == ten_bits_prefix &&
                               (byte() >> 1 & 3u) == (settings_.address >> 8 & 3u);
  if (reads) return {high_bits_match && known_, State::sending};
  return {high_bits_match, State::address_low};
}

I2cSlave::Verdict I2cSlave::judge() const {
  switch (state_) {
    case State::address:
      return judge_address();
    case State::address_low:
      return {byte() == (settings_.address & 0xffu), State::receiving};
    default:
      return {!settings_.refuses_data, settings_.refuses_data ? State::idle : State::receiving};
  }
}

/// Eight bits are complete: the ninth is the receiver's.
void I2cSlave::byte_ended(Cycle at) {
  if (state_ == State::sending) return put(true, at);
  verdict_ = judge();
  if (verdict_.acknowledged) return put(false, at);
  if (state_ != State::receiving) known_ = false;
  ignore_rest();
}

/// SCL is low after the acknowledge.
void I2cSlave::ninth_ended(Cycle at) {
  bit_ = 0;
  put(true, at);
  const State was = state_;
  if (was == State::sending) {
    if (acknowledged_) return fetch(false, at);
    port_.byte_refused();
    state_ = State::idle;
    return;
  }
  if (was == State::receiving) return offer();
  state_ = verdict_.next;
  const bool general = was == State::address && byte() == general_call_byte;
  known_ = was == State::address_low || (known_ && state_ == State::sending);
  if (state_ != State::address_low) {
    matched_ = !general;
    port_.addressed(state_ == State::sending, general);
  }
  shift_ = 0;
  if (state_ == State::sending) fetch(true, at);
}

/// Offers the received byte; SCL is held low until there is room.
void I2cSlave::offer() {
  const bool taken = port_.byte_received(byte());
  waits_ = taken ? Waits::not_at_all : Waits::for_room;
  pulls_scl_ = !taken;
  if (taken) shift_ = 0;
}

/// Fetches a byte to send; SCL is held low until there is one.
void I2cSlave::fetch(bool first, Cycle at) {
  const bool waited = waits_ == Waits::for_byte;
  const std::optional<std::uint8_t> next = port_.byte_wanted(first);
  waits_ = next ? Waits::not_at_all : Waits::for_byte;
  if (!next) {
    pulls_scl_ = true;
    return;
  }
  shift_ = *next;
  put((*next & 0x80u) != 0, at);
  if (waited) scl_at_ = sda_at_ + settings_.setup;
}

void I2cSlave::byte_ready(Cycle at) {
  if (waits_ == Waits::for_byte) fetch(false, at);
}

void I2cSlave::room_ready() {
  if (waits_ == Waits::for_room) offer();
}

}  // namespace lamplock::sim::chip
