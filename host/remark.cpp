#include "host/remark.hpp"

#include <poll.h>

namespace lamplock {

bool takes_text(std::FILE* stream) noexcept {
  // Linux reports a pipe as writable when a write of PIPE_BUF (4096) bytes does not wait.
  pollfd watched{::fileno(stream), POLLOUT, 0};
  return ::poll(&watched, 1, 0) != 0;
}

void write_remark(std::string_view text) noexcept {
  if (!takes_text(stderr)) return;
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace lamplock
