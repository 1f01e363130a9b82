#include "host/link/port_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "host/usb/sysfs.hpp"

namespace lamplock::link {
namespace {

/// Major numbers of the slave ends of pseudo-terminals (Linux, admin-guide/devices.txt).
constexpr unsigned first_pty_driver = 136, last_pty_driver = 143;

/// On a pseudo-terminal TIOCEXCL would outlive a program that dies, because the master end stays
/// open.
bool is_pseudo_terminal(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) return false;
  const unsigned driver = gnu_dev_major(status.st_rdev);
  return driver >= first_pty_driver && driver <= last_pty_driver;
}

/// Finds another process that has the device open, by the links of /proc (proc(5)).
std::string user_of(const std::string& port) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path device = usb::device_node(port);
  const std::string own = std::to_string(::getpid());
  for (fs::directory_iterator process("/proc", error), end; !error && process != end;
       process.increment(error)) {
    const std::string pid = process->path().filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos || pid == own) continue;
    std::error_code denied;
    for (fs::directory_iterator file(process->path() / "fd", denied); !denied && file != end;
         file.increment(denied)) {
      std::error_code gone;
      if (fs::read_symlink(file->path(), gone) != device) continue;
      std::string name;
      std::getline(std::ifstream(process->path() / "comm"), name);
      return fmt::format("pid {}, {}", pid, name);
    }
  }
  return "unknown";
}

}  // namespace

bool PortLock::take(const std::string& port) {
  release();
  user_.clear();
  descriptor_ = ::open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  failure_ = descriptor_ < 0 ? errno : 0;
  const bool excluded = failure_ == EBUSY;
  if (failure_ == 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) failure_ = errno;
  if (excluded || failure_ == EWOULDBLOCK) user_ = user_of(port);
  if (failure_ != 0) {
    release();
    return false;
  }
  return true;
}

void PortLock::refuse_others() {
  if (descriptor_ < 0 || is_pseudo_terminal(descriptor_)) return;
  refuses_ = ::ioctl(descriptor_, TIOCEXCL, nullptr) == 0;
}

void PortLock::release() {
  if (descriptor_ < 0) return;
  if (refuses_) ::ioctl(descriptor_, TIOCNXCL, nullptr);
  refuses_ = false;
  ::close(descriptor_);
  descriptor_ = -1;
}

}  // namespace lamplock::link
