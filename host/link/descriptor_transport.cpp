#include "host/link/descriptor_transport.hpp"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <ctime>
#include <thread>

namespace lamplock::link {
namespace {

bool try_later(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

std::size_t DescriptorTransport::write(std::span<const std::uint8_t> bytes) {
  if (!connected_ || bytes.empty()) return 0;
  const ssize_t count = ::write(descriptor(), bytes.data(), bytes.size());
  if (count >= 0) return static_cast<std::size_t>(count);
  if (!try_later(errno)) connected_ = false;
  return 0;
}

std::size_t DescriptorTransport::read(std::span<std::uint8_t> bytes) {
  if (!connected_ || bytes.empty()) return 0;
  const ssize_t count = ::read(descriptor(), bytes.data(), bytes.size());
  if (count > 0) return static_cast<std::size_t>(count);
  // read() reports missing data as an error (EAGAIN), the end of the connection as 0.
  if (count == 0 || !try_later(errno)) connected_ = false;
  return 0;
}

void DescriptorTransport::wait(std::chrono::microseconds time) {
  if (!connected_) {
    std::this_thread::sleep_for(time);
    return;
  }
  pollfd watched{descriptor(), POLLIN, 0};
  constexpr std::int64_t us_per_s = 1'000'000;
  constexpr std::int64_t ns_per_us = 1'000;
  const timespec limit{static_cast<time_t>(time.count() / us_per_s),
                       static_cast<long>(time.count() % us_per_s * ns_per_us)};
  ::ppoll(&watched, 1, &limit, nullptr);
}

std::chrono::microseconds DescriptorTransport::now() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(
      std::chrono::steady_clock::now().time_since_epoch());
}

bool DescriptorTransport::reconnect() {
  close();
  connected_ = open();
  return connected_;
}

}  // namespace lamplock::link
