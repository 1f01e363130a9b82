#include "sim/chip/profile/call_stacks.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include "sim/chip/profile/exception_name.hpp"

namespace lamplock::sim::chip {

CallStacks::CallStacks(ShadowStack& stack) : stack_(stack) {
  places_.emplace_back();
  stack.add(*this);
}

std::string CallStacks::name(std::uint64_t key) const {
  if (key >= exception_key)
    return '[' + exception_name(static_cast<unsigned>(key - exception_key)) + ']';
  const auto address = static_cast<std::uint32_t>(key);
  const FunctionTable& functions = stack_.functions();
  if (const std::size_t found = functions.find(address); found != functions.size()) {
    // The separator of frames may be part of a name.
    std::string text = functions[found].name;
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

void CallStacks::entered(const ShadowFrame& frame) {
  Node parent = present_.empty() ? 0 : present_.back();
  if (frame.exception != 0) parent = child(parent, exception_key + frame.exception);
  present_.push_back(child(parent, frame.function));
}

void CallStacks::left(const ShadowFrame& frame) {
  places_[present_.back()].own += frame.own;
  present_.pop_back();
}

std::string CallStacks::way_to(Node node) const {
  std::string way;
  for (Node at = node; at != 0; at = places_[at].parent) way.insert(0, ';' + name(places_[at].key));
  return way;
}

std::string CallStacks::folded() const {
  const std::string core = "core" + std::to_string(stack_.core().id());
  std::vector<Cycle> own;
  for (const Place& place : places_) own.push_back(place.own);
  const std::vector<ShadowFrame> running = stack_.frames();
  for (std::size_t i = 0; i < running.size(); ++i) own[present_[i]] += running[i].own;
  std::map<std::string, Cycle> lines;
  for (Node node = 1; node < places_.size(); ++node)
    if (own[node] != 0) lines[core + way_to(node)] += own[node];
  if (stack_.asleep() != 0) lines[core + ";(asleep)"] += stack_.asleep();
  std::string text;
  for (const auto& [way, cycles] : lines) text += way + ' ' + std::to_string(cycles) + '\n';
  return text;
}

}  // namespace lamplock::sim::chip
