#include "sim/chip/dma/dma.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "sim/chip/dma/transfer_data.hpp"

namespace lamplock::sim::chip {

namespace {

// Offsets (RP2040 datasheet, 2.5.7).
constexpr std::uint32_t channel_stride = 0x40, intr = 0x400, ints0 = 0x40c, intr1_reserved = 0x410,
                        ints1 = 0x41c, timer0 = 0x420, multi_chan_trigger = 0x430,
                        sniff_ctrl = 0x434, sniff_data = 0x438, fifo_levels = 0x440,
                        chan_abort = 0x444, n_channels = 0x448, debug = 0x800;
constexpr std::uint32_t channel_bits = (1u << dma_channel_count) - 1u;
constexpr std::uint32_t error_bits = 3u
                                     << 29;  // WRITE_ERROR and READ_ERROR of CTRL, cleared by ones

// TREQ_SEL.
constexpr unsigned first_timer = 0x3b, permanent = 0x3f;
constexpr unsigned max_credits = 63;

/// The four registers of a channel in the order of each of its four layouts (2.5.2.1).
enum class Role : std::uint8_t { read_address, write_address, count, control };
constexpr std::array<std::array<Role, 4>, 4> layouts{{
    {Role::read_address, Role::write_address, Role::count, Role::control},
    {Role::control, Role::read_address, Role::write_address, Role::count},
    {Role::control, Role::count, Role::read_address, Role::write_address},
    {Role::control, Role::write_address, Role::count, Role::read_address},
}};

/// DREQs of FIFOs that are filled by writes: a transfer occupies its place when it is written.
constexpr bool is_transmit(unsigned dreq) {
  if (dreq < 16) return (dreq & 4u) == 0;
  if (dreq < 24 || (dreq >= 32 && dreq < 36)) return (dreq & 1u) == 0;
  return dreq == static_cast<unsigned>(Dreq::xip_ssitx);
}
constexpr bool is_pwm(unsigned dreq) { return dreq >= 24 && dreq < 32; }

}  // namespace

Dma::Dma(ClockOwner& clock, Bus& bus, DreqLines& dreqs, const std::array<PioBlock, 2>& pio,
         IrqLines& irqs, const Timing& timing, NotModelled not_modelled)
    : owner_(clock),
      bus_(bus),
      dreqs_(dreqs),
      pio_(pio),
      irqs_(irqs),
      timing_(timing),
      not_modelled_(std::move(not_modelled)),
      interrupts_{InterruptRegisters{intr, channel_bits},
                  InterruptRegisters{intr1_reserved, channel_bits}} {}

// ---------------------------------------------------------------------------------------------
// Clocks

/// Advances credits on their way and pacing timers through `clock`.
void Dma::advance_to(Cycle clock) {
  if (clock <= now_) return;
  const std::uint64_t clocks = clock - now_;
  now_ = clock;
  for (std::uint32_t rest = busy_mask_; rest != 0; rest &= rest - 1) {
    Channel& channel = channels_[static_cast<unsigned>(std::countr_zero(rest))];
    if (channel.arriving == 0) continue;
    const std::uint64_t there =
        clocks >= 63 ? channel.arriving : channel.arriving & ((std::uint64_t{2} << clocks) - 1);
    if (there != 0)
      channel.credits =
          std::min(max_credits, channel.credits + static_cast<unsigned>(std::popcount(there)));
    channel.arriving = clocks >= 63 ? 0 : (channel.arriving & ~there) >> clocks;
  }
  for (unsigned i = 0; i < dma_timer_count; ++i) {
    Timer& timer = timers_[i];
    if (timer.x == 0 || timer.y == 0) continue;
    const std::uint64_t sum = timer.sum + std::min(timer.x, timer.y) * clocks;
    timer.sum = static_cast<std::uint32_t>(sum % timer.y);
    if (sum < timer.y) continue;
    // Due at each request as long as a channel uses the timer, so that it has at most one.
    for (Channel& channel : channels_)
      if (channel.busy && channel.treq() == first_timer + i)
        channel.arriving |= std::uint64_t{1} << timing_.dma_start;
  }
}

void Dma::clock(Cycle clock) {
  if (stopped_) return;
  advance_to(clock);
  give_back();
  if (fifo_level_ != 0) write_phase(clock);
  if (busy_mask_ != 0) read_phase(clock);
  find_due(clock, true);
}

/// Adds the cycles of another master's access that was served before the last read or write.
void Dma::give_back() {
  Arbiter& arbiter = bus_.arbiter();
  if (arbiter.owes(Requester::dma_read)) {
    const Cycle was = read_free_;
    read_free_ += arbiter.take_owed(Requester::dma_read);
    InFlight& last = fifo_[(fifo_head_ + fifo_level_ + fifo_depth - 1) % fifo_depth];
    if (fifo_level_ != 0 && last.ready == was) last.ready = read_free_;
  }
  if (arbiter.owes(Requester::dma_write)) write_free_ += arbiter.take_owed(Requester::dma_write);
}

void Dma::write_phase(Cycle clock) {
  const InFlight front = fifo_[fifo_head_];
  if (front.ready > clock || write_free_ > clock) return;
  fifo_head_ = (fifo_head_ + 1) % fifo_depth;
  --fifo_level_;
  Channel& channel = channels_[front.channel];
  const Width width = static_cast<Width>(1u << channel.size_shift());
  const std::uint32_t address = aligned(channel.write_address, channel);
  channel.write_address = next_address(channel, channel.write_address, true);
  --channel.in_flight;
  // A write to the DMA's own registers may start channels; this one's state is complete by then.
  const Access access = bus_.write(address, front.data, width, Master::dma, clock);
  write_free_ = clock + 1 + access.wait;
  if (!channel.busy) {
    // Aborted or failed: transfers in flight could not be revoked.
    if (channel.in_flight == 0 && std::exchange(channel.aborting, false)) raise(front.channel);
    return;
  }
  if (access.fault) {
    channel.write_error = true;
    stop(front.channel);
    raise(front.channel);
    return;
  }
  if (--channel.count == 0) finish(front.channel, clock);
}

void Dma::read_phase(Cycle clock) {
  // A sequence of no transfers ends as soon as it has begun (assumed).
  for (std::uint32_t rest = busy_mask_; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(rest));
    if (channels_[i].count == 0 && channels_[i].ready <= clock) finish(i, clock);
  }
  if (read_free_ > clock || fifo_level_ == fifo_depth) return;
  const unsigned i = choose(clock);
  if (i == dma_channel_count) return;
  Channel& channel = channels_[i];
  if (channel.treq() != permanent) --channel.credits;
  --channel.to_read;
  const unsigned bits = 8u << channel.size_shift();
  const std::uint32_t address = aligned(channel.read_address, channel);
  channel.read_address = next_address(channel, channel.read_address, false);
  const Access access = bus_.read(address, static_cast<Width>(bits / 8), Master::dma, clock);
  read_free_ = clock + 1 + access.wait;
  if (access.fault) {
    channel.read_error = true;
    stop(i);
    raise(i);
    return;
  }
  std::uint32_t data = access.value;
  if ((channel.control >> 22 & 1u) != 0) data = swap_bytes(data, bits);
  if ((channel.control >> 23 & 1u) != 0 && sniffer_.watches(i)) sniffer_.observe(data, bits);
  ++channel.in_flight;
  fifo_[(fifo_head_ + fifo_level_++) % fifo_depth] = {static_cast<std::uint8_t>(i), data,
                                                      read_free_};
}

bool Dma::wants_read(const Channel& channel, Cycle clock) const {
  return channel.enabled() && channel.to_read != 0 && channel.ready <= clock &&
         (channel.treq() == permanent || channel.credits != 0);
}

/// Each round: every ready high-priority channel once, then one other (description of
/// HIGH_PRIORITY). dma_channel_count: none.
unsigned Dma::choose(Cycle clock) {
  std::uint32_t high = 0, low = 0;
  for (std::uint32_t rest = busy_mask_; rest != 0; rest &= rest - 1) {
    const auto i = static_cast<unsigned>(std::countr_zero(rest));
    if (wants_read(channels_[i], clock)) (channels_[i].high_priority() ? high : low) |= 1u << i;
  }
  const auto after = [](std::uint32_t mask, unsigned last) {
    const std::uint32_t above = mask & ~((2u << last) - 1u);
    return static_cast<unsigned>(std::countr_zero(above != 0 ? above : mask));
  };
  if (low == 0 && (high & ~high_served_) == 0) high_served_ = 0;
  if (const std::uint32_t waiting = high & ~high_served_; waiting != 0) {
    last_high_ = after(waiting, last_high_);
    high_served_ |= 1u << last_high_;
    return last_high_;
  }
  if (low == 0) return dma_channel_count;
  high_served_ = 0;
  return last_low_ = after(low, last_low_);
}

unsigned Dma::available(unsigned dreq) const {
  if (dreq >= 16) return dreqs_.level(dreq);
  const PioBlock& block = pio_[dreq / 8];
  return (dreq & 4u) != 0 ? block.rx_level(dreq & 3u) : block.tx_space(dreq & 3u);
}

/// Transfers of a FIFO that are covered by credits or in flight.
unsigned Dma::owed(const Channel& channel) const {
  // Without an instruction for it counting bits is a call, and mostly there are none.
  const int arriving = channel.arriving == 0 ? 0 : std::popcount(channel.arriving);
  return channel.credits + static_cast<unsigned>(arriving) +
         (is_transmit(channel.treq()) ? channel.in_flight : 0);
}

void Dma::set_clock(bool runs, Cycle next) {
  if (runs != stopped_) return;
  stopped_ = !runs;
  if (stopped_) {
    advance_to(next - 1);
    stopped_at_ = next;
    due_ = never_cycle;
    return;
  }
  const Cycle still = next - stopped_at_;
  for (Channel& channel : channels_) channel.ready += still;
  for (InFlight& transfer : fifo_) transfer.ready += still;
  for (Cycle* at : {&read_free_, &write_free_, &now_}) *at += still;
  find_due(next - 1);
}

void Dma::levels_changed(Cycle clock) {
  if (stopped_) return;
  if (busy_mask_ != 0) due_ = std::min(due_, clock);
}

void Dma::pulse(unsigned dreq, Cycle clock) {
  if (stopped_) return;
  advance_to(clock);
  for (Channel& channel : channels_)
    if (channel.busy && channel.treq() == dreq)
      channel.arriving |= std::uint64_t{1} << timing_.dma_start;
  find_due(clock);
}

/// Computes when it has something to do next; `gives_credits`: at the end of a clock, gives at most
/// one credit to each channel whose FIFO has more than is covered.
void Dma::find_due(Cycle clock, bool gives_credits) {
  due_ = never_cycle;
  const auto by = [this, clock](Cycle when) { due_ = std::min(due_, std::max(when, clock + 1)); };
  if (fifo_level_ != 0) by(std::max(fifo_[fifo_head_].ready, write_free_));
  // A request is known Timing::dma_start clocks before its read: early enough for the cores'
  // accesses in that clock.
  bool active = fifo_level_ != 0;
  std::uint32_t wraps = 0;
  for (std::uint32_t rest = busy_mask_; rest != 0; rest &= rest - 1) {
    Channel& channel = channels_[static_cast<unsigned>(std::countr_zero(rest))];
    const unsigned treq = channel.treq();
    if (treq < first_timer && !is_pwm(treq)) {
      const unsigned there = available(treq), spoken_for = owed(channel);
      if (there > spoken_for) {
        if (gives_credits) channel.arriving |= std::uint64_t{1} << timing_.dma_start;
        if (!gives_credits || there > spoken_for + 1) by(clock + 1);
      }
    }
    if (is_pwm(treq)) wraps |= 1u << (treq - static_cast<unsigned>(Dreq::pwm_wrap0));
    if (channel.count == 0) by(channel.ready);
    if (channel.enabled() && channel.to_read != 0 && fifo_level_ != fifo_depth &&
        (treq == permanent || channel.credits != 0)) {
      by(std::max(channel.ready, read_free_));
      active = true;
    }
    active = active || channel.arriving != 0;
    if (channel.arriving != 0) by(now_ + static_cast<unsigned>(std::countr_zero(channel.arriving)));
    if (treq >= first_timer && treq != permanent) {
      const Timer& timer = timers_[treq - first_timer];
      if (timer.x != 0 && timer.y != 0) {
        const std::uint32_t step = std::min(timer.x, timer.y);
        by(now_ + (timer.y - timer.sum + step - 1) / step);
      }
    }
  }
  dreqs_.await_wraps(wraps);
  bus_.set_dma_active(active);
  if (idle() && on_idle) on_idle();
}

// ---------------------------------------------------------------------------------------------
// Sequences

void Dma::trigger(unsigned i, Cycle clock) {
  if (i >= dma_channel_count) return;
  Channel& channel = channels_[i];
  if (!channel.enabled() || channel.busy) return;
  channel.busy = true;
  busy_mask_ |= 1u << i;
  channel.count = channel.to_read = channel.reload;
  channel.credits = 0;
  channel.arriving = 0;
  channel.ready = clock + timing_.dma_start;
}

/// A trigger register was written: 0 is the null trigger (2.5.2.3).
void Dma::trigger_written(unsigned i, std::uint32_t value, Cycle clock) {
  if (value != 0)
    trigger(i, clock);
  else if (channels_[i].quiet())
    raise(i);
}

void Dma::stop(unsigned i) {
  channels_[i].busy = false;
  busy_mask_ &= ~(1u << i);
}

void Dma::finish(unsigned i, Cycle clock) {
  const Channel& channel = channels_[i];
  stop(i);
  if (!channel.quiet()) raise(i);
  if (channel.chain_to() != i) trigger(channel.chain_to(), clock);
}

/// 2.5.5.3. Transfers in flight are still written; that they then raise the interrupt of the
/// channel is erratum RP2040-E13.
void Dma::abort(unsigned i) {
  Channel& channel = channels_[i];
  stop(i);
  channel.count = channel.to_read = 0;
  channel.credits = 0;
  channel.arriving = 0;
  channel.aborting = channel.in_flight != 0;
}

std::uint32_t Dma::next_address(const Channel& channel, std::uint32_t address, bool write) const {
  if ((channel.control >> (write ? 5 : 4) & 1u) == 0) return address;
  const std::uint32_t next = address + (1u << channel.size_shift());
  const unsigned ring = channel.control >> 6 & 0xfu;
  if (ring == 0 || ((channel.control >> 10 & 1u) != 0) != write) return next;
  const std::uint32_t mask = (1u << ring) - 1u;
  return (address & ~mask) | (next & mask);
}

std::uint32_t Dma::aligned(std::uint32_t address, const Channel& channel) {
  const std::uint32_t low = (1u << channel.size_shift()) - 1u;
  if ((address & low) != 0) report("address that is not aligned to the transfer size");
  return address & ~low;
}

void Dma::raise(unsigned i) {
  raised_ |= 1u << i;
  update_lines();
}

void Dma::update_lines() {
  irqs_.set(Irq::dma_0, interrupts_[0].status(raised_) != 0);
  irqs_.set(Irq::dma_1, interrupts_[1].status(raised_) != 0);
}

// ---------------------------------------------------------------------------------------------
// Registers

std::uint32_t Dma::control_of(const Channel& channel) const {
  return channel.control | (channel.busy ? 1u << 24 : 0u) | (channel.write_error ? 1u << 29 : 0u) |
         (channel.read_error ? 1u << 30 : 0u) |
         (channel.write_error || channel.read_error ? 1u << 31 : 0u);
}

void Dma::set_control(Channel& channel, std::uint32_t value) {
  channel.control = value & 0x00ff'ffffu;
  if ((value >> 29 & 1u) != 0) channel.write_error = false;
  if ((value >> 30 & 1u) != 0) channel.read_error = false;
}

std::optional<std::uint32_t> Dma::global_value(std::uint32_t offset) const {
  if (offset >= intr && offset <= ints1 && offset != intr1_reserved)
    return interrupts_[offset < intr1_reserved ? 0 : 1].read(offset, raised_);
  if (offset >= timer0 && offset < timer0 + 4 * dma_timer_count) {
    const Timer& timer = timers_[(offset - timer0) / 4];
    return timer.x << 16 | timer.y;
  }
  switch (offset) {
    case multi_chan_trigger:
      return 0;
    case sniff_ctrl:
      return sniffer_.control();
    case sniff_data:
      return sniffer_.data();
    case fifo_levels:
      // Data and write addresses wait together; reads are issued without waiting.
      return fifo_level_ << 8 | fifo_level_;
    case chan_abort: {
      std::uint32_t value = 0;
      for (unsigned i = 0; i < dma_channel_count; ++i)
        value |= (channels_[i].aborting ? 1u : 0u) << i;
      return value;
    }
    case n_channels:
      return dma_channel_count;
    default:
      return std::nullopt;
  }
}

std::optional<std::uint32_t> Dma::value_of(std::uint32_t offset) const {
  owner_.bring_up_to_date();
  if (offset < dma_channel_count * channel_stride) {
    const Channel& channel = channels_[offset / channel_stride];
    switch (layouts[offset >> 4 & 3u][offset >> 2 & 3u]) {
      case Role::read_address:
        return channel.read_address;
      case Role::write_address:
        return channel.write_address;
      case Role::count:
        return channel.count;
      case Role::control:
        return control_of(channel);
    }
  }
  if (offset >= debug && offset < debug + dma_channel_count * channel_stride) {
    const Channel& channel = channels_[(offset - debug) / channel_stride];
    if ((offset & 0x3fu) == 0) return channel.credits;  // DBG_CTDREQ
    if ((offset & 0x3fu) == 4) return channel.reload;   // DBG_TCR
  }
  return global_value(offset);
}

std::uint32_t Dma::read(std::uint32_t offset) {
  const std::optional<std::uint32_t> value = value_of(offset);
  if (!value) report("read of offset " + std::to_string(offset));
  return value.value_or(0);
}

std::uint32_t Dma::peek(std::uint32_t offset) const { return value_of(offset).value_or(0); }

void Dma::write_channel(std::uint32_t offset, std::uint32_t value, Cycle clock) {
  const unsigned i = offset / channel_stride;
  Channel& channel = channels_[i];
  switch (layouts[offset >> 4 & 3u][offset >> 2 & 3u]) {
    case Role::read_address:
      channel.read_address = value;
      break;
    case Role::write_address:
      channel.write_address = value;
      break;
    case Role::count:
      channel.reload = value;
      break;
    case Role::control:
      set_control(channel, value);
  }
  if ((offset & 0xcu) == 0xc) trigger_written(i, value, clock);
}

void Dma::write_global(std::uint32_t offset, std::uint32_t value, Cycle clock) {
  if (offset >= intr && offset <= ints1) {
    for (InterruptRegisters& line : interrupts_) line.write(offset, value);
    if ((offset & 0xfu) == 0xc || offset == intr) raised_ &= ~value;
    update_lines();
    return;
  }
  if (offset >= timer0 && offset < timer0 + 4 * dma_timer_count) {
    timers_[(offset - timer0) / 4] = {value >> 16, value & 0xffffu, 0};
    return;
  }
  switch (offset) {
    case multi_chan_trigger:
      for (unsigned i = 0; i < dma_channel_count; ++i)
        if ((value >> i & 1u) != 0) trigger(i, clock);
      break;
    case sniff_ctrl:
      sniffer_.set_control(value);
      break;
    case sniff_data:
      sniffer_.set_data(value);
      break;
    case chan_abort:
      for (unsigned i = 0; i < dma_channel_count; ++i)
        if ((value >> i & 1u) != 0) abort(i);
      break;
    case fifo_levels:
    case n_channels:
      break;  // read-only
    default:
      report("write of offset " + std::to_string(offset));
  }
}

void Dma::write(std::uint32_t offset, std::uint32_t value) {
  const Cycle clock = owner_.bring_up_to_date() - 1;
  advance_to(clock);
  if (offset < dma_channel_count * channel_stride) {
    write_channel(offset, value, clock);
  } else if (offset >= debug && offset < debug + dma_channel_count * channel_stride) {
    Channel& channel = channels_[(offset - debug) / channel_stride];
    if ((offset & 0x3fu) == 0) {
      channel.credits = 0;
      channel.arriving = 0;
    }
  } else {
    write_global(offset, value, clock);
  }
  find_due(clock);
  owner_.changed();
}

std::uint32_t Dma::write_clear_bits(std::uint32_t offset) const {
  if (offset < dma_channel_count * channel_stride)
    return layouts[offset >> 4 & 3u][offset >> 2 & 3u] == Role::control ? error_bits : 0;
  return offset == intr || offset == ints0 || offset == ints1 ? channel_bits : 0;
}

void Dma::reset() {
  const Cycle clock = owner_.bring_up_to_date() - 1;
  channels_ = {};
  timers_ = {};
  for (InterruptRegisters& line : interrupts_) line.reset();
  sniffer_.reset();
  raised_ = busy_mask_ = high_served_ = 0;
  fifo_level_ = fifo_head_ = 0;
  read_free_ = write_free_ = 0;
  last_low_ = last_high_ = dma_channel_count - 1;
  now_ = clock;
  update_lines();
  find_due(clock);
  owner_.changed();
}

void Dma::report(const std::string& what) const {
  if (not_modelled_) not_modelled_("DMA: " + what);
}

}  // namespace lamplock::sim::chip
