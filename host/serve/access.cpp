#include "host/serve/access.hpp"

#include <fmt/format.h>

#include <algorithm>
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

std::optional<PublicOrigin> parse_origin(std::string_view text) {
  const std::size_t scheme = text.starts_with("https://") ? 8 : text.starts_with("http://") ? 7 : 0;
  const std::string_view host = text.substr(scheme);
  const bool is_host = !host.empty() && std::all_of(host.begin(), host.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view(".-:[]").find(c) != std::string_view::npos;
  });
  if (scheme == 0 || !is_host) return std::nullopt;
  return PublicOrigin{std::string(text), std::string(host)};
}

std::string authority_of(std::string_view address, std::uint16_t port) {
  if (address.find(':') != std::string_view::npos) return fmt::format("[{}]:{}", address, port);
  return fmt::format("{}:{}", address, port);
}

bool ServerNames::is_direct(std::string_view host, std::string_view local) const {
  return is_own_host(host, port) || (!local.empty() && host == authority_of(local, port));
}

bool ServerNames::is_host(std::string_view host, std::string_view local) const {
  return (proxy && host == proxy->host) || is_direct(host, local);
}

bool ServerNames::is_origin(std::string_view origin, std::string_view local) const {
  constexpr std::string_view scheme = "http://";
  return (proxy && origin == proxy->origin) ||
         (origin.starts_with(scheme) && is_direct(origin.substr(scheme.size()), local));
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
