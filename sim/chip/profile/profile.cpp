#include "sim/chip/profile/profile.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>
#include <utility>

#include "sim/chip/profile/exception_name.hpp"

namespace lamplock::sim::chip {

namespace {

constexpr std::size_t deepest = 256;  // frames kept; a program that never returns stays inside
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

Profile::Profile(Core& core, std::span<const ImageSymbol> symbols) : core_(core) {
  for (const ImageSymbol& symbol : symbols)
    if (symbol.function) symbols_.push_back(symbol);
  std::stable_sort(
      symbols_.begin(), symbols_.end(),
      [](const ImageSymbol& a, const ImageSymbol& b) { return a.address < b.address; });
  clear();
  core_.listen(this);
}

Profile::~Profile() { core_.listen(nullptr); }

void Profile::clear() {
  entries_.assign(symbols_.size() + 1, {});
  for (std::size_t i = 0; i < symbols_.size(); ++i) entries_[i].name = symbols_[i].name;
  entries_.back().name = "(no symbol)";
  for (unsigned number = 0; number < exceptions_.size(); ++number) {
    exceptions_[number] = {};
    exceptions_[number].name = exception_name(number);
  }
  frames_.clear();
  first_ = last_ = core_.cycle();
  frames_.push_back({.function = function_at(core_.reg(15))});
  asleep_ = longest_masked_ = 0;
  masked_since_ = first_;
}

Cycle Profile::cycles() const { return core_.cycle() - first_; }

std::size_t Profile::function_at(std::uint32_t address) const {
  auto next = std::upper_bound(
      symbols_.begin(), symbols_.end(), address,
      [](std::uint32_t value, const ImageSymbol& symbol) { return value < symbol.address; });
  // Assembler functions may have no size: they reach to the next symbol.
  if (next == symbols_.begin()) return symbols_.size();
  const ImageSymbol& symbol = *--next;
  if (symbol.size != 0 && address - symbol.address >= symbol.size) return symbols_.size();
  return static_cast<std::size_t>(next - symbols_.begin());
}

void Profile::charge(Cycle at) {
  if (at <= last_) return;
  if (sleeping_)
    asleep_ += at - last_;
  else
    frames_.back().own += at - last_;
  last_ = at;
}

void Profile::push(std::size_t function, std::uint32_t back, unsigned exception, Cycle since) {
  if (frames_.size() == deepest) {
    frames_.front() = {};
    frames_.front().function = symbols_.size();
    frames_.erase(frames_.begin() + 1);
  }
  frames_.push_back({function, back, 0, exception, since});
}

void Profile::pop() {
  const Frame& frame = frames_.back();
  add(entries_[frame.function], frame.own);
  frames_.pop_back();
}

void Profile::called(int, std::uint32_t, std::uint32_t to, Cycle at) {
  charge(at);
  // BL is four bytes, BLX two: the return address is in LR.
  push(function_at(to), core_.reg(14) & ~1u, 0, at);
}

void Profile::branched(int, std::uint32_t to, Cycle at) {
  charge(at);
  to &= ~1u;
  // A return to any caller above the innermost exception, or else a jump inside or to a function.
  for (std::size_t i = frames_.size(); i-- > 0 && frames_[i].exception == 0;) {
    if (frames_[i].back != to || i == 0) continue;
    while (frames_.size() > i) pop();
    return;
  }
  Frame& frame = frames_.back();
  const std::size_t function = function_at(to);
  if (function == frame.function) return;
  add(entries_[frame.function], frame.own);
  frame.own = 0;
  frame.function = function;
}

void Profile::exception_entered(int, unsigned number, Cycle since, Cycle at) {
  charge(std::min(since, at));
  push(function_at(core_.reg(15)), 0, number, since);
}

void Profile::exception_left(int, unsigned number, Cycle at) {
  charge(at);
  for (std::size_t i = frames_.size(); i-- > 1;) {
    if (frames_[i].exception != number) continue;
    if (number < exceptions_.size()) add(exceptions_[number], at - frames_[i].since);
    while (frames_.size() > i) pop();
    return;
  }
}

void Profile::slept(int, Cycle at) {
  charge(at);
  sleeping_ = true;
}

void Profile::woke(int, Cycle at) {
  charge(at);
  sleeping_ = false;
}

void Profile::masked(int, bool interrupts_off, Cycle at) {
  if (masked_ && !interrupts_off) longest_masked_ = std::max(longest_masked_, at - masked_since_);
  if (!masked_ && interrupts_off) masked_since_ = at;
  masked_ = interrupts_off;
}

std::vector<ProfileEntry> Profile::functions() const {
  std::vector<ProfileEntry> all = entries_;
  // What is still running has its time up to now, but is not done.
  std::vector<Frame> running = frames_;
  if (!sleeping_ && core_.cycle() > last_) running.back().own += core_.cycle() - last_;
  for (const Frame& frame : running) {
    all[frame.function].total += frame.own;
    all[frame.function].longest = std::max(all[frame.function].longest, frame.own);
    if (all[frame.function].count == 0) all[frame.function].count = 1;
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
      "core %d: %llu cycles, %.2f%% asleep, interrupts off at most %llu cycles\n", core_.id(),
      static_cast<unsigned long long>(cycles()),
      cycles() == 0 ? 0.0 : 100.0 * static_cast<double>(asleep_) / static_cast<double>(cycles()),
      static_cast<unsigned long long>(longest_masked_));
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
