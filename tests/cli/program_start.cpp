#include "tests/cli/program_start.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <iterator>
#include <memory>
#include <set>

#include "host/cli/program.hpp"
#include "host/cli/program_main.hpp"
#include "tests/cli/program.hpp"

namespace lamplock::cli::test {
namespace {

namespace fs = std::filesystem;

#ifdef LAMPLOCK_SANITIZED
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

/// The commands of the program, made once: each child has a copy of its own.
Command& commands() {
  static const std::unique_ptr<Command> made = make_program();
  return *made;
}

/// A forked child keeps the locks that other threads held, without the threads that would unlock
/// them.
bool has_one_thread() {
  const fs::directory_iterator threads("/proc/self/task");
  return std::distance(begin(threads), end(threads)) == 1;
}

bool is_first_run(const std::string& command) {
  static std::set<std::string> commands_run;
  return commands_run.insert(command).second;
}

/// Closes the files that execv() closes: those with FD_CLOEXEC.
void close_marked_files() {
  std::vector<int> files;
  for (const auto& entry : fs::directory_iterator("/proc/self/fd"))
    files.push_back(std::stoi(entry.path().filename().string()));
  for (const int file : files) {
    const int flags = ::fcntl(file, F_GETFD);
    if (flags >= 0 && (flags & FD_CLOEXEC) != 0) ::close(file);
  }
}

}  // namespace

ProgramStart::ProgramStart(const std::vector<std::string>& arguments)
    : words_{program_path()},
      is_call_(is_sanitized && !is_first_run(arguments.empty() ? "" : arguments.front()) &&
               has_one_thread()) {
  words_.insert(words_.end(), arguments.begin(), arguments.end());
  for (std::string& word : words_) argv_.push_back(word.data());
  argv_.push_back(nullptr);
  if (!is_call_) return;
  commands();
  std::fflush(nullptr);  // or the child would print the rest of our own output
}

void ProgramStart::become_program() {
  if (!is_call_) {
    ::execv(argv_.front(), argv_.data());
    ::_exit(127);
  }
  close_marked_files();
  const int status = program_main(commands(), static_cast<int>(words_.size()), argv_.data());
  std::fflush(nullptr);
  // Objects of the test program stay as they are: its temporary folders are those of the parent.
  ::_exit(status);
}

}  // namespace lamplock::cli::test
