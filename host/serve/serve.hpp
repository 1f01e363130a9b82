// A board as a page in the browser and as JSON-RPC for programs (docs/page.md, docs/api.md).
//
// In:  a board, a port of this computer, a folder of jobs. Out: the server, until the user ends it.
// Who: `serve`. The terminal gets the address with the token, and the code for pairing.
#pragma once

#include <cstdint>
#include <string>

#include "host/run/board_options.hpp"
#include "host/run/frontend.hpp"
#include "host/run/machine_options.hpp"

namespace lamplock::serve {

inline constexpr const char* loopback_address = "127.0.0.1";
inline constexpr std::uint16_t default_port = 7125;

struct ServeOptions {
  run::BoardOptions board;
  run::MachineOptions machine;
  std::uint32_t port = default_port;       ///< 0: any free one
  std::string address = loopback_address;  ///< another one needs a password
  std::string password;                    ///< file with its hash; empty: none
  std::string proxy;                       ///< origin of a reverse proxy; empty: none
  std::string octoprint;                   ///< file with the key of its programs; empty: none
  std::string camera;                      ///< source of its pictures; empty: none
  std::string log;                         ///< file; empty: none
  std::string library;                     ///< of materials and history; empty: the user's own
  std::string texts;                       ///< file with the page in another language; empty: none
  std::string folder;                      ///< of jobs; empty: default_job_folder()
  bool pairs = false;                      ///< clients with the code may fire
};

/// Writes the hash of a password, for this user alone. Throws Error(bad_input).
void write_password(const std::string& file, const std::string& password);

/// Throws Error: bad_input (options, folder), no_device (the board or the port is in use).
void serve(const ServeOptions& options, run::Frontend& frontend);

}  // namespace lamplock::serve
