#include "sim/chip/system/oscillators.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "sim/chip/fabric/wide.hpp"

namespace lamplock::sim::chip {

namespace {

// CTRL of both oscillators: ENABLE 23:12, FREQ_RANGE 11:0.
constexpr std::uint32_t enable_code = 0xfab;
constexpr std::uint32_t disable_code = 0xd1e;
constexpr std::uint32_t control_mask = 0x00ffffff;
constexpr std::uint32_t xosc_range = 0xaa0;
constexpr std::uint32_t dormant_code = 0x636f6d61;
constexpr std::uint32_t wake_code = 0x77616b65;
// STATUS of both: ENABLED 12, DIV_RUNNING 16 (ROSC), BADWRITE 24 (write one to clear), STABLE 31.
constexpr std::uint32_t status_enabled = 1u << 12;
constexpr std::uint32_t status_div_running = 1u << 16;
constexpr std::uint32_t status_bad_write = 1u << 24;
constexpr std::uint32_t status_stable = 1u << 31;
constexpr std::uint32_t counter_mask = 0xff;

// XOSC (2.16.7).
constexpr std::uint32_t xosc_startup_reset = 0xc4;
constexpr std::uint32_t xosc_startup_mask = 0x00103fff;  // DELAY 13:0 in 256 periods, X4 20
constexpr std::uint32_t xosc_startup_x4 = 1u << 20;

// ROSC (2.17.8).
constexpr std::uint32_t password_strength = 0x9696;
constexpr std::uint32_t strength_mask = 0xffff7777;
constexpr std::uint32_t rosc_range_reset = 0xaa0;
constexpr std::uint32_t range_low = 0xfa4, range_medium = 0xfa5, range_too_high = 0xfa6,
                        range_high = 0xfa7;
constexpr std::uint32_t div_pass = 0xaa0;
constexpr std::uint32_t rosc_div_reset = div_pass + 16;
constexpr std::uint32_t rosc_phase_reset = 0x8;

// PLL (2.18.4): CS has REFDIV 5:0, BYPASS 8, LOCK 31; PWR has PD 0, DSMPD 2, POSTDIVPD 3, VCOPD 5;
// PRIM has POSTDIV1 18:16, POSTDIV2 14:12.
constexpr std::uint32_t pll_refdiv_mask = 0x3f;
constexpr std::uint32_t pll_bypass = 1u << 8;
constexpr std::uint32_t pll_lock = 1u << 31;
constexpr std::uint32_t pll_pd = 1u << 0;
constexpr std::uint32_t pll_postdivpd = 1u << 3;
constexpr std::uint32_t pll_vcopd = 1u << 5;
constexpr std::uint32_t pll_power_mask = 0x2d;
constexpr std::uint32_t pll_feedback_mask = 0xfff;
constexpr std::uint32_t pll_prim_mask = 0x00077000;
constexpr std::uint64_t vco_min_hz = 750'000'000;  // 2.18.1 (400 MHz before revision 2.1)
constexpr std::uint64_t vco_max_hz = 1'600'000'000;

}  // namespace

void PauseCounter::write(std::uint32_t value, std::uint64_t hz) {
  start_ = value & counter_mask;
  counter_ = {};
  counter_.set_frequency(hz, wheel_.time());
}

std::uint32_t PauseCounter::read() const {
  const std::uint64_t counted = counter_.cycles(wheel_.time());
  return counted >= start_ ? 0 : start_ - static_cast<std::uint32_t>(counted);
}

Xosc::Xosc(TimeWheel& wheel, NotModelled not_modelled)
    : not_modelled_(std::move(not_modelled)),
      start_up_(wheel, [this] { set_stable(true); }),
      counter_(wheel) {
  reset();
}

void Xosc::reset() {
  control_ = disable_code << 12 | xosc_range;
  startup_ = xosc_startup_reset;
  enabled_ = bad_write_ = false;
  start_up_.cancel();
  set_stable(false);
}

void Xosc::set_stable(bool stable) {
  if (stable_ == stable) return;
  stable_ = stable;
  if (changed_) changed_();
}

std::uint32_t Xosc::read(std::uint32_t offset) {
  if (offset > 0x1c || (offset > 0x0c && offset < 0x1c))
    not_modelled_("XOSC: no register at this offset");
  return peek(offset);
}

std::uint32_t Xosc::peek(std::uint32_t offset) const {
  switch (offset) {
    case 0x00:
      return control_;
    case 0x04:
      return (stable_ ? status_stable : 0u) | (bad_write_ ? status_bad_write : 0u) |
             (enabled_ ? status_enabled : 0u);
    case 0x08:
      return wake_code;
    case 0x0c:
      return startup_;
    case 0x1c:
      return counter_.read();
    default:
      return 0;
  }
}

std::uint32_t Xosc::write_clear_bits(std::uint32_t offset) const {
  return offset == 0x04 ? status_bad_write : 0;
}

void Xosc::write_control(std::uint32_t value) {
  control_ = value & control_mask;
  const std::uint32_t code = control_ >> 12;
  if ((code != enable_code && code != disable_code) || (control_ & 0xfff) != xosc_range)
    bad_write_ = true;
  const bool enable = code != disable_code;  // an invalid code enables
  if (enable == enabled_) return;
  enabled_ = enable;
  if (!enable) {
    start_up_.cancel();
    set_stable(false);
    return;
  }
  const std::uint64_t periods =
      256ull * (startup_ & 0x3fffu) * ((startup_ & xosc_startup_x4) != 0 ? 4 : 1);
  start_up_.start(static_cast<Picoseconds>(static_cast<Wide>(periods) * ps_per_s /
                                           static_cast<Wide>(pico_crystal_hz)));
}

void Xosc::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case 0x00:
      write_control(value);
      break;
    case 0x04:
      bad_write_ = bad_write_ && (value & status_bad_write) == 0;
      break;
    case 0x08:
      if (value == dormant_code) not_modelled_("XOSC DORMANT: the oscillator is not paused");
      bad_write_ = bad_write_ || (value != dormant_code && value != wake_code);
      break;
    case 0x0c:
      startup_ = value & xosc_startup_mask;
      break;
    case 0x1c:
      counter_.write(value, hz());
      break;
    default:
      not_modelled_("XOSC: no register at this offset");
  }
}

Rosc::Rosc(TimeWheel& wheel, NotModelled not_modelled)
    : not_modelled_(std::move(not_modelled)), counter_(wheel) {
  reset();
}

void Rosc::reset() {
  control_ = enable_code << 12 | rosc_range_reset;
  frequency_a_ = frequency_b_ = 0;
  divider_ = rosc_div_reset;
  phase_ = rosc_phase_reset;
  enabled_ = true;
  bad_write_ = false;
  if (changed_) changed_();
}

std::uint32_t Rosc::divisor() const {
  const std::uint32_t divisor = divider_ - div_pass;  // wraps to a large number below
  if (divisor > 31) return 31;
  return divisor == 0 ? 32 : divisor;
}

/// Delays in twelfths of that of a stage with the weakest drive.
std::uint64_t Rosc::ring_frequency() const {
  constexpr unsigned stages = 8, unit = 12;
  unsigned first = 0;  // stage in use
  switch (control_ & 0xfffu) {
    case range_medium:
      first = 2;
      break;
    case range_high:
      first = 4;
      break;
    case range_too_high:
      first = 6;
      break;
    default:
      break;
  }
  unsigned delay = 0;
  for (unsigned stage = first; stage < stages; ++stage) {
    const std::uint32_t word = stage < 4 ? frequency_a_ : frequency_b_;
    const bool valid = word >> 16 == password_strength;
    const std::uint32_t bits = valid ? word >> (4 * (stage % 4)) & 7u : 0;
    delay += unit / (1u + static_cast<unsigned>(std::popcount(bits)));
  }
  return nominal_ring_hz * stages * unit / delay;
}

std::uint32_t Rosc::read(std::uint32_t offset) {
  if (offset > 0x20) not_modelled_("ROSC: no register at this offset");
  if (offset == 0x1c) {  // a Galois register of 32 bits replaces noise: runs are repeatable
    constexpr std::uint32_t taps = 0xd0000001;
    random_ = (random_ >> 1) ^ ((random_ & 1u) != 0 ? taps : 0u);
  }
  return peek(offset);
}

std::uint32_t Rosc::peek(std::uint32_t offset) const {
  switch (offset) {
    case 0x00:
      return control_;
    case 0x04:
      return frequency_a_;
    case 0x08:
      return frequency_b_;
    case 0x0c:
      return wake_code;
    case 0x10:
      return divider_;
    case 0x14:
      return phase_;
    case 0x18:
      return (enabled_ ? status_stable | status_div_running | status_enabled : 0u) |
             (bad_write_ ? status_bad_write : 0u);
    case 0x1c:
      return random_ & 1u;
    case 0x20:
      return counter_.read();
    default:
      return 0;
  }
}

std::uint32_t Rosc::write_clear_bits(std::uint32_t offset) const {
  return offset == 0x18 ? status_bad_write : 0;
}

void Rosc::write_control(std::uint32_t value) {
  control_ = value & control_mask;
  const std::uint32_t code = control_ >> 12;
  const std::uint32_t range = control_ & 0xfffu;
  const bool known_range = (range >= range_low && range <= range_high) || range == rosc_range_reset;
  if ((code != enable_code && code != disable_code) || !known_range) bad_write_ = true;
  enabled_ = code != disable_code;
  if (changed_) changed_();
}

void Rosc::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case 0x00:
      write_control(value);
      break;
    case 0x04:
    case 0x08:
      (offset == 0x04 ? frequency_a_ : frequency_b_) = value & strength_mask;
      if (value >> 16 != password_strength) bad_write_ = true;
      if (changed_) changed_();
      break;
    case 0x0c:
      if (value == dormant_code) not_modelled_("ROSC DORMANT: the oscillator is not paused");
      bad_write_ = bad_write_ || (value != dormant_code && value != wake_code);
      break;
    case 0x10:
      divider_ = value & 0xfffu;
      bad_write_ = bad_write_ || divider_ - div_pass > 31;
      if (changed_) changed_();
      break;
    case 0x14:
      phase_ = value & 0xfffu;
      break;
    case 0x18:
      bad_write_ = bad_write_ && (value & status_bad_write) == 0;
      break;
    case 0x20:
      counter_.write(value, hz());
      break;
    default:
      not_modelled_("ROSC: no register to write at this offset");
  }
}

Pll::Pll(std::string_view name, TimeWheel& wheel, const Xosc& xosc, NotModelled not_modelled)
    : name_(name), xosc_(xosc), not_modelled_(std::move(not_modelled)), lock_(wheel, [this] {
        locked_ = true;
        report();
      }) {
  reset();
}

void Pll::reset() {
  control_ = 1;  // REFDIV
  power_ = pll_power_mask;
  feedback_ = 0;
  post_dividers_ = pll_prim_mask;
  relock();
}

std::uint64_t Pll::reference_hz() const {
  return xosc_.hz() / std::max(1u, control_ & pll_refdiv_mask);
}

bool Pll::powered() const { return (power_ & (pll_pd | pll_vcopd)) == 0; }

std::uint64_t Pll::hz() const {
  if ((control_ & pll_bypass) != 0) return reference_hz();
  if (!locked_ || (power_ & pll_postdivpd) != 0) return 0;
  const std::uint64_t divisor =
      std::max<std::uint64_t>(1, (post_dividers_ >> 16 & 7u) * (post_dividers_ >> 12 & 7u));
  return reference_hz() * feedback_ / divisor;
}

// Power and feedback decide whether the loop can lock; each change starts a new search.
void Pll::relock() {
  locked_ = false;
  lock_.cancel();
  const std::uint64_t reference = reference_hz();
  const std::uint64_t vco = reference * feedback_;
  if (powered() && vco != 0) {
    if (vco < vco_min_hz || vco > vco_max_hz)
      not_modelled_(name_ + ": VCO outside 750 to 1600 MHz");
    lock_.start(static_cast<Picoseconds>(lock_reference_cycles) * ps_per_s /
                static_cast<Picoseconds>(reference));
  }
  report();
}

void Pll::report() {
  if (changed_) changed_();
}

void Pll::reference_changed() { relock(); }

std::uint32_t Pll::peek(std::uint32_t offset) const {
  switch (offset) {
    case 0x0:
      return control_ | (locked_ ? pll_lock : 0u);
    case 0x4:
      return power_;
    case 0x8:
      return feedback_;
    case 0xc:
      return post_dividers_;
    default:
      return 0;
  }
}

std::uint32_t Pll::read(std::uint32_t offset) {
  if (offset > 0xc) not_modelled_(name_ + ": no register at this offset");
  return peek(offset);
}

void Pll::write(std::uint32_t offset, std::uint32_t value) {
  const std::uint32_t reference_divisor = control_ & pll_refdiv_mask;
  const bool was_powered = powered();
  switch (offset) {
    case 0x0:
      control_ = value & (pll_refdiv_mask | pll_bypass);
      if ((control_ & pll_refdiv_mask) != reference_divisor) return relock();
      break;
    case 0x4:
      power_ = value & pll_power_mask;
      if (powered() != was_powered) return relock();
      break;
    case 0x8:
      if (feedback_ == (value & pll_feedback_mask)) return;
      feedback_ = value & pll_feedback_mask;
      return relock();
    case 0xc:
      post_dividers_ = value & pll_prim_mask;
      break;
    default:
      not_modelled_(name_ + ": no register at this offset");
      return;
  }
  report();
}

}  // namespace lamplock::sim::chip
