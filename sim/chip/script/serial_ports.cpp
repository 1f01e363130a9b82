#include "sim/chip/script/serial_ports.hpp"

#include <utility>

namespace lamplock::sim::chip::script {
namespace {

/// Bytes kept of output that is neither searched nor taken.
constexpr std::size_t max_kept = 1 << 20;

std::size_t index_of(Port port) { return static_cast<std::size_t>(port); }

}  // namespace

/// The other end of a UART.
class SerialPorts::Line final : public ByteLine {
 public:
  Line(SerialPorts& ports, Port port) : ports_(ports), port_(port) {}
  void byte_sent(std::uint8_t byte, Cycle at) override { ports_.heard(port_, byte, at); }

 private:
  SerialPorts& ports_;
  Port port_;
};

SerialPorts::SerialPorts(Chip& chip, UsbHost& host)
    : chip_(chip),
      host_(host),
      lines_{std::make_unique<Line>(*this, Port::uart0),
             std::make_unique<Line>(*this, Port::uart1)} {
  chip.system().uart0.connect(*lines_[0]);
  chip.system().uart1.connect(*lines_[1]);
}

SerialPorts::~SerialPorts() = default;

void SerialPorts::heard(Port port, std::uint8_t byte, Cycle at) {
  Heard& heard = heard_[index_of(port)];
  ++heard.count;
  heard.unused += static_cast<char>(byte);
  heard.times.push_back(moment_of(chip_.wheel(), at));
  heard.to_take += static_cast<char>(byte);
  if (heard.unused.size() > 2 * max_kept) {
    heard.unused.erase(0, max_kept);
    heard.times.erase(heard.times.begin(), heard.times.begin() + max_kept);
  }
  if (heard.to_take.size() > 2 * max_kept) heard.to_take.erase(0, max_kept);
}

void SerialPorts::poll(Cycle now) {
  std::array<std::uint8_t, 1024> bytes{};
  for (std::size_t count = host_.read(bytes); count > 0; count = host_.read(bytes))
    for (std::size_t i = 0; i < count; ++i) heard(Port::usb, bytes[i], now);
  if (to_host_.empty()) return;
  const auto* const first = reinterpret_cast<const std::uint8_t*>(to_host_.data());
  to_host_.erase(0, host_.write({first, to_host_.size()}));
}

void SerialPorts::send(Port port, std::string_view bytes) {
  if (port == Port::usb) {
    to_host_ += bytes;
    return poll(chip_.wheel().now());
  }
  Uart& uart = port == Port::uart0 ? chip_.system().uart0 : chip_.system().uart1;
  for (const char each : bytes) uart.send_to_chip(static_cast<std::uint8_t>(each));
}

std::optional<Moment> SerialPorts::find(Port port, std::string_view text) {
  Heard& heard = heard_[index_of(port)];
  const std::size_t at = heard.unused.find(text);
  if (at == std::string::npos) return std::nullopt;
  const std::size_t end = at + text.size();
  const Moment result = heard.times[end - 1];
  heard.unused.erase(0, end);
  heard.times.erase(heard.times.begin(), heard.times.begin() + static_cast<std::ptrdiff_t>(end));
  return result;
}

std::string_view SerialPorts::unused(Port port) const { return heard_[index_of(port)].unused; }

std::string SerialPorts::take(Port port) {
  return std::exchange(heard_[index_of(port)].to_take, {});
}

}  // namespace lamplock::sim::chip::script
