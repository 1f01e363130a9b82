// The time of leases and notifications.
#pragma once

#include <chrono>
#include <functional>

namespace lamplock::serve {

using Clock = std::chrono::steady_clock;
/// Clock::now, or the time of a simulated board in a test.
using Now = std::function<Clock::time_point()>;

}  // namespace lamplock::serve
