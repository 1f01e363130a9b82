#include "sim/chip/profile/call_stacks.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "sim/chip/profile/exception_name.hpp"

namespace lamplock::sim::chip {

CallStacks::CallStacks(Core& core, std::span<const ImageSymbol> symbols)
    : core_(core), last_(core.cycle()) {
  for (const ImageSymbol& symbol : symbols)
    if (symbol.function) symbols_.push_back(symbol);
  std::stable_sort(
      symbols_.begin(), symbols_.end(),
      [](const ImageSymbol& a, const ImageSymbol& b) { return a.address < b.address; });
  places_.emplace_back();
  frames_.push_back({child(0, function_key(core.reg(15))), 0, 0});
}

const ImageSymbol* CallStacks::symbol_at(std::uint32_t address) const {
  auto next = std::upper_bound(
      symbols_.begin(), symbols_.end(), address,
      [](std::uint32_t value, const ImageSymbol& symbol) { return value < symbol.address; });
  // Assembler functions may have no size: they reach to the next symbol.
  if (next == symbols_.begin()) return nullptr;
  const ImageSymbol& symbol = *--next;
  if (symbol.size != 0 && address - symbol.address >= symbol.size) return nullptr;
  return &symbol;
}

std::uint64_t CallStacks::function_key(std::uint32_t address) const {
  const ImageSymbol* symbol = symbol_at(address & ~1u);
  return symbol == nullptr ? address & ~1u : symbol->address;
}

std::string CallStacks::name(std::uint64_t key) const {
  if (key == asleep_key) return "(asleep)";
  if (key >= exception_key)
    return '[' + exception_name(static_cast<unsigned>(key - exception_key)) + ']';
  const auto address = static_cast<std::uint32_t>(key);
  if (const ImageSymbol* symbol = symbol_at(address)) {
    // The separator of frames may be part of a name.
    std::string text = symbol->name;
    std::replace(text.begin(), text.end(), ';', ':');
    return text;
  }
  std::array<char, 24> text{};
  std::snprintf(text.data(), text.size(), address < Bus::rom_size ? "ROM 0x%04x" : "0x%08x",
                address);
  return text.data();
}

CallStacks::Node CallStacks::child(Node parent, std::uint64_t key) {
  const auto [place, added] = places_[parent].children.try_emplace(key, places_.size());
  const Node node = place->second;
  if (added) places_.push_back({parent, key, 0, {}});
  return node;
}

void CallStacks::charge(Cycle at) {
  if (at <= last_) return;
  places_[sleeping_ ? child(0, asleep_key) : frames_.back().node].own += at - last_;
  last_ = at;
}

void CallStacks::push(Node node, std::uint32_t back, unsigned exception) {
  if (frames_.size() < deepest || exception != 0) frames_.push_back({node, back, exception});
}

/// A reset of the chip ends all handlers without a word.
void CallStacks::leave_stale_exceptions() {
  if (core_.exception() != 0) return;
  const auto first = std::find_if(frames_.begin(), frames_.end(),
                                  [](const Frame& frame) { return frame.exception != 0; });
  frames_.erase(first, frames_.end());
}

void CallStacks::called(int /*core*/, std::uint32_t /*from*/, std::uint32_t to, Cycle at) {
  charge(at);
  leave_stale_exceptions();
  // BL is four bytes, BLX two: the return address is in LR.
  push(child(frames_.back().node, function_key(to)), core_.reg(14) & ~1u, 0);
}

void CallStacks::branched(int /*core*/, std::uint32_t to, Cycle at) {
  charge(at);
  leave_stale_exceptions();
  to &= ~1u;
  // A return to any caller above the innermost exception, or else a jump inside or to a function.
  for (std::size_t i = frames_.size(); i-- > 1 && frames_[i].exception == 0;) {
    if (frames_[i].back != to) continue;
    frames_.resize(i);
    return;
  }
  Frame& frame = frames_.back();
  const std::uint64_t here = places_[frame.node].key;
  const std::uint64_t there = function_key(to);
  // Without a symbol only a jump to another memory is taken for another function: from the ROM to
  // the second-stage boot, from there to the program.
  if (there == here || (symbol_at(to) == nullptr && (there >> 28) == (here >> 28))) return;
  frame.node = child(places_[frame.node].parent, there);
}

void CallStacks::exception_entered(int /*core*/, unsigned number, Cycle since, Cycle at) {
  charge(std::min(since, at));
  const Node interrupt = child(frames_.back().node, exception_key + number);
  push(child(interrupt, function_key(core_.reg(15))), 0, number);
}

void CallStacks::exception_left(int /*core*/, unsigned number, Cycle at) {
  charge(at);
  for (std::size_t i = frames_.size(); i-- > 1;) {
    if (frames_[i].exception != number) continue;
    frames_.resize(i);
    return;
  }
}

void CallStacks::slept(int /*core*/, Cycle at) {
  charge(at);
  sleeping_ = true;
}

void CallStacks::woke(int /*core*/, Cycle at) {
  charge(at);
  sleeping_ = false;
}

std::string CallStacks::folded() {
  charge(core_.cycle());
  std::map<std::string, Cycle> lines;
  for (Node node = 1; node < places_.size(); ++node) {
    if (places_[node].own == 0) continue;
    std::string way;
    for (Node at = node; at != 0; at = places_[at].parent)
      way.insert(0, ';' + name(places_[at].key));
    lines["core" + std::to_string(core_.id()) + way] += places_[node].own;
  }
  std::string text;
  for (const auto& [way, cycles] : lines) text += way + ' ' + std::to_string(cycles) + '\n';
  return text;
}

}  // namespace lamplock::sim::chip
