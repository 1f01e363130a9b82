#include "sim/chip/profile/profile.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "sim/chip/profile/exception_name.hpp"

namespace lamplock::sim::chip {

namespace {

constexpr std::uint8_t pattern = 0xa5;

void add(ProfileEntry& entry, Cycle cycles) {
  ++entry.count;
  entry.total += cycles;
  entry.longest = std::max(entry.longest, cycles);
}

std::string line(const ProfileEntry& entry, Cycle all) {
  std::array<char, 128> numbers{};
  const double share =
      all == 0 ? 0.0 : 100.0 * static_cast<double>(entry.total) / static_cast<double>(all);
  std::snprintf(numbers.data(), numbers.size(), "%12llu %14llu %12.1f %12llu %6.2f%%  ",
                static_cast<unsigned long long>(entry.count),
                static_cast<unsigned long long>(entry.total), entry.mean(),
                static_cast<unsigned long long>(entry.longest), share);
  return numbers.data() + entry.name + '\n';
}

}  // namespace

Profile::Profile(ShadowStack& stack)
    : stack_(stack), entries_(stack.functions().size() + 1), masked_since_(stack.core().cycle()) {
  for (std::size_t i = 0; i < stack.functions().size(); ++i)
    entries_[i].name = stack.functions()[i].name;
  entries_.back().name = "(no symbol)";
  for (unsigned number = 0; number < exceptions_.size(); ++number)
    exceptions_[number].name = exception_name(number);
  stack.add(*this);
}

void Profile::left(const ShadowFrame& frame) { add(entries_[frame.symbol], frame.own); }

void Profile::handled(unsigned exception, Cycle cycles) {
  if (exception < exceptions_.size()) add(exceptions_[exception], cycles);
}

void Profile::masked(bool interrupts_off, Cycle at) {
  if (masked_ && !interrupts_off) max_masked_ = std::max(max_masked_, at - masked_since_);
  if (!masked_ && interrupts_off) masked_since_ = at;
  masked_ = interrupts_off;
}

std::vector<ProfileEntry> Profile::functions() const {
  std::vector<ProfileEntry> all = entries_;
  // A running function has its time up to now, but is not done.
  for (const ShadowFrame& frame : stack_.frames()) {
    ProfileEntry& entry = all[frame.symbol];
    entry.total += frame.own;
    entry.longest = std::max(entry.longest, frame.own);
    if (entry.count == 0) entry.count = 1;
  }
  std::erase_if(all, [](const ProfileEntry& entry) { return entry.total == 0; });
  std::stable_sort(all.begin(), all.end(),
                   [](const ProfileEntry& a, const ProfileEntry& b) { return a.total > b.total; });
  return all;
}

std::vector<ProfileEntry> Profile::exceptions() const {
  std::vector<ProfileEntry> all(exceptions_.begin(), exceptions_.end());
  std::erase_if(all, [](const ProfileEntry& entry) { return entry.count == 0; });
  return all;
}

std::string Profile::text(std::size_t lines) const {
  std::array<char, 160> head{};
  std::snprintf(
      head.data(), head.size(),
      "core %d: %llu cycles, %.2f%% asleep, interrupts off at most %llu cycles\n",
      stack_.core().id(), static_cast<unsigned long long>(cycles()),
      cycles() == 0 ? 0.0 : 100.0 * static_cast<double>(asleep()) / static_cast<double>(cycles()),
      static_cast<unsigned long long>(max_masked_));
  std::string result = head.data();
  constexpr const char* columns = "       count         cycles         mean      longest   share  ";
  result += std::string(columns) + "interrupt (with those nested in it)\n";
  for (const ProfileEntry& entry : exceptions()) result += line(entry, cycles());
  result += std::string(columns) + "function (by itself)\n";
  for (const ProfileEntry& entry : functions()) {
    if (lines-- == 0) break;
    result += line(entry, cycles());
  }
  return result;
}

StackGauge::StackGauge(std::string name, Bus& bus, std::uint32_t low, std::uint32_t high)
    : name_(std::move(name)) {
  const std::span<std::uint8_t> memory = bus.memory_at(low);
  if (high <= low || memory.size() < high - low)
    throw std::invalid_argument("stack " + name_ + ": not in memory");
  memory_ = memory.first(high - low);
}

void StackGauge::fill() { std::fill(memory_.begin(), memory_.end(), pattern); }

std::uint32_t StackGauge::used() const {
  const auto first = std::find_if(memory_.begin(), memory_.end(),
                                  [](std::uint8_t byte) { return byte != pattern; });
  return static_cast<std::uint32_t>(memory_.end() - first);
}

}  // namespace lamplock::sim::chip
