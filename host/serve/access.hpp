// Who may talk to the server: only programs of this computer that have the token.
//
// In:  the headers of a request. Out: whether they may be answered. Who: the server, for every
//      request before its body is read.
//
// A page of a foreign site can send requests to this computer, also under a name of its own whose
// address it changes to 127.0.0.1 (DNS rebinding). So Host must name this computer and the port,
// and Origin, which a browser adds and a page cannot forge, must be this server.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lamplock::serve {

/// An address of the loopback interface, by its bytes and not by the start of its text:
/// 127.0.0.0/8 with four numbers, or ::1.
bool is_loopback(std::string_view address);

/// "127.0.0.1:7125", "localhost:7125", "[::1]:7125" with this port.
bool is_own_host(std::string_view host, std::uint16_t port);

/// "http://" and such a host.
bool is_own_origin(std::string_view origin, std::uint16_t port);

/// 128 random bits as hexadecimal digits. Throws std::exception without a source of randomness.
std::string random_token();

/// Six random digits, for a person to read and type.
std::string random_code();

/// Compares in a time that does not depend on the contents.
bool is_same_secret(std::string_view one, std::string_view other);

}  // namespace lamplock::serve
