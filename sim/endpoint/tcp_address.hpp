// HOST:PORT as users write it.
#pragma once

#include <optional>
#include <string>

namespace lamplock::sim {

/// The two halves of an address.
struct TcpAddress {
  std::string host;
  std::string port;
};

/// Splits HOST:PORT or [IPV6]:PORT at the last colon; empty if a half is missing.
std::optional<TcpAddress> parse_tcp_address(const std::string& text);

}  // namespace lamplock::sim
