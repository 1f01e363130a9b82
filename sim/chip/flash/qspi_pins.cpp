#include "sim/chip/flash/qspi_pins.hpp"

#include <utility>

namespace lamplock::sim::chip {

namespace {

// CTRL of a pin (2.19.6.2): FUNCSEL 4:0, OUTOVER 9:8, OEOVER 13:12, INOVER 17:16, IRQOVER 29:28.
constexpr std::uint32_t control_mask = 0x3003'331f;
constexpr std::uint32_t function_mask = 0x1f;
constexpr std::uint32_t function_reset = 0x1f;
constexpr std::uint32_t other_overrides = 0x3003'3000;
// Pads (2.19.6.4): SCLK SD0 SD1 SD2 SD3 SS after VOLTAGE_SELECT; OD bit 7, PUE bit 3, PDE bit 2.
constexpr std::array<std::uint32_t, QspiPins::count> pad_resets = {0x56, 0x52, 0x52,
                                                                   0x52, 0x52, 0x5a};
constexpr std::uint32_t output_disable = 1u << 7;
constexpr std::uint32_t pull_up = 1u << 3;
constexpr std::uint32_t pull_down = 1u << 2;

}  // namespace

QspiPins::QspiPins(NotModelled not_modelled)
    : not_modelled_(std::move(not_modelled)), io_(*this), pads_(*this) {
  io_.control.fill(function_reset);
}

void QspiPins::on_change(std::function<void()> before, std::function<void()> after) {
  before_ = std::move(before);
  after_ = std::move(after);
}

void QspiPins::change(const std::function<void()>& what) {
  if (before_) before_();
  what();
  if (after_) after_();
}

OutOver QspiPins::select_override() const {
  return static_cast<OutOver>((io_.control[ss] >> 8) & 3u);
}

unsigned QspiPins::lines(unsigned driven, unsigned levels) const {
  unsigned result = 0;
  for (unsigned i = 0; i < 4; ++i) {
    const std::uint32_t pad = pads_.pad[1 + i];
    const bool drives = ((driven >> i) & 1u) != 0 && (pad & output_disable) == 0;
    // Nothing drives and no pull: modules keep /WP and /HOLD high, so a floating line counts as 1.
    const bool rest = (pad & (pull_up | pull_down)) != pull_down;
    if (drives ? ((levels >> i) & 1u) != 0 : rest) result |= 1u << i;
  }
  return result;
}

std::uint32_t QspiPins::inputs() const { return bootsel_ ? 0u : 1u << ss; }

std::uint32_t QspiPins::Io::peek(std::uint32_t offset) const {
  const std::size_t pin = offset / 8;
  if (pin < count && offset % 8 == 4) return control[pin];
  return 0;
}

std::uint32_t QspiPins::Io::read(std::uint32_t offset) {
  const std::size_t pin = offset / 8;
  if (pin >= count) {
    if (owner.not_modelled_) owner.not_modelled_("IO_QSPI interrupts read");
    return 0;
  }
  // STATUS: only the pad's input (INFROMPAD 17, INTOPERI 19) is known without a transfer.
  if (offset % 8 == 0) return ((owner.inputs() >> pin) & 1u) * 0x000a'0000u;
  return control[pin];
}

void QspiPins::Io::write(std::uint32_t offset, std::uint32_t value) {
  const std::size_t pin = offset / 8;
  if (pin >= count) {
    if (value != 0 && owner.not_modelled_) owner.not_modelled_("IO_QSPI interrupts written");
    return;
  }
  if (offset % 8 != 4) return;
  if (owner.not_modelled_) {
    if ((value & other_overrides) != 0 || (pin != ss && (value & 0x300u) != 0))
      owner.not_modelled_("IO_QSPI overrides other than OUTOVER of chip select");
    if ((value & function_mask) != 0 && (value & function_mask) != function_reset)
      owner.not_modelled_("IO_QSPI pins not used for the flash");
  }
  owner.change([&] { control[pin] = value & control_mask; });
}

void QspiPins::Io::reset() {
  owner.change([&] { control.fill(function_reset); });
}

std::uint32_t QspiPins::Pads::peek(std::uint32_t offset) const {
  if (offset == 0) return voltage;
  return offset / 4 <= count ? pad[offset / 4 - 1] : 0;
}

std::uint32_t QspiPins::Pads::read(std::uint32_t offset) {
  if (offset / 4 > count && owner.not_modelled_)
    owner.not_modelled_("PADS_QSPI: no register at this offset");
  return peek(offset);
}

void QspiPins::Pads::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0)
    voltage = value & 1u;
  else if (offset / 4 <= count)
    owner.change([&] { pad[offset / 4 - 1] = value & 0xffu; });
  else if (owner.not_modelled_)
    owner.not_modelled_("PADS_QSPI: no register at this offset");
}

void QspiPins::Pads::set_defaults() { pad = pad_resets; }

void QspiPins::Pads::reset() {
  owner.change([&] { set_defaults(); });
  voltage = 0;
}

}  // namespace lamplock::sim::chip
