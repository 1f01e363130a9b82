#include "sim/chip/serial/uart_frame.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace lamplock::sim::chip {

bool UartFormat::parity_bit(std::uint32_t data) const {
  if (stick) return !even;
  const bool odd_ones = std::popcount(data & data_mask()) % 2 != 0;
  return even ? odd_ones : !odd_ones;
}

// --- transmitter

UartFrame::UartFrame(std::uint32_t data, const UartFormat& format, Picoseconds start)
    : start_(start), bit_(std::max<Picoseconds>(1, format.bit)) {
  levels_ = ~(format.data_mask() << 1 | 1u) | (data & format.data_mask()) << 1;
  const unsigned parity = 1 + format.data_bits;
  if (format.parity && !format.parity_bit(data)) levels_ &= ~(1u << parity);
}

unsigned UartFrame::index(Picoseconds at) const {
  return static_cast<unsigned>(std::min<Picoseconds>(31, (at - start_) / bit_));
}

Picoseconds UartFrame::next_change(Picoseconds at) const {
  const bool now = level(at);
  for (unsigned n = index(at) + 1; n < 32; ++n)
    if (((levels_ >> n & 1u) != 0) != now) return start_ + bit_ * static_cast<Picoseconds>(n);
  return never;
}

// --- receiver

void UartReceiver::reset(bool level) {
  level_ = level;
  busy_ = false;
  awaits_mark_ = !level;
}

std::optional<std::uint32_t> UartReceiver::line(bool level, Picoseconds at,
                                                const UartFormat& format) {
  const std::optional<std::uint32_t> complete = run(at - 1);
  if (std::exchange(level_, level) == level || busy_) return complete;
  if (level) {
    awaits_mark_ = false;
  } else if (!awaits_mark_ && format.bit != 0) {
    format_ = format;
    busy_ = true;
    start_ = at;
    sample_at_ = at + format.bit / 2;
    index_ = 0;
    sampled_ = 0;
  }
  return complete;
}

std::optional<std::uint32_t> UartReceiver::run(Picoseconds through) {
  std::optional<std::uint32_t> complete;
  while (busy_ && sample_at_ <= through) complete = sample();
  return complete;
}

std::optional<std::uint32_t> UartReceiver::sample() {
  if (index_ == 0 && level_) {  // not a start bit
    busy_ = false;
    return std::nullopt;
  }
  sampled_ |= (level_ ? 1u : 0u) << index_;
  if (index_ == format_.bits_before_stop()) {
    busy_ = false;
    awaits_mark_ = !level_;
    return character();
  }
  ++index_;
  sample_at_ = start_ + format_.bit * static_cast<Picoseconds>(index_) + format_.bit / 2;
  return std::nullopt;
}

std::uint32_t UartReceiver::character() const {
  const std::uint32_t data = sampled_ >> 1 & format_.data_mask();
  const auto sampled = [this](unsigned n) { return (sampled_ >> n & 1u) != 0; };
  std::uint32_t result = data;
  if (!sampled(format_.bits_before_stop())) result |= uart_data::framing_error;
  if (format_.parity && sampled(1 + format_.data_bits) != format_.parity_bit(data))
    result |= uart_data::parity_error;
  if (sampled_ == 0) result |= uart_data::break_error;
  return result;
}

}  // namespace lamplock::sim::chip
