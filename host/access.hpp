// Whether this program may use a device node, and what helps if not: the one place that knows which
// rule and which group.
//
// In:  the path of a node such as /dev/ttyACM0. Out: what is missing and the remedy.
// Who: lists of devices, and whoever opens a port, a USB device, a pendant or a chip of lines.
#pragma once

#include <filesystem>
#include <string>

namespace lamplock {

/// Why a node may not be used. Both empty: it may.
struct AccessProblem {
  std::string what, remedy;
  explicit operator bool() const { return !what.empty(); }
  /// "WHAT; REMEDY", or nothing.
  std::string text() const { return what.empty() ? "" : what + "; " + remedy; }
};

/// Asks the system for reading and writing.
AccessProblem access_problem(const std::filesystem::path& node);

/// The error number says that somebody else may, but not this program.
bool is_denied(int error);
/// What helps where the system has denied a node: its group, or the rule for its kind.
std::string access_remedy(const std::filesystem::path& node);

}  // namespace lamplock
