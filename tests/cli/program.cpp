#include "tests/cli/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>

#include "tests/cli/program_start.hpp"
#include "tests/paths.hpp"

namespace lamplock::cli::test {
namespace {

namespace fs = std::filesystem;

constexpr unsigned short terminal_rows = 30;

int exit_of(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status); }

void redirect(const std::string& file, int flags, int to) {
  const int descriptor = ::open(file.c_str(), flags, 0600);
  ::dup2(descriptor, to);
  ::close(descriptor);
}

}  // namespace

std::string program_path() { return lamplock::test::in_build("lamplock"); }

Folder::Folder() {
  std::string name = (fs::temp_directory_path() / "lamplock-test-XXXXXX").string();
  path_ = ::mkdtemp(name.data());
}

Folder::~Folder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::vector<std::string> Folder::files(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::string Folder::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(path_ / name, std::ios::binary) << bytes;
  return (path_ / name).string();
}

std::string read(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<std::string> lines(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> result;
  for (std::string line; std::getline(in, line);) result.push_back(line);
  return result;
}

Running::Running(const std::vector<std::string>& arguments, const std::string& input) {
  ProgramStart start(arguments);
  const std::string in = folder_.write("in", input);
  const std::string out = folder_ / "out", err = folder_ / "err";
  process_ = ::fork();
  if (process_ != 0) return;
  redirect(in, O_RDONLY, STDIN_FILENO);
  redirect(out, O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
  redirect(err, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
  start.become_program();
}

Running::~Running() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

bool Running::wait_for(const std::string& text) const {
  using namespace std::chrono_literals;
  const auto until = std::chrono::steady_clock::now() + 20s;
  while (std::chrono::steady_clock::now() < until) {
    if ((out() + err()).find(text) != std::string::npos) return true;
    std::this_thread::sleep_for(5ms);
  }
  return false;
}

void Running::interrupt() const { ::kill(process_, SIGINT); }

void Running::terminate() const { ::kill(process_, SIGTERM); }

Finished Running::finish() {
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = -1;
  return {exit_of(status), out(), err()};
}

InTerminal::InTerminal(const std::vector<std::string>& arguments) { start(arguments, nullptr); }

InTerminal::InTerminal(const std::vector<std::string>& arguments, const termios& modes) {
  start(arguments, &modes);
}

void InTerminal::start(const std::vector<std::string>& arguments, const termios* modes) {
  ProgramStart program(arguments);
  const winsize size{terminal_rows, 80, 0, 0};
  process_ = ::forkpty(&terminal_, nullptr, modes, &size);
  if (process_ != 0) return;
  ::setenv("TERM", "xterm", 1);
  program.become_program();
}

InTerminal::~InTerminal() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  ::close(terminal_);
}

/// Returns false after the program has closed its end.
bool InTerminal::read_more(int wait_ms) {
  pollfd watched{terminal_, POLLIN, 0};
  if (::poll(&watched, 1, wait_ms) <= 0) return true;
  std::array<char, 4096> text{};
  const ssize_t count = ::read(terminal_, text.data(), text.size());
  if (count > 0) shown_.append(text.data(), static_cast<std::size_t>(count));
  return count > 0;
}

bool InTerminal::wait_for(const std::string& text) {
  using namespace std::chrono_literals;
  const auto until = std::chrono::steady_clock::now() + 20s;
  bool open = true;
  while (open && std::chrono::steady_clock::now() < until) {
    const auto at = shown_.find(text, seen_);
    if (at != std::string::npos) {
      seen_ = at + text.size();
      return true;
    }
    open = read_more(20);
  }
  return false;
}

/// A terminal takes no more keys while its buffers are full.
void InTerminal::type(const std::string& text) {
  std::size_t written = 0;
  while (written < text.size()) {
    pollfd watched{terminal_, POLLIN | POLLOUT, 0};
    ::poll(&watched, 1, -1);
    if ((watched.revents & POLLIN) != 0 && !read_more(0)) return;
    if ((watched.revents & POLLOUT) == 0) continue;
    constexpr std::size_t piece = 256;
    const ssize_t count =
        ::write(terminal_, text.data() + written, std::min(piece, text.size() - written));
    if (count < 0) return;
    written += static_cast<std::size_t>(count);
  }
}

std::string InTerminal::watch(std::chrono::milliseconds time) {
  const auto until = std::chrono::steady_clock::now() + time;
  while (std::chrono::steady_clock::now() < until && read_more(5)) continue;
  std::string shown = shown_.substr(watched_);
  watched_ = shown_.size();
  return shown;
}

void InTerminal::resize(unsigned short columns) const {
  const winsize size{terminal_rows, columns, 0, 0};
  ::ioctl(terminal_, TIOCSWINSZ, &size);
}

void InTerminal::send_signal(int signal) const { ::kill(process_, signal); }

void InTerminal::hang_up() {
  ::close(terminal_);
  terminal_ = -1;
}

termios InTerminal::modes() const {
  termios modes{};
  ::tcgetattr(terminal_, &modes);
  return modes;
}

Finished InTerminal::finish() {
  while (terminal_ >= 0 && read_more(1000)) {
  }
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = -1;
  return {exit_of(status), shown_, {}};
}

Finished run(const std::vector<std::string>& arguments, const std::string& input) {
  return Running(arguments, input).finish();
}

}  // namespace lamplock::cli::test
