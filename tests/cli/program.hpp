// Runs the real program, as a shell would.
//
// In:  arguments. Out: exit status and output. A program in the background can be queried and
//      interrupted; no program is left running when a test ends.
#pragma once

#include <sys/types.h>
#include <termios.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace lamplock::cli::test {

/// The program `lamplock` that was built with the tests.
std::string program_path();

/// A temporary folder, removed at the end of the test.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  const std::filesystem::path& path() const { return path_; }
  /// Names of the files in a folder, sorted.
  static std::vector<std::string> files(const std::filesystem::path& folder);
  std::vector<std::string> files() const { return files(path_); }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& bytes) const;

 private:
  std::filesystem::path path_;
};

std::string read(const std::filesystem::path& file);
std::vector<std::string> lines(const std::string& text);

/// A run that has ended.
struct Finished {
  int status = -1;  ///< exit status; 128 + signal if one ended it
  std::string out, err;
};

/// A run that has not ended yet. Its stdin is `input`.
class Running {
 public:
  explicit Running(const std::vector<std::string>& arguments, const std::string& input = "");
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  /// Waits until the program has printed this to stdout or stderr; false after some seconds.
  bool wait_for(const std::string& text) const;
  std::string out() const { return read(folder_ / "out"); }
  std::string err() const { return read(folder_ / "err"); }
  void interrupt() const;
  void terminate() const;
  Finished finish();

 private:
  Folder folder_;
  pid_t process_ = -1;
};

/// A run in its own terminal: stdin, stdout and stderr.
class InTerminal {
 public:
  explicit InTerminal(const std::vector<std::string>& arguments);
  /// Runs in a terminal with these modes.
  InTerminal(const std::vector<std::string>& arguments, const termios& modes);
  ~InTerminal();
  InTerminal(const InTerminal&) = delete;
  InTerminal& operator=(const InTerminal&) = delete;

  /// Waits until this appears after the last text waited for; false after some seconds.
  bool wait_for(const std::string& text);
  /// Types all of it; the program may write meanwhile.
  void type(const std::string& text);
  /// Reads for this time. Returns all that was shown since the last call.
  std::string watch(std::chrono::milliseconds time);
  /// The width of the terminal; 80 columns at the start.
  void resize(unsigned short columns) const;
  void send_signal(int signal) const;
  /// Closes the terminal, as a closed window or a cut line does.
  void hang_up();
  /// The modes that the program has set or left.
  termios modes() const;
  /// Waits for the end of the program; its output is in `out`.
  Finished finish();

 private:
  void start(const std::vector<std::string>& arguments, const termios* modes);
  bool read_more(int wait_ms);

  int terminal_ = -1;
  pid_t process_ = -1;
  std::string shown_;
  std::size_t seen_ = 0;
  std::size_t watched_ = 0;
};

/// Runs the program to its end.
Finished run(const std::vector<std::string>& arguments, const std::string& input = "");

}  // namespace lamplock::cli::test
