#include "host/gpio/safe_input.hpp"

#include <optional>

namespace lamplock::gpio {

void SafeInput::poll(Time now) {
  if (lost_) return;
  // Edges first: a pulse that ends between the two calls leaves edges for the next poll. An edge to
  // the safe level counts too: the level was active before it.
  const bool moved = input_->moved();
  const std::optional<bool> level = input_->active();
  lost_ = !level;
  const bool tripped = !level || *level || moved;
  if (tripped || !polled_) quiet_since_ = now;
  polled_ = true;
  well_ = !tripped && now - quiet_since_ >= debounce_;
}

}  // namespace lamplock::gpio
