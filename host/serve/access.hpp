// Who may talk to the server: programs that have the token, of this computer or, with --listen,
// of others.
//
// In:  the headers of a request. Out: whether they may be answered. Who: the server, for every
//      request before its body is read.
//
// A page of a foreign site can send requests to this computer, also under a name of its own whose
// address it changes to 127.0.0.1 (DNS rebinding). So Host must name this computer and the port,
// and Origin, which a browser adds and a page cannot forge, must be this server.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lamplock::serve {

/// An address of the loopback interface, by its bytes and not by the start of its text:
/// 127.0.0.0/8 with four numbers, or ::1.
bool is_loopback(std::string_view address);

/// "127.0.0.1:7125", "localhost:7125", "[::1]:7125" with this port.
bool is_own_host(std::string_view host, std::uint16_t port);

/// An address and a port as in a URL: "[::1]:7125".
std::string authority_of(std::string_view address, std::uint16_t port);

/// The origin of a reverse proxy, "https://laser.example.org".
struct PublicOrigin {
  std::string origin, host;
};
/// Nothing if the text is not an origin with a name or an address, in small letters.
std::optional<PublicOrigin> parse_origin(std::string_view text);

/// How clients may name the server: by an address of the loopback interface, by the address `local`
/// at which the connection has arrived, or by the origin of a proxy. No other name: its owner could
/// change its address.
struct ServerNames {
  std::uint16_t port = 0;
  std::optional<PublicOrigin> proxy{};

  bool is_host(std::string_view host, std::string_view local) const;
  bool is_origin(std::string_view origin, std::string_view local) const;

 private:
  bool is_direct(std::string_view host, std::string_view local) const;
};

/// 128 random bits as hexadecimal digits. Throws std::exception without a source of randomness.
std::string random_token();

/// Six random digits, for a person to read and type.
std::string random_code();

/// Compares in a time that does not depend on the contents.
bool is_same_secret(std::string_view one, std::string_view other);

}  // namespace lamplock::serve
