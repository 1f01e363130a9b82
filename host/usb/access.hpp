// Whether this program may use a device node, and what helps if not.
//
// In:  the path of a node such as /dev/bus/usb/001/005. Out: what is missing and the remedy.
// Who: lists of devices, and whoever opens one, before the system says no more than "denied".
#pragma once

#include <filesystem>
#include <string>

namespace lamplock::usb {

/// Why a node may not be used. Both empty: it may.
struct AccessProblem {
  std::string what, remedy;
  explicit operator bool() const { return !what.empty(); }
  /// "WHAT; REMEDY", or nothing.
  std::string text() const { return what.empty() ? "" : what + "; " + remedy; }
};

/// Asks the system for reading and writing.
AccessProblem access_problem(const std::filesystem::path& node);

}  // namespace lamplock::usb
