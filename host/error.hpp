// The host's one error type: what a user reads when something is wrong.
#pragma once

#include <stdexcept>
#include <string>

namespace lamplock {

/// Exit status of the program.
enum class Exit : int { done = 0, job_failed = 1, bad_input = 2, no_device = 3, interrupted = 130 };

/// An error shown as one line `error: WHERE: WHAT; REMEDY`.
class Error : public std::runtime_error {
 public:
  Error(Exit exit, const std::string& where, const std::string& what, const std::string& remedy)
      : std::runtime_error("error: " + where + ": " + what + "; " + remedy), exit_(exit) {}
  Exit exit() const { return exit_; }

 private:
  Exit exit_;
};

}  // namespace lamplock
