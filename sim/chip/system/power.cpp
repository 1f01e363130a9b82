#include "sim/chip/system/power.hpp"

#include <utility>

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t all_stages = (1u << psm_stage_count) - 1;

// VREG: EN 0, HIZ 1, VSEL 7:4, ROK 12 (in regulation). BOD: EN 0, VSEL 7:4.
constexpr std::uint32_t vreg_mask = 0xf3;
constexpr std::uint32_t vreg_reset = 0xb1;
constexpr std::uint32_t vreg_in_regulation = 1u << 12;
constexpr std::uint32_t bod_mask = 0xf1;
constexpr std::uint32_t bod_reset = 0x91;
// CHIP_RESET: HAD_POR 8, HAD_RUN 16, HAD_PSM_RESTART 20, PSM_RESTART_FLAG 24 (write one to clear).
constexpr std::uint32_t had_por = 1u << 8;
constexpr std::uint32_t had_run = 1u << 16;
constexpr std::uint32_t had_psm_restart = 1u << 20;
constexpr std::uint32_t psm_restart_flag = 1u << 24;

/// The stages and those after them.
constexpr std::uint32_t with_followers(std::uint32_t stages) {
  constexpr auto processors = 1u << static_cast<unsigned>(PsmBit::proc0);
  const std::uint32_t sequence = stages & (processors - 1);
  if (sequence == 0) return stages;
  const std::uint32_t first = sequence & ~(sequence - 1);
  return all_stages & ~(first - 1);
}

}  // namespace

Psm::Psm(NotModelled not_modelled) : not_modelled_(std::move(not_modelled)) {}

void Psm::attach(PsmBit bit, Stage stage) {
  stages_[static_cast<std::size_t>(bit)].push_back(std::move(stage));
}

void Psm::put(std::uint32_t stages, bool held) {
  for (std::size_t bit = 0; bit < psm_stage_count; ++bit)
    if ((stages >> bit & 1u) != 0)
      for (const Stage& stage : stages_[bit]) stage(held);
}

std::uint32_t Psm::held_off() const { return with_followers(force_off_); }

void Psm::watchdog_hold() { put(with_followers(watchdog_select_), true); }

void Psm::watchdog_release() { put(with_followers(watchdog_select_) & ~held_off(), false); }

void Psm::restart() {
  put(all_stages, true);
  put(all_stages, false);
}

void Psm::reset() {
  const std::uint32_t released = held_off();
  force_on_ = force_off_ = watchdog_select_ = 0;
  put(released, false);
}

std::uint32_t Psm::read(std::uint32_t offset) {
  if (offset > 0xc) not_modelled_("PSM: no register at this offset");
  return peek(offset);
}

std::uint32_t Psm::peek(std::uint32_t offset) const {
  switch (offset) {
    case 0x0:
      return force_on_;
    case 0x4:
      return force_off_;
    case 0x8:
      return watchdog_select_;
    case 0xc:
      return ~held_off() & all_stages;
    default:
      return 0;
  }
}

void Psm::write(std::uint32_t offset, std::uint32_t value) {
  value &= all_stages;
  switch (offset) {
    case 0x0:
      force_on_ = value;
      break;  // all stages are on unless FRCE_OFF holds them
    case 0x4: {
      const std::uint32_t before = held_off();
      force_off_ = value;
      const std::uint32_t after = held_off();
      put(after & ~before, true);
      put(before & ~after, false);
      break;
    }
    case 0x8:
      watchdog_select_ = value;
      break;
    case 0xc:
      break;
    default:
      not_modelled_("PSM: no register at this offset");
  }
}

VregAndChipReset::VregAndChipReset(NotModelled not_modelled)
    : not_modelled_(std::move(not_modelled)) {
  reset();
  note(ChipReset::power_on);
}

void VregAndChipReset::reset() {
  regulator_ = vreg_reset;
  brown_out_ = bod_reset;
}

void VregAndChipReset::note(ChipReset cause) {
  switch (cause) {
    case ChipReset::power_on:
    case ChipReset::brown_out:
      cause_ = had_por;
      break;
    case ChipReset::run_pin:
      cause_ = had_run;
      break;
    case ChipReset::debug_port:
      cause_ = had_psm_restart | psm_restart_flag;
      break;
  }
}

std::uint32_t VregAndChipReset::read(std::uint32_t offset) {
  if (offset > 0x8) not_modelled_("VREG_AND_CHIP_RESET: no register at this offset");
  return peek(offset);
}

std::uint32_t VregAndChipReset::peek(std::uint32_t offset) const {
  switch (offset) {
    case 0x0:
      return regulator_ | vreg_in_regulation;
    case 0x4:
      return brown_out_;
    case 0x8:
      return cause_;
    default:
      return 0;
  }
}

std::uint32_t VregAndChipReset::write_clear_bits(std::uint32_t offset) const {
  return offset == 0x8 ? psm_restart_flag : 0;
}

void VregAndChipReset::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case 0x0:
      regulator_ = value & vreg_mask;
      if ((regulator_ & 3u) != 1)
        not_modelled_("VREG_AND_CHIP_RESET VREG: the core keeps its supply");
      break;
    case 0x4:
      brown_out_ = value & bod_mask;
      break;
    case 0x8:
      cause_ &= ~(value & psm_restart_flag);
      break;
    default:
      not_modelled_("VREG_AND_CHIP_RESET: no register at this offset");
  }
}

}  // namespace lamplock::sim::chip
