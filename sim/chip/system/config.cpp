#include "sim/chip/system/config.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// SYSINFO (2.20): CHIP_ID with REVISION 31:28, PART 27:12, MANUFACTURER 11:0, revision 2 being
// stepping B2; PLATFORM with ASIC 1. GITREF_RP2040 at 0x40 is not known.
constexpr std::array<std::uint32_t, 2> sysinfo_words{2u << 28 | 0x0002u << 12 | 0x927u, 1u << 1};
constexpr std::array<std::uint32_t, 1> tbman_words{1u << 0};  // PLATFORM: ASIC 0 (2.23)

// SYSCFG (2.21): PROC0_NMI_MASK, PROC1_NMI_MASK, PROC_CONFIG, PROC_IN_SYNC_BYPASS,
// PROC_IN_SYNC_BYPASS_HI, DBGFORCE, MEMPOWERDOWN.
constexpr std::array<std::uint32_t, 7> syscfg_masks{0xffffffff, 0xffffffff, 0xff000000, 0x3fffffff,
                                                    0x3f,       0xee,       0xff};
constexpr std::array<std::uint32_t, 7> syscfg_resets{0, 0, 0x10000000, 0, 0, 0x66, 0};
constexpr std::uint32_t offset_sync_bypass = 0x0c;

// BUSCTRL (2.1.4): BUS_PRIORITY, BUS_PRIORITY_ACK, then PERFCTRn, PERFSELn four times.
constexpr std::uint32_t priority_mask = 0x1111;
constexpr std::uint32_t perfsel_reset = 0x1f;
constexpr std::uint32_t offset_perfctr0 = 0x08;
constexpr std::uint32_t busctrl_end = 0x28;
constexpr std::uint32_t max_count = 0xff'ffff;  // 24 bits, saturating

// Even events are contested accesses of a port (2.1.5, PERFSEL).
constexpr bool counts(std::uint32_t event) {
  return event < 2 * bus_port_count && event % 2 == 0 &&
         event / 2 != static_cast<std::uint32_t>(BusPort::xip);
}

}  // namespace

Identification::Identification(std::string_view name, std::span<const std::uint32_t> words,
                               NotModelled not_modelled)
    : name_(name), words_(words), not_modelled_(std::move(not_modelled)) {}

Identification Identification::sysinfo(NotModelled not_modelled) {
  return {"SYSINFO", sysinfo_words, std::move(not_modelled)};
}

Identification Identification::tbman(NotModelled not_modelled) {
  return {"TBMAN", tbman_words, std::move(not_modelled)};
}

std::uint32_t Identification::peek(std::uint32_t offset) const {
  return offset / 4 < words_.size() ? words_[offset / 4] : 0;
}

std::uint32_t Identification::read(std::uint32_t offset) {
  if (offset / 4 >= words_.size())
    not_modelled_(std::string(name_) + ": reads as 0 at this offset");
  return peek(offset);
}

Syscfg::Syscfg(Callbacks callbacks, NotModelled not_modelled)
    : callbacks_(std::move(callbacks)), not_modelled_(std::move(not_modelled)) {
  registers_ = syscfg_resets;
}

void Syscfg::reset() {
  registers_ = syscfg_resets;
  for (std::uint32_t index = 0; index < registers_.size(); ++index) report(4 * index);
}

std::uint32_t Syscfg::read(std::uint32_t offset) {
  if (offset / 4 >= registers_.size()) not_modelled_("SYSCFG: no register at this offset");
  return peek(offset);
}

std::uint32_t Syscfg::peek(std::uint32_t offset) const {
  return offset / 4 < registers_.size() ? registers_[offset / 4] : 0;
}

void Syscfg::report(std::uint32_t offset) const {
  const std::uint32_t value = registers_[offset / 4];
  if (offset < 8 && callbacks_.nmi_mask) callbacks_.nmi_mask(static_cast<int>(offset / 4), value);
  if (offset == offset_sync_bypass && callbacks_.synchroniser_bypass)
    callbacks_.synchroniser_bypass(value);
}

void Syscfg::write(std::uint32_t offset, std::uint32_t value) {
  if (offset / 4 >= registers_.size()) return not_modelled_("SYSCFG: no register at this offset");
  registers_[offset / 4] = value & syscfg_masks[offset / 4];
  if (offset > offset_sync_bypass && registers_[offset / 4] != syscfg_resets[offset / 4])
    not_modelled_("SYSCFG PROC_IN_SYNC_BYPASS_HI, DBGFORCE, MEMPOWERDOWN: without effect");
  report(offset);
}

Busctrl::Busctrl(NotModelled not_modelled) : not_modelled_(std::move(not_modelled)) { reset(); }

void Busctrl::reset() {
  priority_ = 0;
  if (arbiter_ != nullptr) arbiter_->set_priorities(0);
  select_.fill(perfsel_reset);
  held_ = since_ = {};
}

// Events of a counter's port so far, counted from power-up.
std::uint32_t Busctrl::events(std::size_t counter) const {
  const std::uint32_t event = select_[counter];
  if (arbiter_ == nullptr || !counts(event)) return 0;
  return arbiter_->contested(static_cast<BusPort>(event / 2));
}

std::uint32_t Busctrl::count(std::size_t counter) const {
  return std::min(held_[counter] + events(counter) - since_[counter], max_count);
}

std::uint32_t Busctrl::peek(std::uint32_t offset) const {
  if (offset == 0x0) return priority_;
  if (offset == 0x4) return 1;  // the arbiters have accepted the priorities
  if (offset < offset_perfctr0 || offset >= busctrl_end) return 0;
  const std::size_t counter = (offset - offset_perfctr0) / 8;
  return offset % 8 == 4 ? select_[counter] : count(counter);
}

std::uint32_t Busctrl::read(std::uint32_t offset) {
  if (offset >= busctrl_end)
    not_modelled_("BUSCTRL: no register at this offset");
  else if (offset >= offset_perfctr0 && offset % 8 == 0 &&
           !counts(select_[(offset - offset_perfctr0) / 8]))
    not_modelled_("BUSCTRL PERFCTR: accesses are not counted");
  return peek(offset);
}

void Busctrl::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == 0x0) {
    priority_ = value & priority_mask;
    if (arbiter_ != nullptr) arbiter_->set_priorities(priority_);
  } else if (offset >= busctrl_end) {
    not_modelled_("BUSCTRL: no register at this offset");
  } else if (offset >= offset_perfctr0) {
    const std::size_t counter = (offset - offset_perfctr0) / 8;
    // Any value clears the counter; another event continues from the same count.
    held_[counter] = offset % 8 == 4 ? count(counter) : 0;
    if (offset % 8 == 4) select_[counter] = value & 0x1fu;
    since_[counter] = events(counter);
  }
}

}  // namespace lamplock::sim::chip
