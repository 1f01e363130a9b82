#include "sim/endpoint/tcp_address.hpp"

#include <charconv>
#include <cstdint>
#include <system_error>

namespace lamplock::sim {

std::optional<TcpAddress> parse_tcp_address(const std::string& text) {
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size()) return std::nullopt;
  TcpAddress address{text.substr(0, colon), text.substr(colon + 1)};
  if (address.host.front() == '[' && address.host.back() == ']')
    address.host = address.host.substr(1, address.host.size() - 2);
  if (address.host.empty()) return std::nullopt;
  // The resolver would take a greater number modulo 65536.
  std::uint16_t number = 0;
  const char* begin = address.port.data();
  const auto parsed = std::from_chars(begin, begin + address.port.size(), number);
  if (parsed.ec == std::errc::result_out_of_range) return std::nullopt;
  return address;
}

}  // namespace lamplock::sim
