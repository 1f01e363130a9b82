#include "sim/chip_board/drive_wire.hpp"

#include <algorithm>

namespace lamplock::sim {

DriveWire::DriveWire(chip::Chip& chip, const boards::UartDrives& row)
    : chip_(chip), slot_(chip.wheel().add(*this)), tx_(row.tx), drives_(row.addresses) {
  receiver_.reset(false);
  chip.gpio().listen(static_cast<chip::PadListener&>(*this));
}

void DriveWire::pad_changed(unsigned gpio, bool level, chip::Cycle at) {
  if (gpio != tx_ || replies_) return;
  const Picoseconds time = chip_.wheel().time_of(at);
  take(receiver_.line(level, time, format_), time);
  echoes_ = true;
  schedule();
}

/// RX has the level of TX through the resistor, unless a drive replies.
void DriveWire::echo() {
  echoes_ = false;
  const bool is_driven = (chip_.gpio().driven() >> tx_ & 1) != 0;
  const bool level = (chip_.gpio().pad_levels() >> tx_ & 1) != 0;
  put(!is_driven ? chip::External::floating : level ? chip::External::high : chip::External::low);
}

void DriveWire::put(chip::External level) {
  chip_.gpio().set_external(tx_ + 1, level, chip_.wheel().now());
}

/// While a drive replies the others do not listen.
void DriveWire::take(std::optional<std::uint32_t> character, Picoseconds at) {
  if (!character || *character > 0xff) return;
  for (const std::uint8_t byte : drives_.receive(static_cast<std::uint8_t>(*character), at, bit)) {
    const std::optional<std::uint8_t> sent = disturb ? disturb(byte) : byte;
    if (sent) reply_.push_back(*sent);
  }
  if (reply_.empty()) return;
  replies_ = true;
  // From the end of the stop bit, whose middle is now.
  frame_end_ = at + bit / 2 + drives_.reply_delay_bits() * bit;
  next_edge_ = frame_end_;
}

void DriveWire::send(Picoseconds at) {
  if (at >= frame_end_) {
    if (reply_.empty()) {
      replies_ = false;
      next_edge_ = never;
      receiver_.reset(true);
      return echo();
    }
    frame_ = chip::UartFrame(reply_.front(), format_, at);
    reply_.pop_front();
    // The chip has the last byte in the middle of its stop bit, and may send then.
    frame_end_ = at + format_.length() - (reply_.empty() ? bit / 2 : 0);
  }
  put(frame_.level(at) ? chip::External::high : chip::External::low);
  next_edge_ = std::min(frame_.next_change(at), frame_end_);
}

void DriveWire::run(chip::Cycle to) {
  const Picoseconds now = chip_.wheel().time_of(std::min(to, chip_.wheel().now()));
  if (echoes_) echo();
  if (replies_) {
    if (now >= next_edge_) send(now);
  } else {
    take(receiver_.run(now), now);
  }
  schedule();
}

void DriveWire::schedule() {
  const Picoseconds next = replies_ ? next_edge_ : receiver_.due();
  chip_.wheel().set(slot_, echoes_ ? chip_.wheel().now() : chip_.wheel().cycle_at(next));
}

}  // namespace lamplock::sim
