// The host's error type: the message for the user about a failure.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace lamplock {

/// Exit status of the program.
enum class Exit : int {
  done = 0,
  job_failed = 1,
  bad_input = 2,
  no_device = 3,
  interrupted = 130,
  terminated = 143  ///< by SIGTERM, as a shell reports it
};

/// An error shown as one printable line `error: WHERE: WHAT; REMEDY`, for any contents of its parts
/// (printable.hpp).
class Error : public std::runtime_error {
 public:
  Error(Exit exit, const std::string& where, const std::string& what, const std::string& remedy);
  Exit exit() const { return exit_; }
  /// The same message with another status.
  Error with(Exit exit) const {
    Error other = *this;
    other.exit_ = exit;
    return other;
  }
  /// `WHERE: WHAT; REMEDY`, as part of another line. Lives as long as the error.
  std::string_view message() const { return std::string_view(what()).substr(prefix.size()); }

 private:
  static constexpr std::string_view prefix = "error: ";
  Exit exit_;
};

}  // namespace lamplock
