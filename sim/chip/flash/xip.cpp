#include "sim/chip/flash/xip.hpp"

#include <utility>

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t flash_window = 0x1000'0000;
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
constexpr std::uint32_t stat_ready = 1, stat_stream_empty = 2;

}  // namespace

void XipCache::invalidate(std::uint32_t offset) {
  const std::uint32_t line = (offset & 0xff'ffffu) >> 3;
  for (std::uint32_t& tag : sets_[line % set_count].tags)
    if (tag == line / set_count + 1) tag = 0;
}

Xip::Xip(TimeWheel& wheel, Bus& bus, FlashChip& flash, NotModelled not_modelled)
    : bus_(bus),
      flash_(flash),
      not_modelled_(std::move(not_modelled)),
      pins_(not_modelled_),
      ssi_(wheel, flash, pins_, not_modelled_,
           [this](bool on) {
             if (on)
               bus_.map_memory(flash_window, flash_.storage(), false);
             else
               bus_.unmap_memory(flash_window);
           }),
      control_(*this) {
  bus.map(0x1400'0000, control_);
  bus.map(0x1800'0000, ssi_, false);
  bus.map(0x4001'8000, pins_.io());
  bus.map(0x4002'0000, pins_.pads());
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
  if (offset == ctrl) return setting;
  return offset == stat ? stat_ready | stat_stream_empty : 0;
}

std::uint32_t Xip::Control::read(std::uint32_t offset) {
  if (offset >= ctr_hit && owner.not_modelled_)
    owner.not_modelled_(offset <= ctr_acc       ? "XIP_CTRL CTR_HIT, CTR_ACC read"
                        : offset <= stream_fifo ? "XIP_CTRL stream read"
                                                : "XIP_CTRL: no register at this offset");
  // A read of FLUSH waits until the flush is done; here it is done at once and reads 0.
  return peek(offset);
}

void Xip::Control::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case ctrl: {
      const std::uint32_t old =
          std::exchange(setting, value & (ctrl_enable | ctrl_error_on_write | ctrl_power_down));
      if ((value & ctrl_error_on_write) == 0 && owner.not_modelled_)
        owner.not_modelled_("XIP_CTRL ERR_BADWRITE off");
      // The cache's memory shows as SRAM while it does not serve as a cache (2.6.3.1).
      if (((old ^ setting) & ctrl_enable) == 0) return;
      if ((setting & ctrl_enable) != 0)
        owner.bus_.unmap_memory(cache_memory);
      else
        owner.bus_.map_memory(cache_memory, owner.cache_as_memory_, true);
      return;
    }
    case stream_addr:
    case stream_ctr:
      if (value != 0 && owner.not_modelled_) owner.not_modelled_("XIP_CTRL stream written");
      return;
    default:
      return;
  }
}

void Xip::Control::reset() { write(ctrl, ctrl_enable | ctrl_error_on_write); }

}  // namespace lamplock::sim::chip
