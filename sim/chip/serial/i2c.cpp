#include "sim/chip/serial/i2c.hpp"

#include <algorithm>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Offsets (4.3.17).
constexpr std::uint32_t offset_con = 0x00;
constexpr std::uint32_t offset_tar = 0x04;
constexpr std::uint32_t offset_sar = 0x08;
constexpr std::uint32_t offset_data_cmd = 0x10;
constexpr std::uint32_t offset_ss_high = 0x14;
constexpr std::uint32_t offset_ss_low = 0x18;
constexpr std::uint32_t offset_fs_high = 0x1c;
constexpr std::uint32_t offset_fs_low = 0x20;
constexpr std::uint32_t offset_intr_stat = 0x2c;
constexpr std::uint32_t offset_intr_mask = 0x30;
constexpr std::uint32_t offset_raw_intr_stat = 0x34;
constexpr std::uint32_t offset_rx_tl = 0x38;
constexpr std::uint32_t offset_tx_tl = 0x3c;
constexpr std::uint32_t offset_clr_intr = 0x40;
constexpr std::uint32_t offset_clr_rx_under = 0x44;
constexpr std::uint32_t offset_clr_rx_over = 0x48;
constexpr std::uint32_t offset_clr_tx_over = 0x4c;
constexpr std::uint32_t offset_clr_rd_req = 0x50;
constexpr std::uint32_t offset_clr_tx_abrt = 0x54;
constexpr std::uint32_t offset_clr_rx_done = 0x58;
constexpr std::uint32_t offset_clr_activity = 0x5c;
constexpr std::uint32_t offset_clr_stop_det = 0x60;
constexpr std::uint32_t offset_clr_start_det = 0x64;
constexpr std::uint32_t offset_clr_gen_call = 0x68;
constexpr std::uint32_t offset_enable = 0x6c;
constexpr std::uint32_t offset_status = 0x70;
constexpr std::uint32_t offset_txflr = 0x74;
constexpr std::uint32_t offset_rxflr = 0x78;
constexpr std::uint32_t offset_sda_hold = 0x7c;
constexpr std::uint32_t offset_abort_source = 0x80;
constexpr std::uint32_t offset_slave_nack = 0x84;
constexpr std::uint32_t offset_dma_cr = 0x88;
constexpr std::uint32_t offset_dma_tdlr = 0x8c;
constexpr std::uint32_t offset_dma_rdlr = 0x90;
constexpr std::uint32_t offset_sda_setup = 0x94;
constexpr std::uint32_t offset_ack_general = 0x98;
constexpr std::uint32_t offset_enable_status = 0x9c;
constexpr std::uint32_t offset_spklen = 0xa0;
constexpr std::uint32_t offset_clr_restart_det = 0xa8;
constexpr std::uint32_t offset_comp_parameters = 0xf4;  // reads 0 (4.3.17)
constexpr std::uint32_t offset_comp_version = 0xf8;
constexpr std::uint32_t offset_comp_type = 0xfc;

// IC_CON.
constexpr std::uint32_t con_master = 1u << 0;
constexpr std::uint32_t con_speed = 3u << 1;
constexpr std::uint32_t con_standard = 1u << 1;
constexpr std::uint32_t con_fast = 2u << 1;
constexpr std::uint32_t con_slave_ten_bits = 1u << 3;
constexpr std::uint32_t con_ten_bits = 1u << 4;
constexpr std::uint32_t con_restart = 1u << 5;
constexpr std::uint32_t con_slave_off = 1u << 6;
constexpr std::uint32_t con_stop_if_addressed = 1u << 7;
constexpr std::uint32_t con_tx_empty_late = 1u << 8;
constexpr std::uint32_t con_rx_full_hold = 1u << 9;
constexpr std::uint32_t con_mask = 0x3ff;
// IC_TAR.
constexpr std::uint32_t tar_start_byte = 1u << 10;
constexpr std::uint32_t tar_special = 1u << 11;
// IC_DATA_CMD.
constexpr std::uint32_t command_read = 1u << 8;
constexpr std::uint32_t command_stop = 1u << 9;
constexpr std::uint32_t command_restart = 1u << 10;
constexpr std::uint32_t command_mask = 0x7ff;
constexpr std::uint32_t data_first = 1u << 11;
// Interrupts.
constexpr std::uint32_t irq_rx_under = 1u << 0;
constexpr std::uint32_t irq_rx_over = 1u << 1;
constexpr std::uint32_t irq_rx_full = 1u << 2;
constexpr std::uint32_t irq_tx_over = 1u << 3;
constexpr std::uint32_t irq_tx_empty = 1u << 4;
constexpr std::uint32_t irq_rd_req = 1u << 5;
constexpr std::uint32_t irq_tx_abort = 1u << 6;
constexpr std::uint32_t irq_rx_done = 1u << 7;
constexpr std::uint32_t irq_activity = 1u << 8;
constexpr std::uint32_t irq_stop = 1u << 9;
constexpr std::uint32_t irq_start = 1u << 10;
constexpr std::uint32_t irq_general_call = 1u << 11;
constexpr std::uint32_t irq_restart = 1u << 12;
constexpr std::uint32_t irq_all = 0x1fff;
constexpr std::uint32_t mask_reset = 0x8ff;
// IC_TX_ABRT_SOURCE.
constexpr std::uint32_t abort_7_bit_address = 1u << 0;
constexpr std::uint32_t abort_10_bit_first = 1u << 1;
constexpr std::uint32_t abort_10_bit_second = 1u << 2;
constexpr std::uint32_t abort_data = 1u << 3;
constexpr std::uint32_t abort_general_call = 1u << 4;
constexpr std::uint32_t abort_general_call_read = 1u << 5;
constexpr std::uint32_t abort_10_bit_read = 1u << 10;
constexpr std::uint32_t abort_master_off = 1u << 11;
constexpr std::uint32_t abort_arbitration = 1u << 12;
constexpr std::uint32_t abort_slave_flush = 1u << 13;
constexpr std::uint32_t abort_slave_arbitration = 1u << 14;
constexpr std::uint32_t abort_slave_reads = 1u << 15;
constexpr std::uint32_t abort_user = 1u << 16;
constexpr unsigned abort_flushed_shift = 23;
// IC_ENABLE, IC_STATUS, IC_ENABLE_STATUS.
constexpr std::uint32_t enable_abort = 1u << 1;
constexpr std::uint32_t enable_blocked = 1u << 2;
constexpr std::uint32_t status_activity = 1u << 0;
constexpr std::uint32_t status_tx_not_full = 1u << 1;
constexpr std::uint32_t status_tx_empty = 1u << 2;
constexpr std::uint32_t status_rx_not_empty = 1u << 3;
constexpr std::uint32_t status_rx_full = 1u << 4;
constexpr std::uint32_t status_master = 1u << 5;
constexpr std::uint32_t status_slave = 1u << 6;
constexpr std::uint32_t cut_off_while_busy = 1u << 1;
constexpr std::uint32_t cut_off_data_lost = 1u << 2;

constexpr std::uint32_t hold_transmit = 0xffff;  // IC_SDA_HOLD
constexpr std::uint32_t min_high = 6, min_low = 8, min_spike = 1;
constexpr std::uint32_t high_overhead = 7, low_overhead = 1;  // 4.3.14.1
constexpr Cycle bits_of_byte = 9;
// Minimum hold times: IC_SDA_HOLD cannot set shorter ones.
constexpr Cycle min_master_hold = 1, min_slave_hold = 7;

/// False for the gaps between the registers.
constexpr bool is_register(std::uint32_t offset) {
  return offset <= offset_sar || (offset >= offset_data_cmd && offset <= offset_fs_low) ||
         (offset >= offset_intr_stat && offset <= offset_spklen) ||
         offset == offset_clr_restart_det ||
         (offset >= offset_comp_parameters && offset <= offset_comp_type);
}

}  // namespace

I2c::I2c(int number, TimeWheel& wheel, FunctionPins& pins, IrqLines& irqs, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      name_("I2C" + std::to_string(number)),
      irq_(number == 0 ? Irq::i2c0 : Irq::i2c1),
      requests_(number == 0 ? Dreq::i2c0_tx : Dreq::i2c1_tx,
                number == 0 ? Dreq::i2c0_rx : Dreq::i2c1_rx),
      pins_(pins),
      first_signal_(number == 0 ? 0 : 2) {
  pins_.listen(*this);
  pins_.sense(scl());
  pins_.sense(sda());
  reset();
}

void I2c::reset() {
  slave_.leave();
  slave_cut_off_ = 0;
  addressed_ = nullptr;
  transmit_.clear();
  receive_.clear();
  first_byte_ = reads_ = flushed_ = false;
  control_ = con_slave_off | con_restart | con_fast | con_master;
  target_ = slave_address_ = 0x55;
  slow_high_ = 0x28;
  slow_low_ = 0x2f;
  fast_high_ = 0x06;
  fast_low_ = 0x0d;
  spike_ = 0x07;
  mask_ = mask_reset;
  raised_ = abort_source_ = enable_ = rx_level_ = tx_level_ = 0;
  requests_.set_control(0);
  dma_tx_level_ = dma_rx_level_ = 0;
  hold_ = 1;
  setup_ = 0x64;
  acknowledge_general_ = 1;
  slave_nack_ = 0;
  enter(Phase::idle, wheel_.now());  // with the times that hold from now on
  settle();
}

// --- time

Cycle I2c::high_cycles() const {
  const bool slow = (control_ & con_speed) == con_standard;
  return (slow ? slow_high_ : fast_high_) + spike_ + high_overhead;
}

Cycle I2c::low_cycles() const {
  const bool slow = (control_ & con_speed) == con_standard;
  return (slow ? slow_low_ : fast_low_) + low_overhead;
}

Cycle I2c::length(Phase phase) const {
  switch (phase) {
    case Phase::start:
      return high_cycles();
    case Phase::address:
    case Phase::address_low:
    case Phase::address_again:
    case Phase::data:
      return bits_of_byte * (high_cycles() + low_cycles());
    case Phase::restart:
    case Phase::restart_inside:
      return 2 * low_cycles() + high_cycles();
    case Phase::stop:
      return low_cycles() + high_cycles();
    case Phase::bus_free:
      return low_cycles();
    default:
      return 0;
  }
}

void I2c::enter(Phase phase, Cycle at) {
  phase_ = phase;
  const bool waits = phase == Phase::idle || phase == Phase::held || phase == Phase::rx_held;
  due_ = waits ? never_cycle : at + length(phase);
  shape_wires(phase, at);
}

void I2c::run(Cycle) {
  if (std::min(edge_at_, due_) <= wheel_.now()) step_wires(wheel_.now());
  if (due_ <= wheel_.now()) phase_ended(due_);
  if (slave_.due() <= wheel_.now()) {
    slave_.run(wheel_.now());
    put_wires(wheel_.now());
  }
  settle();
}

// --- pins

/// True if devices are on the pins only.
bool I2c::wired() const {
  return devices_.empty() && pins_.connected(scl()) && pins_.connected(sda());
}

bool I2c::lines_are_high() const { return pins_.input(scl()) && pins_.input(sda()); }

/// The nine bits that the master puts on SDA.
std::uint32_t I2c::bits_of(Phase phase) const {
  const std::uint32_t ten_first = 0xf0u | (target_ >> 7 & 6u);  // 11110, bits 9 and 8
  const auto byte = [](std::uint32_t value, bool ninth = true) {
    return (value & 0xffu) << 1 | (ninth ? 1u : 0u);
  };
  switch (phase) {
    case Phase::address:
      if (targets_ten_bits()) return byte(ten_first);
      return byte((targets_all() ? general_call : target_ & 0x7fu) << 1 | (reads_ ? 1u : 0u));
    case Phase::address_low:
      return byte(target_);
    case Phase::address_again:
      return byte(ten_first | 1u);
    default:
      break;
  }
  if ((command_ & command_read) == 0) return byte(command_);
  // The last byte before a STOP, a RESTART or another direction is not acknowledged.
  const bool turns = !transmit_.empty() && ((transmit_.front() & command_restart) != 0 ||
                                            (transmit_.front() & command_read) == 0);
  return byte(0xff, (command_ & command_stop) != 0 || turns);
}

void I2c::shape_wires(Phase phase, Cycle at) {
  const bool before = sda_;
  wires_ = {};
  switch (phase) {
    case Phase::start:
      wires_.kind = I2cWires::Kind::start;
      break;
    case Phase::address:
    case Phase::address_low:
    case Phase::address_again:
    case Phase::data:
      wires_.kind = I2cWires::Kind::byte;
      wires_.bits = bits_of(phase);
      sampled_ = 0;
      break;
    case Phase::restart:
    case Phase::restart_inside:
      wires_.kind = I2cWires::Kind::restart;
      break;
    case Phase::stop:
      wires_.kind = I2cWires::Kind::stop;
      break;
    case Phase::held:
    case Phase::rx_held:
      wires_.kind = I2cWires::Kind::held;
      break;
    default:
      break;
  }
  wires_.high = high_cycles();
  wires_.low = low_cycles();
  wires_.hold = std::clamp<Cycle>(hold_ & hold_transmit, min_master_hold, wires_.low - 1);
  wires_.before = before;
  wires_since_ = at;
  stretched_since_ = never_cycle;
  put_wires(at);
}

/// Open drain: a low is driven, a high is released. A slave does not drive as a master.
void I2c::put_wires(Cycle at) {
  const Cycle elapsed = std::max(at, wires_since_) - wires_since_;
  const I2cWires::Levels levels = wires_.at(elapsed);
  sda_ = levels.sda;
  pins_.put(sda(), false, !levels.sda || slave_.pulls_sda(), at);
  pins_.put(scl(), false, !levels.scl || slave_.pulls_scl(), at);
  const Cycle next = wires_.next_change(elapsed);
  const bool seen = pins_.connected(scl()) || pins_.connected(sda());
  edge_at_ = seen && next != never_cycle ? wires_since_ + next : never_cycle;
}

/// An edge, or the end of a byte. SDA is sampled before SCL falls.
void I2c::step_wires(Cycle at) {
  const Cycle elapsed = at - wires_since_;
  if (wires_.takes_bit(elapsed)) {
    pins_.bring_sources_up_to(at);
    sampled_ = sampled_ << 1 | (pins_.input(sda()) ? 1u : 0u);
  }
  if (due_ <= at) return;  // the next phase drives its own levels
  put_wires(at);
  if (!wired() || !wires_.releases_clock(elapsed) || pins_.input(scl())) return;
  stretched_since_ = at;
  edge_at_ = due_ = never_cycle;
}

/// A device releases SCL, which starts the high time, or the bus becomes free.
void I2c::pins_changed(Cycle at) {
  if (stretched_since_ != never_cycle) {
    if (!pins_.input(scl())) return;
    const Cycle late = at - std::exchange(stretched_since_, never_cycle);
    wires_since_ += late;
    due_ = wires_since_ + length(phase_);
  }
  if (is_slave()) slave_.lines_changed(line(scl()), line(sda()), at);
  put_wires(at);
  begin(at);
  settle();
}

void I2c::pins_connecting(Cycle at) {
  const bool seen = pins_.connected(scl()) || pins_.connected(sda());
  if (!seen && active()) put_wires(at);
}

void I2c::phase_ended(Cycle at) {
  switch (phase_) {
    case Phase::start:
    case Phase::restart:
      return enter(Phase::address, at);
    case Phase::restart_inside:
      return enter(Phase::address_again, at);
    case Phase::address:
    case Phase::address_low:
    case Phase::address_again:
      return address_ended(at);
    case Phase::data:
      return data_ended(at);
    case Phase::stop:
      return stop_ended(at);
    case Phase::bus_free:
      enter(Phase::idle, at);
      return begin(at);
    default:
      return;
  }
}

// --- a transfer

/// A transfer starts if the bus is free and there is a command.
void I2c::begin(Cycle at) {
  if (phase_ != Phase::idle || !enabled() || transmit_.empty() || (enable_ & enable_blocked) != 0)
    return;
  if (is_slave()) return;
  if (wired() && !lines_are_high()) return;
  if (refused(transmit_.front())) return;
  reads_ = (transmit_.front() & command_read) != 0;
  raised_ |= irq_start | irq_activity;
  enter(Phase::start, at);
}

/// A command that the master aborts instead of sending a START.
bool I2c::refused(std::uint32_t command) {
  const bool reads = (command & command_read) != 0;
  if (!on(con_master)) {
    abort(abort_master_off);
    return true;
  }
  if ((target_ & tar_special) != 0) {
    if ((target_ & tar_start_byte) != 0)
      not_modelled_(name_ + " IC_TAR: the START byte is not sent");
    else if (reads) {
      abort(abort_general_call_read);
      return true;
    }
  }
  if (on(con_ten_bits) && reads && !on(con_restart)) {
    abort(abort_10_bit_read);
    return true;
  }
  return false;
}

/// IC_TAR asks for a general call.
bool I2c::targets_all() const { return (target_ & (tar_special | tar_start_byte)) == tar_special; }

bool I2c::targets_ten_bits() const { return on(con_ten_bits) && !targets_all(); }

/// Some device has the two high bits of a 10-bit address.
bool I2c::first_address_acknowledged() const {
  if (wired()) return wired_device_.acknowledged();
  return std::any_of(devices_.begin(), devices_.end(), [this](const Slave& slave) {
    return slave.ten_bits && slave.address >> 8 == (target_ >> 8 & 3u);
  });
}

/// Finds the device and addresses it; false: no acknowledgement.
bool I2c::address_device(Cycle at) {
  const bool ten_bits = targets_ten_bits();
  const std::uint32_t address =
      targets_all() ? general_call : target_ & (ten_bits ? 0x3ffu : 0x7fu);
  I2cDevice* before = std::exchange(addressed_, nullptr);
  for (const Slave& slave : devices_) {
    if (slave.ten_bits != ten_bits || slave.address != address) continue;
    if (slave.device->addressed(reads_, at)) addressed_ = slave.device;
    break;
  }
  if (wired() && wired_device_.acknowledged()) addressed_ = &wired_device_;
  if (before != nullptr && before != addressed_) before->stopped(at);
  return addressed_ != nullptr;
}

void I2c::address_ended(Cycle at) {
  const bool ten_bits = targets_ten_bits();
  std::uint32_t source = targets_all() ? abort_general_call : abort_7_bit_address;
  if (ten_bits && phase_ == Phase::address) {
    if (first_address_acknowledged()) return enter(Phase::address_low, at);
    source = abort_10_bit_first;
  } else if (ten_bits && phase_ == Phase::address_low && reads_) {
    // The device is addressed for writing first, then again for reading.
    const bool known = std::any_of(devices_.begin(), devices_.end(), [this](const Slave& slave) {
      return slave.ten_bits && slave.address == (target_ & 0x3ffu);
    });
    if (known || (wired() && wired_device_.acknowledged())) {
      raised_ |= irq_start;
      return enter(Phase::restart_inside, at);
    }
    source = abort_10_bit_second;
  } else {
    if (address_device(at)) return begin_data(at);
    if (ten_bits) source = phase_ == Phase::address_low ? abort_10_bit_second : abort_10_bit_first;
  }
  abort(source);
  enter(Phase::stop, at);
}

/// The command leaves the FIFO when its byte goes onto the wires (assumed).
void I2c::begin_data(Cycle at) {
  first_byte_ = true;
  // Aborted, or the FIFO was flushed meanwhile (IC_ENABLE cleared).
  if ((enable_ & enable_abort) != 0 || transmit_.empty()) return enter(Phase::stop, at);
  command_ = transmit_.front();
  transmit_.pop_front();
  enter(Phase::data, at);
}

void I2c::data_ended(Cycle at) {
  if ((command_ & command_read) != 0) {
    received_ = addressed_->byte_read(at);
    if (!push_received(received_)) return enter(Phase::rx_held, at);
  } else if (!addressed_->byte_written(static_cast<std::uint8_t>(command_), at)) {
    abort(abort_data);
    return enter(Phase::stop, at);
  }
  byte_done(at);
}

/// False: the receive FIFO is full; the bus must be held.
bool I2c::push_received(std::uint8_t byte) {
  if (!enabled()) return true;  // the FIFOs are held empty
  if (receive_.size() >= fifo_depth) {
    if (on(con_rx_full_hold)) return false;
    raised_ |= irq_rx_over;
  } else {
    receive_.push_back(byte | (first_byte_ ? data_first : 0u));
  }
  first_byte_ = false;
  return true;
}

void I2c::byte_done(Cycle at) {
  const bool ends = !enabled() || (enable_ & enable_abort) != 0 || (command_ & command_stop) != 0;
  if (ends) return enter(Phase::stop, at);
  next(at);
}

/// SCL is low after a byte without STOP.
void I2c::next(Cycle at) {
  if (transmit_.empty()) return enter(Phase::held, at);
  const std::uint32_t command = transmit_.front();
  const bool turns = ((command ^ command_) & command_read) != 0;
  if (!turns && (command & command_restart) == 0) {
    command_ = command;
    transmit_.pop_front();
    return enter(Phase::data, at);
  }
  if (!on(con_restart)) return enter(Phase::stop, at);  // and a START instead
  if (refused(command)) return enter(Phase::stop, at);
  raised_ |= irq_start;
  reads_ = (command & command_read) != 0;
  // A device with 10 bits that was written to is read after the first address byte alone.
  const bool was_addressed = on(con_ten_bits) && reads_ && turns;
  enter(was_addressed ? Phase::restart_inside : Phase::restart, at);
}

void I2c::stop_ended(Cycle at) {
  raised_ |= irq_stop;
  if ((enable_ & enable_abort) != 0) {
    abort(abort_user);
    enable_ &= ~enable_abort;
  }
  if (addressed_ != nullptr) std::exchange(addressed_, nullptr)->stopped(at);
  if (!enabled()) raised_ &= ~(irq_rx_under | irq_rx_over | irq_tx_over | irq_activity);
  enter(Phase::bus_free, at);
}

/// Both FIFOs are flushed and stay empty until IC_CLR_TX_ABRT is read.
void I2c::abort(std::uint32_t source) {
  const auto flushed = static_cast<std::uint32_t>(transmit_.size());
  abort_source_ |= source;
  abort_source_ = (abort_source_ & ((1u << abort_flushed_shift) - 1)) | flushed
                                                                            << abort_flushed_shift;
  raised_ |= irq_tx_abort;
  transmit_.clear();
  receive_.clear();
  flushed_ = true;
}

// --- slave

bool I2c::is_slave() const { return enabled() && !on(con_master) && !on(con_slave_off); }

void I2c::begin_slave() {
  slave_cut_off_ = 0;
  if (on(con_master) && !on(con_slave_off))
    not_modelled_(name_ + " IC_CON: both master and slave are set; it works as master only");
  if (!is_slave()) return;
  const Cycle setup = std::max(setup_, 1u) - 1;  // IC_SDA_SETUP counts one more
  slave_.begin({slave_address_, on(con_slave_ten_bits), acknowledge_general_ != 0, slave_nack_ != 0,
                std::max<Cycle>(hold_ & hold_transmit, min_slave_hold), setup},
               line(scl()), line(sda()));
}

/// The slave is disabled; a byte under way is not acknowledged.
void I2c::leave_slave() {
  if (!slave_.active()) return;
  slave_cut_off_ =
      (slave_.listens() ? cut_off_while_busy : 0u) | (slave_.receives() ? cut_off_data_lost : 0u);
  slave_.leave();
  put_wires(wheel_.now());
}

/// A FIFO has a byte or room: SCL may be released.
void I2c::serve_slave() {
  if (!is_slave()) return;
  slave_.byte_ready(wheel_.now());
  slave_.room_ready();
  put_wires(wheel_.now());
}

void I2c::started(bool addressed) {
  raised_ |= irq_start | irq_activity | (addressed ? irq_restart : 0u);
}

void I2c::stopped(bool addressed) {
  if (addressed || !on(con_stop_if_addressed)) raised_ |= irq_stop;
}

void I2c::addressed(bool for_reading, bool generally) {
  if (generally) raised_ |= irq_general_call;
  if (!for_reading) first_byte_ = true;
}

/// Bytes in the FIFO when the master begins to read are old and are flushed (4.3.10.1.2).
std::optional<std::uint8_t> I2c::byte_wanted(bool first) {
  if (!transmit_.empty() && first) {
    abort(abort_slave_flush);
  } else if (!transmit_.empty()) {
    const std::uint32_t command = transmit_.front();
    transmit_.pop_front();
    if ((command & command_read) == 0) return static_cast<std::uint8_t>(command);
    abort(abort_slave_reads);
  }
  raised_ |= irq_rd_req;
  return std::nullopt;
}

/// Bytes that the master did not read are flushed (4.3.10.1.4).
void I2c::byte_refused() {
  raised_ |= irq_rx_done;
  if (!transmit_.empty()) abort(abort_slave_flush);
}

void I2c::contended() { abort(abort_arbitration | abort_slave_arbitration); }

// --- registers

/// A byte, or the condition or address before it, is on the wires.
bool I2c::shifting() const {
  return active() && phase_ != Phase::held && phase_ != Phase::rx_held && phase_ != Phase::stop;
}

std::uint32_t I2c::raw_interrupts() const {
  const bool late = on(con_tx_empty_late) && shifting();
  const bool tx_empty = (enabled() || active()) && transmit_.size() <= tx_level_ && !late;
  return raised_ | (tx_empty ? irq_tx_empty : 0u) |
         (receive_.size() > rx_level_ ? irq_rx_full : 0u);
}

std::uint32_t I2c::status() const {
  return (active() ? status_activity | status_master : 0u) |
         (slave_.active() ? status_activity | status_slave : 0u) |
         (transmit_.size() < fifo_depth ? status_tx_not_full : 0u) |
         (transmit_.empty() ? status_tx_empty : 0u) |
         (receive_.empty() ? 0u : status_rx_not_empty) |
         (receive_.size() >= fifo_depth ? status_rx_full : 0u);
}

void I2c::update_lines() {
  irqs_.set(irq_, (raw_interrupts() & mask_) != 0);
  if (!requests_.connected()) return;
  const std::size_t wanted = dma_tx_level_ + 1;  // requests while the level is at most TDL
  const bool sends = enabled() && transmit_.size() < wanted;
  requests_.transmit(sends ? wanted - transmit_.size() : 0);
  const bool receives = receive_.size() > dma_rx_level_;
  requests_.receive(receives ? receive_.size() - dma_rx_level_ : 0);
}

void I2c::settle() {
  update_lines();
  wheel_.set(slot_, std::min({due_, edge_at_, slave_.due()}));
}

std::uint32_t I2c::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_con:
      return control_;
    case offset_tar:
      return target_;
    case offset_sar:
      return slave_address_;
    case offset_data_cmd:
      return receive_.empty() ? 0 : receive_.front();
    case offset_ss_high:
      return slow_high_;
    case offset_ss_low:
      return slow_low_;
    case offset_fs_high:
      return fast_high_;
    case offset_fs_low:
      return fast_low_;
    case offset_intr_stat:
      return raw_interrupts() & mask_;
    case offset_intr_mask:
      return mask_;
    case offset_raw_intr_stat:
      return raw_interrupts();
    case offset_rx_tl:
      return rx_level_;
    case offset_tx_tl:
      return tx_level_;
    case offset_enable:
      return enable_;
    case offset_status:
      return status();
    case offset_txflr:
      return static_cast<std::uint32_t>(transmit_.size());
    case offset_rxflr:
      return static_cast<std::uint32_t>(receive_.size());
    case offset_sda_hold:
      return hold_;
    case offset_abort_source:
      return abort_source_;
    case offset_slave_nack:
      return slave_nack_;
    case offset_dma_cr:
      return requests_.control();
    case offset_dma_tdlr:
      return dma_tx_level_;
    case offset_dma_rdlr:
      return dma_rx_level_;
    case offset_sda_setup:
      return setup_;
    case offset_ack_general:
      return acknowledge_general_;
    case offset_enable_status:
      return (enabled() || active() ? 1u : 0u) | slave_cut_off_;
    case offset_spklen:
      return spike_;
    case offset_comp_version:
      return 0x3230312a;
    case offset_comp_type:
      return 0x44570140;
    default:
      return 0;
  }
}

/// Clears interrupts; returns whether one of them was set.
std::uint32_t I2c::take_interrupts(std::uint32_t bits) {
  const bool there = (raised_ & bits) != 0;
  // ACTIVITY is set again as long as there is activity.
  raised_ &= ~(active() || slave_.active() ? bits & ~irq_activity : bits);
  if ((bits & irq_tx_abort) != 0) {
    abort_source_ = 0;
    flushed_ = false;
  }
  return there ? 1 : 0;
}

std::uint32_t I2c::read_clear(std::uint32_t offset) {
  switch (offset) {
    case offset_clr_intr:
      return take_interrupts(irq_all);
    case offset_clr_rx_under:
      return take_interrupts(irq_rx_under);
    case offset_clr_rx_over:
      return take_interrupts(irq_rx_over);
    case offset_clr_tx_over:
      return take_interrupts(irq_tx_over);
    case offset_clr_rd_req:
      return take_interrupts(irq_rd_req);
    case offset_clr_tx_abrt:
      return take_interrupts(irq_tx_abort);
    case offset_clr_rx_done:
      return take_interrupts(irq_rx_done);
    case offset_clr_activity:
      return take_interrupts(irq_activity);
    case offset_clr_stop_det:
      return take_interrupts(irq_stop);
    case offset_clr_start_det:
      return take_interrupts(irq_start);
    case offset_clr_gen_call:
      return take_interrupts(irq_general_call);
    default:
      return take_interrupts(irq_restart);
  }
}

std::uint32_t I2c::pop_received() {
  if (receive_.empty()) {
    raised_ |= irq_rx_under;
    return 0;
  }
  const std::uint32_t value = receive_.front();
  receive_.pop_front();
  if (phase_ == Phase::rx_held) {
    push_received(received_);
    byte_done(wheel_.now());
  }
  serve_slave();
  return value;
}

std::uint32_t I2c::read(std::uint32_t offset) {
  std::uint32_t value = 0;
  if (offset == offset_data_cmd)
    value = pop_received();
  else if ((offset >= offset_clr_intr && offset <= offset_clr_gen_call) ||
           offset == offset_clr_restart_det)
    value = read_clear(offset);
  else if (is_register(offset))
    return peek(offset);
  else
    not_modelled_(name_ + ": no register at this offset");
  settle();
  return value;
}

void I2c::write_command(std::uint32_t value) {
  if (!enabled() || flushed_) return;  // the FIFO is held empty
  if (transmit_.size() >= fifo_depth) {
    raised_ |= irq_tx_over;
    return;
  }
  transmit_.push_back(value & command_mask);
  if (phase_ == Phase::held) return next(wheel_.now());
  serve_slave();
  begin(wheel_.now());
}

// A transfer under way ends with its byte. A bus that is held stays held, so that a RESTART can
// follow when the master is enabled again (assumed: drivers change IC_TAR that way).
void I2c::write_enable(std::uint32_t value) {
  const bool was_enabled = enabled();
  const std::uint32_t pending = was_enabled ? enable_ & enable_abort : 0;
  enable_ = (value & (1u | enable_blocked)) | pending;
  if (!enabled()) {
    transmit_.clear();
    receive_.clear();
    abort_source_ &= (1u << abort_flushed_shift) - 1;
    raised_ &= ~irq_general_call;
    if (was_enabled) leave_slave();
    if (phase_ == Phase::rx_held) return enter(Phase::stop, wheel_.now());
    if (!active()) raised_ &= ~(irq_rx_under | irq_rx_over | irq_tx_over | irq_activity);
    return;
  }
  if (!was_enabled) begin_slave();
  if ((value & enable_abort) != 0 && was_enabled) {
    if (!active()) return abort(abort_user);
    enable_ |= enable_abort;
    if (phase_ == Phase::held || phase_ == Phase::rx_held) return enter(Phase::stop, wheel_.now());
  }
  begin(wheel_.now());
}

/// Writes registers that can be written only while the block is disabled; false: another register.
bool I2c::write_settings(std::uint32_t offset, std::uint32_t value) {
  const std::uint32_t half = value & 0xffffu;
  std::uint32_t* setting = nullptr;
  std::uint32_t kept = 0;
  const auto set = [&](std::uint32_t& which, std::uint32_t to) {
    setting = &which;
    kept = to;
  };
  switch (offset) {
    case offset_con: {
      const bool standard = (value & con_speed) == con_standard;
      set(control_, (value & con_mask & ~con_speed) | (standard ? con_standard : con_fast));
      break;
    }
    case offset_tar:
      set(target_, value & 0xfffu);
      break;
    case offset_sar:
      set(slave_address_, value & 0x3ffu);
      break;
    case offset_ss_high:
      set(slow_high_, std::max(half, min_high));
      break;
    case offset_ss_low:
      set(slow_low_, std::max(half, min_low));
      break;
    case offset_fs_high:
      set(fast_high_, std::max(half, min_high));
      break;
    case offset_fs_low:
      set(fast_low_, std::max(half, min_low));
      break;
    case offset_sda_hold:
      set(hold_, value & 0xffffffu);
      break;
    case offset_slave_nack:
      set(slave_nack_, value & 1u);
      break;
    case offset_sda_setup:
      set(setup_, value & 0xffu);
      break;
    case offset_spklen:
      set(spike_, std::max(value & 0xffu, min_spike));
      break;
    default:
      return false;
  }
  if (!enabled()) *setting = kept;
  return true;
}

void I2c::write(std::uint32_t offset, std::uint32_t value) {
  constexpr std::uint32_t deepest = fifo_depth;
  switch (offset) {
    case offset_data_cmd:
      write_command(value);
      break;
    case offset_intr_mask:
      mask_ = value & irq_all;
      break;
    case offset_rx_tl:
      rx_level_ = std::min(value & 0xffu, deepest);
      break;
    case offset_tx_tl:
      tx_level_ = std::min(value & 0xffu, deepest);
      break;
    case offset_enable:
      write_enable(value);
      break;
    case offset_dma_cr:
      requests_.set_control(value & 3u);
      break;
    case offset_dma_tdlr:
      dma_tx_level_ = value & 0xfu;
      break;
    case offset_dma_rdlr:
      dma_rx_level_ = value & 0xfu;
      break;
    case offset_ack_general:
      acknowledge_general_ = value & 1u;
      slave_.take_general_calls(acknowledge_general_ != 0);
      break;
    default:
      if (!write_settings(offset, value) && !is_register(offset))
        not_modelled_(name_ + ": no register at this offset");
  }
  settle();
}

}  // namespace lamplock::sim::chip
