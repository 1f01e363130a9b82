#include "tests/usb/loader_calls.hpp"

#include <sys/ioctl.h>

#include <algorithm>
#include <cerrno>
#include <span>

namespace lamplock::usb::test {
namespace {

constexpr std::chrono::milliseconds no_time{0};

/// The kernel's status of a transfer (USB error codes of its documentation).
int status_of(TransferEnd end) {
  switch (end) {
    case TransferEnd::done:
      return 0;
    case TransferEnd::stalled:
      return -EPIPE;
    case TransferEnd::gone:
      return -ENODEV;
    case TransferEnd::overflow:
      return -EOVERFLOW;
    default:
      return -EIO;
  }
}

}  // namespace

void LoaderCalls::submit(usbdevfs_urb& urb) {
  constexpr int setup_size = 8;
  auto* const bytes = static_cast<std::uint8_t*>(urb.buffer);
  Transfer moved;
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    const auto half = [&](int at) {
      return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
    };
    moved = model_.control(
        {bytes[0], bytes[1], half(2), half(4)},
        {bytes + setup_size, static_cast<std::size_t>(urb.buffer_length - setup_size)}, no_time);
  } else {
    const std::span<std::uint8_t> data(bytes, static_cast<std::size_t>(urb.buffer_length));
    moved = (urb.endpoint & direction_in) != 0 ? model_.bulk_in(urb.endpoint, data, no_time)
                                               : model_.bulk_out(urb.endpoint, data, no_time);
  }
  urb.actual_length = static_cast<int>(moved.size);
  urb.status = status_of(moved.end);
  (moved.end == TransferEnd::timed_out ? waiting_ : done_).push_back(&urb);
}

std::optional<int> LoaderCalls::call(unsigned long request, void* argument) {
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = USBDEVFS_CAP_BULK_CONTINUATION |
                                               USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                               USBDEVFS_CAP_ZERO_PACKET;
      return 0;
    case USBDEVFS_CLAIMINTERFACE:
      return model_.claim(0) == TransferEnd::done ? 0 : EBUSY;
    case USBDEVFS_RELEASEINTERFACE:
      return 0;
    case USBDEVFS_CLEAR_HALT:
      model_.clear_halt(static_cast<std::uint8_t>(*static_cast<unsigned*>(argument)));
      return 0;
    case USBDEVFS_SUBMITURB:
      if (model_.gone()) return ENODEV;
      submit(*static_cast<usbdevfs_urb*>(argument));
      return 0;
    case USBDEVFS_REAPURBNDELAY:
      if (done_.empty()) return EAGAIN;
      *static_cast<void**>(argument) = done_.front();
      done_.pop_front();
      return 0;
    case USBDEVFS_DISCARDURB: {
      const auto found = std::find(waiting_.begin(), waiting_.end(), argument);
      if (found == waiting_.end()) return EINVAL;
      (*found)->status = -ENOENT;
      done_.push_back(*found);
      waiting_.erase(found);
      return 0;
    }
    default:
      return std::nullopt;
  }
}

}  // namespace lamplock::usb::test
