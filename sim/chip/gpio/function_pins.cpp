#include "sim/chip/gpio/function_pins.hpp"

namespace lamplock::sim::chip {

FunctionPins::FunctionPins(Gpio& gpio, PinFunction function, SignalOf signal_of)
    : gpio_(gpio), function_(function) {
  for (unsigned pin = 0; pin < gpio_count; ++pin)
    if (const unsigned signal = signal_of(pin); signal < signal_count) pins_[signal] |= 1u << pin;
  gpio_.listen(static_cast<FunctionListener&>(*this), function);
}

void FunctionPins::put(unsigned signal, bool level, bool enable, Cycle at) {
  const std::uint32_t pins = pins_[signal];
  const std::uint32_t levels = level ? levels_ | pins : levels_ & ~pins;
  const std::uint32_t enables = enable ? enables_ | pins : enables_ & ~pins;
  if (levels == levels_ && enables == enables_) return;
  levels_ = levels;
  enables_ = enables;
  gpio_.drive(function_, levels, enables, at);
}

void FunctionPins::inputs_changed(Cycle at) {
  if (((gpio_.inputs() & selected() & sensed_) ^ seen_) != 0) report(at);
}

void FunctionPins::connections_changed(Cycle at) {
  if (selected() != connections_seen_) report(at);
}

void FunctionPins::connections_changing(Cycle at) {
  for (User* user : users_) user->pins_connecting(at);
}

void FunctionPins::report(Cycle at) {
  connections_seen_ = selected();
  seen_ = gpio_.inputs() & connections_seen_ & sensed_;
  for (User* user : users_) user->pins_changed(at);
}

}  // namespace lamplock::sim::chip
