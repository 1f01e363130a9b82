#include "tests/usb/bulk_device.hpp"

#include <pty.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <stdexcept>

#include "host/usb/usb.hpp"

namespace lamplock::usb::test {
namespace {

constexpr std::size_t packet_size = 64;

bool is_in(const usbdevfs_urb& urb) { return (urb.endpoint & direction_in) != 0; }

}  // namespace

BulkDevice::BulkDevice() {
  // The session leader that opens a terminal is signalled when it hangs up.
  std::signal(SIGHUP, SIG_IGN);
  termios raw{};
  ::cfmakeraw(&raw);
  std::array<char, 256> name{};
  if (::openpty(&master_, &terminal_, name.data(), &raw, nullptr) != 0)
    throw std::runtime_error("no terminal");
  node_ = name.data();
  show_readiness();
}

BulkDevice::~BulkDevice() {
  if (master_ >= 0) ::close(master_);
  ::close(terminal_);
}

void BulkDevice::show_readiness() { ::tcflow(terminal_, done_.empty() ? TCOOFF : TCOON); }

std::optional<int> BulkDevice::call(unsigned long request, void* argument) {
  const std::lock_guard lock(mutex_);
  const auto result = call_locked(request, argument);
  show_readiness();
  return result;
}

std::optional<int> BulkDevice::call_locked(unsigned long request, void* argument) {
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) =
          USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
          USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
      return 0;
    case USBDEVFS_CLAIMINTERFACE:
      if (gone_) return ENODEV;
      if (busy_) return EBUSY;
      claimed_ = true;
      return 0;
    case USBDEVFS_RELEASEINTERFACE:
      claimed_ = false;
      return gone_ ? ENODEV : 0;
    case USBDEVFS_SUBMITURB:
      return submit(*static_cast<usbdevfs_urb*>(argument));
    case USBDEVFS_REAPURBNDELAY:
      return reap(static_cast<void**>(argument));
    case USBDEVFS_DISCARDURB:
      return discard(argument);
    default:
      return std::nullopt;
  }
}

int BulkDevice::submit(usbdevfs_urb& urb) {
  if (gone_) return ENODEV;
  if (!claimed_ || urb.type != USBDEVFS_URB_TYPE_BULK) return EINVAL;
  urb.actual_length = 0;
  Urbs& queue = is_in(urb) ? in_ : out_;
  queue.push_back(&urb);
  const int status = is_in(urb) ? in_status_ : out_status_;
  if (status != 0) finish(queue, queue.end() - 1, status);
  return 0;
}

int BulkDevice::reap(void** place) {
  if (done_.empty()) {
    ++polls_;
    return gone_ ? ENODEV : EAGAIN;
  }
  *place = done_.front();
  done_.pop_front();
  return 0;
}

int BulkDevice::discard(const void* urb) {
  for (Urbs* const queue : {&in_, &out_}) {
    const auto found = std::find(queue->begin(), queue->end(), urb);
    if (found == queue->end()) continue;
    finish(*queue, found, -ENOENT);
    return 0;
  }
  return EINVAL;
}

void BulkDevice::finish(Urbs& from, Urbs::iterator at, int status) {
  usbdevfs_urb* const urb = *at;
  if (!is_in(*urb) && at == from.begin()) taken_ = 0;
  urb->status = status;
  done_.push_back(urb);
  from.erase(at);
}

void BulkDevice::finish_all(int status) {
  for (Urbs* const queue : {&in_, &out_})
    while (!queue->empty()) finish(*queue, queue->begin(), status);
}

std::size_t BulkDevice::take(std::span<std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  std::size_t count = 0;
  while (count < bytes.size() && !out_.empty()) {
    usbdevfs_urb& urb = *out_.front();
    const auto length = static_cast<std::size_t>(urb.buffer_length);
    const std::size_t piece = std::min(bytes.size() - count, length - taken_);
    std::copy_n(static_cast<const std::uint8_t*>(urb.buffer) + taken_, piece,
                bytes.begin() + static_cast<std::ptrdiff_t>(count));
    count += piece;
    taken_ += piece;
    urb.actual_length = static_cast<int>(taken_);
    if (taken_ == length) finish(out_, out_.begin(), 0);
  }
  show_readiness();
  return count;
}

/// False if no transfer waits for the packet.
bool BulkDevice::give_packet(std::span<const std::uint8_t> packet) {
  if (in_.empty()) return false;
  usbdevfs_urb& urb = *in_.front();
  std::copy(packet.begin(), packet.end(),
            static_cast<std::uint8_t*>(urb.buffer) + urb.actual_length);
  urb.actual_length += static_cast<int>(packet.size());
  if (packet.size() < packet_size || urb.actual_length == urb.buffer_length)
    finish(in_, in_.begin(), 0);
  empty_packet_due_ = packet.size() == packet_size;
  return true;
}

std::size_t BulkDevice::give(std::span<const std::uint8_t> bytes) {
  const std::lock_guard lock(mutex_);
  std::size_t count = 0;
  while (count < bytes.size()) {
    const auto packet = bytes.subspan(count, std::min(packet_size, bytes.size() - count));
    if (!give_packet(packet)) break;
    count += packet.size();
  }
  if (count == bytes.size() && empty_packet_due_) give_packet({});
  show_readiness();
  return count;
}

void BulkDevice::halt(bool in, int status) {
  const std::lock_guard lock(mutex_);
  (in ? in_status_ : out_status_) = status;
  Urbs& queue = in ? in_ : out_;
  if (status != 0)
    while (!queue.empty()) finish(queue, queue.begin(), status);
  show_readiness();
}

void BulkDevice::fail(int status) {
  halt(true, status);
  halt(false, status);
}

void BulkDevice::unplug(int status) {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  claimed_ = false;
  finish_all(status);
  ::close(master_);
  master_ = -1;
}

void BulkDevice::set_busy(bool busy) {
  const std::lock_guard lock(mutex_);
  busy_ = busy;
}

std::size_t BulkDevice::waiting_in() const {
  const std::lock_guard lock(mutex_);
  return in_.size();
}
std::size_t BulkDevice::waiting_out() const {
  const std::lock_guard lock(mutex_);
  return out_.size();
}
std::size_t BulkDevice::owed() const {
  const std::lock_guard lock(mutex_);
  return in_.size() + out_.size() + done_.size();
}
bool BulkDevice::claimed() const {
  const std::lock_guard lock(mutex_);
  return claimed_;
}
std::size_t BulkDevice::polls() const {
  const std::lock_guard lock(mutex_);
  return polls_;
}

}  // namespace lamplock::usb::test
