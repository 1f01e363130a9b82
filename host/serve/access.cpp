#include "host/serve/access.hpp"

#include <fmt/format.h>

#include <random>

namespace lamplock::serve {
namespace {

/// A number of an address: 0 to 255 without a leading zero, which some readers take for octal.
bool is_byte(std::string_view text) {
  if (text.empty() || text.size() > 3 || (text.size() > 1 && text.front() == '0')) return false;
  unsigned value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return false;
    value = value * 10 + static_cast<unsigned>(c - '0');
  }
  return value <= 255;
}

}  // namespace

bool is_loopback(std::string_view address) {
  if (address == "::1") return true;
  if (!address.starts_with("127.")) return false;
  int bytes = 1;
  for (std::size_t begin = 4;;) {
    const std::size_t end = address.find('.', begin);
    if (!is_byte(address.substr(begin, end == std::string_view::npos ? end : end - begin)))
      return false;
    ++bytes;
    if (end == std::string_view::npos) return bytes == 4;
    begin = end + 1;
  }
}

bool is_own_host(std::string_view host, std::uint16_t port) {
  const std::string end = fmt::format(":{}", port);
  if (!host.ends_with(end)) return false;
  host.remove_suffix(end.size());
  if (host == "localhost") return true;
  if (host == "[::1]") return true;
  return host.find(':') == std::string_view::npos && is_loopback(host);
}

bool is_own_origin(std::string_view origin, std::uint16_t port) {
  constexpr std::string_view scheme = "http://";
  return origin.starts_with(scheme) && is_own_host(origin.substr(scheme.size()), port);
}

std::string random_token() {
  std::random_device source;  // getrandom() of the kernel
  std::string token;
  for (int i = 0; i < 4; ++i) token += fmt::format("{:08x}", source());
  return token;
}

std::string random_code() {
  std::random_device source;
  return fmt::format("{:06}", std::uniform_int_distribution<int>(0, 999'999)(source));
}

bool is_same_secret(std::string_view one, std::string_view other) {
  if (one.size() != other.size()) return false;
  unsigned differs = 0;
  for (std::size_t i = 0; i < one.size(); ++i) differs |= static_cast<unsigned>(one[i] ^ other[i]);
  return differs == 0;
}

}  // namespace lamplock::serve
