// Starts the program `lamplock` in a child process of a test.
//
// In:  arguments. Out: the child becomes the program; its exit status is that of the program.
// Under the sanitizers a start of the executable takes 0.13 s more than a call of its main function
// in a forked test program. So only the first run of each command in a test program starts the
// executable, and is checked for leaks; the others are calls. In other builds each run is a start.
#pragma once

#include <string>
#include <vector>

namespace lamplock::cli::test {

class ProgramStart {
 public:
  /// The parent makes it before fork().
  explicit ProgramStart(const std::vector<std::string>& arguments);

  /// In the child, after it has set its standard streams and its environment.
  [[noreturn]] void become_program();

 private:
  /// In the format of execv().
  std::vector<std::string> words_;
  std::vector<char*> argv_;
  bool is_call_;
};

}  // namespace lamplock::cli::test
