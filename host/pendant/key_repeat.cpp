#include "host/pendant/key_repeat.hpp"

#include <algorithm>

namespace lamplock::pendant {
namespace {

using namespace std::chrono_literals;

constexpr Time max_interval = 150ms;
constexpr Time min_trust = 100ms, max_trust = 300ms;

}  // namespace

KeyRepeat::Press KeyRepeat::press(const std::string& key, Time now) {
  const bool same = key == key_ && !key_.empty();
  const Time gap = now - at_;
  key_ = key;
  at_ = now;
  if (!same || gap > max_interval) {
    interval_ = Time(0);
    return {};
  }
  // Remote terminals send several at a time, so the interval shrinks slowly.
  interval_ = std::max(gap, interval_ * 3 / 4);
  return {true, now + std::clamp<Time>(interval_ * 5 / 2, min_trust, max_trust)};
}

}  // namespace lamplock::pendant
