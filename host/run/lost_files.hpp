// Files that a run could not write after the machine had begun.
//
// In:  functions that write files. Out: the files that were lost, with the reasons; the exit
// status. Who: the use cases that run something on a board. A failure of an output must neither
// hide what the machine has done nor look like "nothing was done" to a script that then fires a
// second time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host/error.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

/// A file that was not written.
struct LostFile {
  std::string file, reason;
};

/// The lost files of one run, in the order of writing.
class LostFiles {
 public:
  /// Calls `write`. If it throws, `file` is lost and the run continues.
  void attempt(const std::string& file, const std::function<void()>& write);
  const std::vector<LostFile>& all() const { return all_; }
  /// Names of the files, for documents.
  std::vector<std::string> names() const;

  /// Shows a line for each file; `done`: what was done nevertheless, "the job was fired". Returns
  /// the exit status of a run that has ended with `exit`: job_failed instead of done if a file is
  /// lost.
  Exit report(Exit exit, const std::string& done, Frontend& frontend) const;

 private:
  std::vector<LostFile> all_;
};

}  // namespace lamplock::run
