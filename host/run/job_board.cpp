#include "host/run/job_board.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>

#include "host/error.hpp"
#include "host/link/board_text.hpp"
#include "host/link/line_port.hpp"
#include "host/run/board_port.hpp"

namespace lamplock::run {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::microseconds patience = 500ms, slice = 5ms;
/// As in the answer to `$I` of this firmware (firmware/machine/console_commands.cpp).
constexpr std::string_view product = "lamplock";

/// The version of grbl that a board reports; empty if it reports none.
std::string version_of(link::Transport& board) {
  link::LinePort port(board);
  port.send_line("$I");
  link::BoardIdentity identity;
  for (const auto end = board.now() + patience; board.now() < end && board.connected();) {
    port.flush();
    while (const auto line = port.receive()) {
      link::take_identity(*line, identity);
      if (link::parse_answer(*line)) return identity.version;
    }
    board.wait(std::min(slice, end - board.now()));
  }
  return identity.version;
}

}  // namespace

std::unique_ptr<link::Transport> open_job_port(const BoardOptions& options) {
  auto port = open_port(options);
  if (!port) return port;
  const std::string version = version_of(*port);
  if (version.empty() || version.find(product) != std::string::npos) return port;
  throw Error(Exit::bad_input, options.board,
              "the board runs grbl (" + version + "), which cannot run lamplock jobs",
              "send a G-code program: lamplock send FILE.ngc");
}

}  // namespace lamplock::run
