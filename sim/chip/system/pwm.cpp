#include "sim/chip/system/pwm.hpp"

#include <algorithm>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Offsets in a slice (4.5.3) and after the slices.
constexpr std::uint32_t offset_csr = 0x00;
constexpr std::uint32_t offset_div = 0x04;
constexpr std::uint32_t offset_ctr = 0x08;
constexpr std::uint32_t offset_cc = 0x0c;
constexpr std::uint32_t offset_top = 0x10;
constexpr std::uint32_t slice_bytes = 0x14;
constexpr std::uint32_t offset_en = 0xa0;
constexpr std::uint32_t offset_intr = 0xa4;
constexpr std::uint32_t offset_ints = 0xb0;

// CSR: EN 0, PH_CORRECT 1, A_INV 2, B_INV 3, DIVMODE 5:4, PH_RET 6, PH_ADV 7 (both clear
// themselves).
constexpr std::uint32_t csr_mask = 0x3f;
constexpr std::uint32_t csr_retard = 1u << 6;
constexpr std::uint32_t csr_advance = 1u << 7;
constexpr std::uint32_t all_slices = 0xff;

}  // namespace

// --- slice

std::uint64_t PwmSlice::divisor() const {
  const std::uint32_t whole = divider_ >> 4;
  return (whole == 0 ? 256u : whole) * 16u + (divider_ & 15u);
}

std::uint64_t PwmSlice::period() const {
  return (static_cast<std::uint64_t>(top_) + 1) * (phase_correct() ? 2 : 1);
}

std::uint64_t PwmSlice::counter() const {
  return position_ <= top_ ? position_ : 2ull * top_ + 1 - position_;
}

void PwmSlice::set_counter(std::uint32_t value) { position_ = value & 0xffffu; }

bool PwmSlice::counts_clocks() const {
  return enabled() && (mode() == Mode::free_running || (mode() == Mode::gated && input_));
}

/// CC and TOP are double buffered: a written value takes effect when the counter wraps, or at once
/// while the slice is not enabled.
void PwmSlice::latch() {
  compare_ = compare_written_;
  top_ = top_written_;
}

void PwmSlice::step(std::uint64_t counts) {
  const std::uint64_t lost = std::min(counts, retards_);
  retards_ -= lost;
  counts -= lost;
  while (counts != 0) {
    // A counter above TOP (written, or TOP was lowered) continues to 0xffff.
    const bool above_top = position_ >= period();
    const std::uint64_t to_wrap = (above_top ? 0x10000u : period()) - position_;
    if (counts < to_wrap) {
      position_ += counts;
      return;
    }
    counts -= to_wrap;
    position_ = 0;
    wrapped_ = true;
    latch();
    counts %= period();
  }
}

void PwmSlice::advance(std::uint64_t clocks) {
  if (!counts_clocks()) return;
  const std::uint64_t sixteenths = fraction_ + 16 * clocks;
  fraction_ = sixteenths % divisor();
  step(sixteenths / divisor());
}

void PwmSlice::set_input(bool level) {
  const bool changed = level != input_;
  input_ = level;
  const bool counted = (mode() == Mode::rising && level) || (mode() == Mode::falling && !level);
  if (!changed || !counted || !enabled()) return;
  fraction_ += 16;
  step(fraction_ / divisor());
  fraction_ %= divisor();
}

std::uint64_t PwmSlice::counts_to_event(bool wraps_only) const {
  const std::uint64_t size = period();
  if (position_ >= size) return 0x10000u - position_;
  std::uint64_t next = size;
  if (!wraps_only) {
    const auto consider = [&next, this](std::uint64_t position) {
      if (position > position_) next = std::min(next, position);
    };
    for (const std::uint64_t level : {compare_ & 0xffffu, compare_ >> 16}) {
      if (level > top_) continue;  // always high
      consider(level);
      if (phase_correct()) consider(2ull * top_ + 2 - level);
    }
  }
  return next - position_;
}

Cycle PwmSlice::until_event(bool wraps_only) const {
  if (!counts_clocks()) return never_cycle;
  const std::uint64_t sixteenths = (retards_ + counts_to_event(wraps_only)) * divisor();
  return sixteenths <= fraction_ ? 0 : (sixteenths - fraction_ + 15) / 16;
}

std::uint32_t PwmSlice::outputs() const {
  const std::uint64_t count = counter();
  const std::uint32_t levels =
      (count < (compare_ & 0xffffu) ? 1u : 0u) | (count < compare_ >> 16 ? 2u : 0u);
  return levels ^ (control_ >> 2 & 3u);
}

bool PwmSlice::take_wrapped() { return std::exchange(wrapped_, false); }

std::uint32_t PwmSlice::read(std::uint32_t offset) const {
  switch (offset) {
    case offset_csr:
      return control_;
    case offset_div:
      return divider_;
    case offset_ctr:
      return static_cast<std::uint32_t>(counter()) & 0xffffu;
    case offset_cc:
      return compare_written_;
    case offset_top:
      return top_written_;
    default:
      return 0;
  }
}

void PwmSlice::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case offset_csr:
      control_ = value & csr_mask;
      if ((value & csr_advance) != 0 && enabled()) step(1);
      if ((value & csr_retard) != 0 && enabled()) ++retards_;  // the next count is lost
      break;
    case offset_div:
      divider_ = value & 0xfffu;
      fraction_ %= divisor();
      break;
    case offset_ctr:
      set_counter(value);
      break;
    case offset_cc:
      compare_written_ = value;
      break;
    case offset_top:
      top_written_ = value & 0xffffu;
      break;
    default:
      break;
  }
  if (!enabled()) latch();
}

// --- block

Pwm::Pwm(TimeWheel& wheel, Gpio& gpio, IrqLines& irqs, NotModelled not_modelled)
    : wheel_(wheel),
      slot_(wheel.add(*this)),
      gpio_(gpio),
      irqs_(irqs),
      not_modelled_(std::move(not_modelled)),
      interrupts_(offset_intr, all_slices) {
  gpio_.listen(static_cast<InputListener&>(*this));
  reset();
}

void Pwm::reset() {
  advance(wheel_.now());
  slices_ = {};
  raised_ = 0;
  interrupts_.reset();
  settle(wheel_.now());
}

/// Slice n is on GPIO 2n (A) and 2n + 1 (B), and again sixteen pins higher.
bool Pwm::connected(std::size_t slice) const {
  const std::uint32_t pins = gpio_.selected(PinFunction::pwm);
  return ((pins >> (2 * slice) | pins >> 16 >> (2 * slice)) & 3u) != 0;
}

void Pwm::take_inputs() {
  const std::uint32_t pins = gpio_.inputs() & gpio_.selected(PinFunction::pwm);
  for (std::size_t slice = 0; slice < slice_count; ++slice)
    slices_[slice].set_input(((pins | pins >> 16) >> (2 * slice + 1) & 1u) != 0);
  collect_wraps();
}

void Pwm::advance(Cycle to) {
  if (to <= time_) return;
  const std::uint64_t clocks = to - std::exchange(time_, to);
  if (!running_ || stopped_) return;
  for (PwmSlice& slice : slices_) slice.advance(clocks);
  collect_wraps();
}

void Pwm::collect_wraps() {
  std::uint32_t wrapped = 0;
  for (std::size_t slice = 0; slice < slice_count; ++slice)
    if (slices_[slice].take_wrapped()) wrapped |= 1u << slice;
  raised_ |= wrapped;
  for (std::size_t slice = 0; slice < slice_count; ++slice)
    if ((wrapped & awaited_) >> slice & 1u) dreqs_->pwm_wrap(static_cast<unsigned>(slice));
}

/// A channel that has just begun to wait must not see wraps before now.
void Pwm::wraps_awaited(std::uint32_t slices) {
  advance(wheel_.now());
  awaited_ = slices;
  schedule();
}

void Pwm::drive(Cycle at) {
  std::uint32_t levels = 0;
  std::uint32_t enables = 0;
  for (std::size_t slice = 0; slice < slice_count; ++slice) {
    levels |= slices_[slice].outputs() << (2 * slice);
    enables |= slices_[slice].enables() << (2 * slice);
  }
  constexpr std::uint32_t all_pins = (1u << gpio_count) - 1;
  gpio_.drive(PinFunction::pwm, (levels | levels << 16) & all_pins,
              (enables | enables << 16) & all_pins, at);
}

void Pwm::schedule() {
  running_ = counts_inputs_ = false;
  Cycle first = never_cycle;
  for (std::size_t slice = 0; slice < slice_count; ++slice) {
    const PwmSlice& part = slices_[slice];
    if (!part.enabled()) continue;
    running_ = true;
    counts_inputs_ = counts_inputs_ || part.mode() != PwmSlice::Mode::free_running;
    const bool seen = connected(slice);
    const bool awaited = ((interrupts_.enabled() & ~raised_) | awaited_) >> slice & 1u;
    if (seen || awaited) first = std::min(first, part.until_event(!seen));
  }
  wheel_.set(slot_, first == never_cycle || stopped_ ? never_cycle : time_ + first);
}

void Pwm::update_irq() { irqs_.set(Irq::pwm_wrap, interrupts_.status(raised_) != 0); }

/// Called after any change of outputs, interrupts or the next event.
void Pwm::settle(Cycle at) {
  drive(at);
  update_irq();
  schedule();
}

void Pwm::set_clock(bool runs) {
  const Cycle now = wheel_.now();
  advance(now);
  stopped_ = !runs;
  if (runs) take_inputs();
  settle(now);
}

void Pwm::run(Cycle) {
  advance(wheel_.now());
  settle(wheel_.now());
}

// Levels must be right even of outputs that are about to be connected.
void Pwm::catch_up(Cycle at) {
  if (!running_) return;
  advance(at);
  drive(at);
}

void Pwm::connections_changed(Cycle at) {
  if (!running_ || stopped_) return;
  advance(at);
  take_inputs();
  settle(at);
}

void Pwm::inputs_changed(Cycle at) {
  if (!counts_inputs_ || stopped_) return;
  advance(at);
  take_inputs();
  settle(at);
}

std::uint32_t Pwm::peek(std::uint32_t offset) const {
  if (offset < offset_en) {
    PwmSlice slice = slices_[offset / slice_bytes];
    if (!stopped_) slice.advance(wheel_.now() - std::min(time_, wheel_.now()));
    return slice.read(offset % slice_bytes);
  }
  std::uint32_t enabled_slices = 0;
  for (std::size_t slice = 0; slice < slice_count; ++slice)
    enabled_slices |= slices_[slice].enabled() ? 1u << slice : 0u;
  switch (offset) {
    case offset_en:
      return enabled_slices;
    default:
      return interrupts_.read(offset, raised_);
  }
}

std::uint32_t Pwm::read(std::uint32_t offset) {
  if (offset > offset_ints) not_modelled_("PWM: no register at this offset");
  advance(wheel_.now());
  return peek(offset);
}

std::uint32_t Pwm::write_clear_bits(std::uint32_t offset) const {
  return offset == offset_intr ? all_slices : 0;
}

void Pwm::write(std::uint32_t offset, std::uint32_t value) {
  const Cycle now = wheel_.now();
  advance(now);
  take_inputs();
  if (offset < offset_en) {
    slices_[offset / slice_bytes].write(offset % slice_bytes, value);
  } else if (offset == offset_en) {
    for (std::size_t slice = 0; slice < slice_count; ++slice)
      slices_[slice].enable((value >> slice & 1u) != 0);
  } else if (offset == offset_intr) {
    raised_ &= ~value;
  } else if (!interrupts_.write(offset, value)) {
    not_modelled_("PWM: no register at this offset");
  }
  collect_wraps();
  settle(now);
}

}  // namespace lamplock::sim::chip
