// The error of a file that cannot be written.
//
// In:  the file, the reason. Out: an Error(bad_input) that keeps the reason, so that it can become
//      part of another error. Who: all writers of files.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "host/error.hpp"

namespace lamplock {

/// A file that cannot be written.
class OutputError : public Error {
 public:
  OutputError(const std::filesystem::path& file, const std::string& problem);
  /// "cannot be written (REASON)" for an error number of the system.
  OutputError(const std::filesystem::path& file, int error);
  /// What is wrong, without file and remedy. Lives as long as the error.
  const std::string& problem() const { return *problem_; }

 private:
  std::shared_ptr<const std::string> problem_;  ///< shared, so that a copy does not throw
};

}  // namespace lamplock
