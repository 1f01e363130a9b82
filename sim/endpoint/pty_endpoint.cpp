#include "sim/endpoint/pty_endpoint.hpp"

#include <fcntl.h>
#include <sys/inotify.h>
#include <termios.h>
#include <unistd.h>
#include <cstdlib>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
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
  // With the host's side open in this process, the terminal survives the host's closing it.
  keep_open_ = ::open(name_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (keep_open_ < 0) fail(name_);
  make_raw(keep_open_);
  watch_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (watch_ < 0 || ::inotify_add_watch(watch_, name_.c_str(), IN_OPEN | IN_CLOSE) < 0) fail(name_);
  if (!link.empty()) {
    make_link(name_, link);
    link_ = std::move(link);
  }
}

PtyEndpoint::~PtyEndpoint() {
  std::error_code ignored;
  if (!link_.empty()) std::filesystem::remove(link_, ignored);
  ::close(watch_);
  ::close(keep_open_);
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
  std::array<char, 4096> events;
  for (;;) {
    const ssize_t size = ::read(watch_, events.data(), events.size());
    if (size <= 0) return open_count_ > 0;
    inotify_event event{};
    for (std::size_t at = 0; at + sizeof event <= static_cast<std::size_t>(size);
         at += sizeof event + event.len) {
      std::memcpy(&event, events.data() + at, sizeof event);
      if ((event.mask & IN_OPEN) != 0) ++open_count_;
      if ((event.mask & IN_CLOSE) != 0) open_count_ = std::max(0, open_count_ - 1);
    }
  }
}

}  // namespace lamplock::sim
