// Ports of simulated things at the outside: pseudo-terminals and TCP.
//
// In:  an option as the user gave it. Out: an open endpoint, or an error that names the option.
// Who: `sim`, `chip`.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "sim/endpoint/pty_endpoint.hpp"
#include "sim/endpoint/tcp_endpoint.hpp"

namespace lamplock::run {

/// Limit of the bytes that wait for an endpoint whose user does not read.
inline constexpr std::size_t max_unsent = 65'536;

/// `option`: for the error, such as "--pty /tmp/engraver". Both throw Error(no_device) if the
/// endpoint cannot be opened, open_tcp() Error(bad_input) if `address` is no HOST:PORT.
std::unique_ptr<sim::PtyEndpoint> open_pty(const std::string& option, const std::string& link);
std::unique_ptr<sim::TcpEndpoint> open_tcp(const std::string& option, const std::string& address);

}  // namespace lamplock::run
