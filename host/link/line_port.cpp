#include "host/link/line_port.hpp"

#include <array>
#include <utility>

namespace lamplock::link {

void LinePort::send_line(std::string_view line) {
  lines_.insert(lines_.end(), line.begin(), line.end());
  lines_.push_back('\n');
}

void LinePort::flush() {
  if (write(urgent_)) write(lines_);
}

/// False if something is left.
bool LinePort::write(std::vector<std::uint8_t>& bytes) {
  if (bytes.empty()) return true;
  const std::size_t taken = transport_.write(bytes);
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
  return bytes.empty();
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
