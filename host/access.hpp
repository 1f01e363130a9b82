// Checks whether this program may use a device node, and gives the remedy: the udev rule or the
// group.
// In:  the path of a node such as /dev/ttyACM0. Out: the problem and the remedy.
// Who: lists of devices, and code that opens a port, a USB device, a pendant or a chip of lines.
#pragma once

#include <filesystem>
#include <string>

namespace lamplock {

/// Why a node may not be used. Both are empty if it may.
struct AccessProblem {
  std::string what, remedy;
  explicit operator bool() const { return !what.empty(); }
  /// "WHAT; REMEDY", or empty.
  std::string text() const { return what.empty() ? "" : what + "; " + remedy; }
};

/// Asks the system whether the node may be read and written.
AccessProblem access_problem(const std::filesystem::path& node);

/// The error number means a missing permission.
bool is_denied(int error);
/// The remedy for a missing permission: the node's group, or the rule for its kind.
std::string access_remedy(const std::filesystem::path& node);

}  // namespace lamplock
