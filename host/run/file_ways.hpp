// Which command takes a file, for the remedies of commands that do not.
//
// In:  a file that the user gave to a command of another kind. Out: what the file is, and commands
//      that take it as they are typed. Who: readers of jobs, programs, models and point lists.
// Contents count before the ending of the name.
#pragma once

#include <string>

namespace lamplock::run {

struct FileWay {
  std::string what;    ///< "is a job": what the file is
  std::string remedy;  ///< commands
  explicit operator bool() const { return !what.empty(); }
};

/// Nothing for files of which no command takes anything.
FileWay way_of_file(const std::string& file);

/// Throws Error(bad_input) for a file without a byte, with a remedy by its name.
void refuse_empty(const std::string& file);

/// Throws Error(bad_input) for an empty file, a job or a program of G-code, where a model, a
/// picture or points are read.
void refuse_finished(const std::string& file);

/// The same where a picture is read; also for models, drawings and points.
void refuse_for_picture(const std::string& file);

}  // namespace lamplock::run
