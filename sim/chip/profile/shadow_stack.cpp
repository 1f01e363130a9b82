#include "sim/chip/profile/shadow_stack.hpp"

#include <algorithm>

namespace lamplock::sim::chip {

ShadowStack::ShadowStack(Core& core, std::span<const ImageSymbol> symbols)
    : core_(core), functions_(symbols), first_(core.cycle()), last_(core.cycle()) {
  frames_.push_back(frame_at(core.reg(15), first_));
  core_.listen(this);
}

ShadowStack::~ShadowStack() { core_.listen(nullptr); }

void ShadowStack::add(StackView& view) {
  views_.push_back(&view);
  for (const ShadowFrame& frame : frames_) view.entered(frame);
}

std::vector<ShadowFrame> ShadowStack::frames() const {
  std::vector<ShadowFrame> present = frames_;
  if (!sleeping_) present.back().own += not_charged();
  return present;
}

ShadowFrame ShadowStack::frame_at(std::uint32_t address, Cycle since) const {
  ShadowFrame frame;
  frame.function = address & ~1u;
  frame.symbol = functions_.find(frame.function);
  if (frame.symbol != functions_.size()) frame.function = functions_[frame.symbol].address;
  frame.since = since;
  return frame;
}

void ShadowStack::charge(Cycle at) {
  if (at <= last_) return;
  (sleeping_ ? asleep_ : frames_.back().own) += at - last_;
  last_ = at;
}

void ShadowStack::push(const ShadowFrame& frame) {
  if (frames_.size() >= deepest && frame.exception == 0) return jump(frame);
  frames_.push_back(frame);
  for (StackView* view : views_) view->entered(frame);
}

void ShadowStack::pop_to(std::size_t depth) {
  while (frames_.size() > depth) {
    for (StackView* view : views_) view->left(frames_.back());
    frames_.pop_back();
  }
}

// The frame on top keeps its return address but becomes another function's.
void ShadowStack::jump(const ShadowFrame& to) {
  ShadowFrame& frame = frames_.back();
  for (StackView* view : views_) view->left(frame);
  frame.function = to.function;
  frame.symbol = to.symbol;
  frame.own = 0;
  for (StackView* view : views_) view->entered(frame);
}

void ShadowStack::leave_stale_exceptions() {
  if (core_.exception() != 0) return;
  const auto first = std::find_if(frames_.begin(), frames_.end(),
                                  [](const ShadowFrame& frame) { return frame.exception != 0; });
  pop_to(static_cast<std::size_t>(first - frames_.begin()));
}

void ShadowStack::called(int /*core*/, std::uint32_t /*from*/, std::uint32_t to, Cycle at) {
  charge(at);
  leave_stale_exceptions();
  ShadowFrame frame = frame_at(to, at);
  // BL is four bytes, BLX two: the return address is in LR.
  frame.back = core_.reg(14) & ~1u;
  push(frame);
}

void ShadowStack::branched(int /*core*/, std::uint32_t to, Cycle at) {
  charge(at);
  leave_stale_exceptions();
  to &= ~1u;
  // A return to any caller above the innermost exception, or else a jump inside or to a function.
  for (std::size_t i = frames_.size(); i-- > 1 && frames_[i].exception == 0;)
    if (frames_[i].back == to) return pop_to(i);
  const ShadowFrame there = frame_at(to, at);
  const std::uint32_t here = frames_.back().function;
  const bool same_memory = there.function >> 28 == here >> 28;
  if (there.function == here || (there.symbol == functions_.size() && same_memory)) return;
  jump(there);
}

void ShadowStack::exception_entered(int /*core*/, unsigned number, Cycle since, Cycle at) {
  charge(std::min(since, at));
  ShadowFrame frame = frame_at(core_.reg(15), since);
  frame.exception = number;
  push(frame);
}

void ShadowStack::exception_left(int /*core*/, unsigned number, Cycle at) {
  charge(at);
  for (std::size_t i = frames_.size(); i-- > 1;) {
    if (frames_[i].exception != number) continue;
    for (StackView* view : views_) view->handled(number, at - frames_[i].since);
    return pop_to(i);
  }
}

void ShadowStack::slept(int /*core*/, Cycle at) {
  charge(at);
  sleeping_ = true;
}

void ShadowStack::woke(int /*core*/, Cycle at) {
  charge(at);
  sleeping_ = false;
}

void ShadowStack::masked(int /*core*/, bool interrupts_off, Cycle at) {
  for (StackView* view : views_) view->masked(interrupts_off, at);
}

}  // namespace lamplock::sim::chip
