#include "host/link/line_port.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace lamplock::link {

void LinePort::send_line(std::string_view line) {
  lines_.insert(lines_.end(), line.begin(), line.end());
  lines_.push_back('\n');
}

void LinePort::flush() {
  if (!flush_urgent() || lines_.empty()) return;
  const std::size_t taken = transport_.write(lines_);
  if (taken == 0) return;
  inside_line_ = lines_[taken - 1] != '\n';
  lines_.erase(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(taken));
}

void LinePort::drop_lines() {
  lines_.clear();
  inside_line_ = false;
}

std::size_t LinePort::drop_unbegun_lines() {
  const auto end_of_begun =
      inside_line_ ? std::find(lines_.begin(), lines_.end(), '\n') + 1 : lines_.begin();
  const auto dropped = std::count(end_of_begun, lines_.end(), '\n');
  lines_.erase(end_of_begun, lines_.end());
  return static_cast<std::size_t>(dropped);
}

/// False if bytes are left.
bool LinePort::flush_urgent() {
  if (urgent_.empty()) return true;
  const std::size_t taken = transport_.write(urgent_);
  urgent_.erase(urgent_.begin(), urgent_.begin() + static_cast<std::ptrdiff_t>(taken));
  return urgent_.empty();
}

std::optional<std::string> LinePort::receive() {
  if (received_.empty()) read();
  if (received_.empty()) return std::nullopt;
  std::string line = std::move(received_.front());
  received_.pop_front();
  return line;
}

void LinePort::read() {
  constexpr std::size_t piece = 4096;
  std::array<std::uint8_t, piece> bytes{};
  const std::size_t count = transport_.read(bytes);
  parser_.push(std::span<const std::uint8_t>(bytes).first(count), *this);
}

}  // namespace lamplock::link
