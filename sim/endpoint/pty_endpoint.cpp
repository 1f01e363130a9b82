#include "sim/endpoint/pty_endpoint.hpp"

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>
#include <cstdlib>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace lamplock::sim {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// Raw: no echo, no line editing, no signals, every byte unchanged.
void make_raw(int descriptor) {
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0) fail("pseudo-terminal");
  ::cfmakeraw(&settings);
  if (::tcsetattr(descriptor, TCSANOW, &settings) != 0) fail("pseudo-terminal");
}

/// Replaces a link of an earlier simulation, which leads to a terminal or nowhere, and nothing
/// else.
void make_link(const std::string& target, const std::filesystem::path& link) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const fs::file_status found = fs::status(link, ignored);
  const bool is_old = !fs::exists(found) || fs::is_character_file(found);
  if (is_old && fs::is_symlink(fs::symlink_status(link, ignored))) fs::remove(link);
  fs::create_symlink(target, link);
}

}  // namespace

PtyEndpoint::PtyEndpoint(std::filesystem::path link) {
  descriptor_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 256> name{};
  if (descriptor_ < 0 || ::grantpt(descriptor_) != 0 || ::unlockpt(descriptor_) != 0 ||
      ::ptsname_r(descriptor_, name.data(), name.size()) != 0)
    fail("pseudo-terminal");
  name_ = name.data();
  // The modes belong to the terminal, which lasts as long as this end is open.
  const int host_end = ::open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (host_end < 0) fail(name_);
  make_raw(host_end);
  ::close(host_end);
  if (!link.empty()) {
    make_link(name_, link);
    link_ = std::move(link);
  }
}

PtyEndpoint::~PtyEndpoint() {
  std::error_code ignored;
  if (!link_.empty()) std::filesystem::remove(link_, ignored);
  ::close(descriptor_);
}

std::size_t PtyEndpoint::read(std::span<std::uint8_t> bytes) {
  if (bytes.empty()) return 0;
  const ssize_t count = ::read(descriptor_, bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

std::size_t PtyEndpoint::write(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return 0;
  const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
  return count > 0 ? static_cast<std::size_t>(count) : 0;
}

bool PtyEndpoint::host_present() {
  // The kernel reports a hang-up (POLLHUP) as long as no process has the host's end open.
  pollfd state{descriptor_, 0, 0};
  return ::poll(&state, 1, 0) <= 0 || (state.revents & POLLHUP) == 0;
}

}  // namespace lamplock::sim
