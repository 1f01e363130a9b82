#include "sim/chip/system/resets.hpp"

#include <string>
#include <utility>

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t offset_reset = 0x0;
constexpr std::uint32_t offset_wdsel = 0x4;
constexpr std::uint32_t offset_done = 0x8;
constexpr std::uint32_t all_blocks = 0x01ffffff;

}  // namespace

Resets::Resets(NotModelled not_modelled) : not_modelled_(std::move(not_modelled)) {
  reset_ = all_blocks;
}

Peripheral& Resets::attach(ResetBit bit, Peripheral& block) {
  return gates_.emplace_back(*this, bit, block);
}

void Resets::Gate::report() const {
  resets_.not_modelled_(std::string(block_.name()) +
                        (resets_.held(bit_) ? ": accessed while held in reset"
                                            : ": accessed while its clock is stopped"));
}

void Resets::reset_blocks(std::uint32_t bits) {
  for (Gate& gate : gates_)
    if ((bits >> static_cast<unsigned>(gate.bit()) & 1u) != 0) gate.reset();
}

void Resets::reset() {
  reset_ = all_blocks;
  watchdog_select_ = 0;
  reset_blocks(all_blocks);
}

void Resets::watchdog_fired() {
  reset_ |= watchdog_select_;
  reset_blocks(watchdog_select_);
}

std::uint32_t Resets::read(std::uint32_t offset) {
  if (offset > offset_done) not_modelled_("RESETS: no register at this offset");
  return peek(offset);
}

std::uint32_t Resets::peek(std::uint32_t offset) const {
  switch (offset) {
    case offset_reset:
      return reset_;
    case offset_wdsel:
      return watchdog_select_;
    case offset_done:
      return ~reset_ & all_blocks;
    default:
      return 0;
  }
}

void Resets::write(std::uint32_t offset, std::uint32_t value) {
  if (offset == offset_reset) {
    // A released block starts from its reset values too: no time passed for it.
    const std::uint32_t changed = (value ^ reset_) & all_blocks;
    reset_ = value & all_blocks;
    reset_blocks(changed);
  } else if (offset == offset_wdsel) {
    watchdog_select_ = value & all_blocks;
  } else if (offset > offset_done) {
    not_modelled_("RESETS: no register at this offset");
  }
}

}  // namespace lamplock::sim::chip
