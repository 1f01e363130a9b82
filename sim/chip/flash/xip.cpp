#include "sim/chip/flash/xip.hpp"

#include <utility>

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t cache_memory = 0x1500'0000;
// Offsets of XIP_CTRL (2.6.3.6).
enum Offset : std::uint32_t {
  ctrl = 0x00,
  flush = 0x04,
  stat = 0x08,
  ctr_hit = 0x0c,
  ctr_acc = 0x10,
  stream_addr = 0x14,
  stream_ctr = 0x18,
  stream_fifo = 0x1c,
};
constexpr std::uint32_t ctrl_enable = 1, ctrl_error_on_write = 2, ctrl_power_down = 8;
constexpr std::uint32_t stat_ready = 1, stat_stream_empty = 2, stat_stream_full = 4;

}  // namespace

Xip::Xip(TimeWheel& wheel, Bus& bus, FlashChip& flash, NotModelled not_modelled)
    : wheel_(wheel),
      bus_(bus),
      not_modelled_(std::move(not_modelled)),
      pins_(not_modelled_),
      stream_(
          wheel, flash.storage(), [this] { return ssi_.word_cycles(); }, not_modelled_),
      memory_(
          flash.storage(), [this] { return ssi_.line_fill_cycles(); }, stream_, not_modelled_),
      ssi_(wheel, flash, pins_, not_modelled_,
           [this](bool on) {
             memory_.set_readable(on);
             stream_.set_readable(on);
           }),
      control_(*this) {
  bus.map_xip(memory_);
  bus.map(0x1400'0000, control_);
  bus.map(0x1800'0000, ssi_, false);
  bus.map(0x5040'0000, stream_.auxiliary());
}

void Xip::connect(DreqLines& dreqs) {
  stream_.connect(dreqs);
  ssi_.connect(dreqs);
}

void Xip::reset() {
  ssi_.reset();
  control_.reset();
}

void Xip::power_cut() {
  ssi_.power_cut();
  pins_.io().reset();
  pins_.pads().reset();
  control_.reset();
}

std::uint32_t Xip::Control::peek(std::uint32_t offset) const {
  const XipCache& cache = owner.memory_.cache();
  switch (offset) {
    case ctrl:
      return setting;
    case stat:
      return (owner.stream_.full() ? stat_stream_full : 0) |
             (owner.stream_.empty() ? stat_stream_empty : 0) |
             (owner.memory_.flushing(owner.wheel_.now()) ? 0 : stat_ready);
    case ctr_hit:
      return cache.hits();
    case ctr_acc:
      return cache.accesses();
    case stream_addr:
      return owner.stream_.address();
    case stream_ctr:
      return owner.stream_.count();
    case stream_fifo:
      return owner.stream_.front();
    default:
      return 0;
  }
}

std::uint32_t Xip::Control::read(std::uint32_t offset) {
  if (offset == stream_fifo) return owner.stream_.pop();
  if (offset > stream_fifo && owner.not_modelled_)
    owner.not_modelled_("XIP_CTRL: no register at this offset");
  // A read of FLUSH returns 0 after the flush; the bus adds the wait.
  return peek(offset);
}

void Xip::Control::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case ctrl:
      return set(value);
    case flush:
      if ((value & 1u) != 0) owner.memory_.flush(owner.wheel_.now());
      return;
    case ctr_hit:
      return owner.memory_.cache().clear_hits();
    case ctr_acc:
      return owner.memory_.cache().clear_accesses();
    case stream_addr:
      return owner.stream_.write_address(value);
    case stream_ctr:
      return owner.stream_.write_count(value);
    default:
      if (offset > stream_fifo && owner.not_modelled_)
        owner.not_modelled_("XIP_CTRL: no register at this offset");
      return;
  }
}

// CTRL. Without power the cache is off, and its memory is absent; with power it appears as SRAM
// while it is not used as a cache (2.6.3.1).
void Xip::Control::set(std::uint32_t value) {
  setting = value & (ctrl_enable | ctrl_error_on_write | ctrl_power_down);
  if ((setting & ctrl_power_down) != 0) setting &= ~ctrl_enable;
  owner.memory_.set_enabled((setting & ctrl_enable) != 0);
  owner.memory_.set_bad_write_fault((setting & ctrl_error_on_write) != 0);
  if ((setting & (ctrl_enable | ctrl_power_down)) == 0)
    owner.bus_.map_memory(cache_memory, owner.memory_.cache().memory(), true);
  else
    owner.bus_.unmap_memory(cache_memory);
}

// Ends with a flush (2.6.3.6, STAT).
void Xip::Control::reset() {
  set(ctrl_enable | ctrl_error_on_write);
  owner.stream_.reset();
  owner.memory_.flush(owner.wheel_.now());
  owner.memory_.cache().clear_hits();
  owner.memory_.cache().clear_accesses();
}

}  // namespace lamplock::sim::chip
