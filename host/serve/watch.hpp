// Watches a machine that `lamplock serve` holds: state, position, progress, lines of the console.
//
// In:  the address of the page. Out: what differs, for a terminal or a script. Who: `watch`.
#pragma once

#include <chrono>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "host/run/frontend.hpp"

namespace lamplock::serve {

struct WatchOptions {
  std::string page;                       ///< address as `serve` prints it
  std::chrono::milliseconds every{1000};  ///< between two questions
  bool once = false;                      ///< the status, without lines of the console
};

/// Takes the status (docs/api.md) with the new lines of the console as its member `console`.
using WatchSink = std::function<void(const nlohmann::json&)>;

/// Calls `sink` when something has changed, until the user ends it. Throws Error: bad_input (the
/// address), no_device (the server is not there, or has ended).
void watch(const WatchOptions& options, const WatchSink& sink, run::Frontend& frontend);

/// The status in one line: "Run  X 1.000 Y 2.000 Z 0.000 mm; part.ngc: 12 of 40, 5 s left".
std::string status_text(const nlohmann::json& status);

}  // namespace lamplock::serve
