#include "host/usb/libusb_stream.hpp"

#include <algorithm>
#include <array>
#include <deque>

namespace lamplock::usb {
namespace {

using Clock = std::chrono::steady_clock;

/// Whole packets of 64 bytes. One transfer holds an answer of a board (some 250 bytes); four of
/// them last for some milliseconds at full speed (1.2 MB/s) during which the program does not read.
constexpr std::size_t in_size = 1024;
constexpr std::size_t in_count = 4;
/// 4 KiB under way: 4 ms at full speed.
constexpr std::size_t out_size = 1024;
constexpr std::size_t out_count = 4;
/// Bytes received and not read, after which the device must wait.
constexpr std::size_t max_received = std::size_t{1} << 16;
/// The kernel returns cancelled transfers at once, unless it has a fault.
constexpr std::chrono::seconds max_end_time{2};
/// Accepted bytes are still sent, for they may end with a hold or reset: a board receives them
/// within ms, unless the computer is busy.
constexpr std::chrono::milliseconds max_farewell_time{500};

timeval to_timeval(std::chrono::microseconds time) {
  constexpr std::int64_t us_per_s = 1'000'000;
  const std::int64_t us = std::max<std::int64_t>(time.count(), 0);
  return {static_cast<time_t>(us / us_per_s), static_cast<suseconds_t>(us % us_per_s)};
}

class LibusbStream final : public Stream {
 public:
  LibusbStream(libusb_context* context, libusb_device_handle* handle, std::uint8_t out_endpoint,
               std::uint8_t in_endpoint)
      : context_(context) {
    for (Slot& slot : in_) prepare(slot, handle, in_endpoint, in_size, &LibusbStream::on_in);
    for (Slot& slot : out_) prepare(slot, handle, out_endpoint, out_size, &LibusbStream::on_out);
    for (Slot& slot : in_) submit(slot, in_size);
  }

  ~LibusbStream() override {
    const auto busy = [](const Slot& slot) { return slot.busy; };
    const Clock::time_point sent_by = Clock::now() + max_farewell_time;
    while (alive_ && std::any_of(out_.begin(), out_.end(), busy) && Clock::now() < sent_by)
      handle_events(std::chrono::milliseconds(10));
    alive_ = false;
    const auto cancel = [](Slot& slot) {
      if (slot.busy) libusb_cancel_transfer(slot.transfer);
    };
    std::for_each(in_.begin(), in_.end(), cancel);
    std::for_each(out_.begin(), out_.end(), cancel);
    const Clock::time_point end = Clock::now() + max_end_time;
    while (any_busy() && Clock::now() < end) handle_events(std::chrono::milliseconds(10));
    const auto release = [](Slot& slot) {
      // A transfer that was not returned still belongs to the kernel: it is leaked, not freed.
      if (slot.busy) {
        slot.transfer->user_data = nullptr;
        static_cast<void>(slot.bytes.release());
      } else {
        libusb_free_transfer(slot.transfer);
      }
    };
    std::for_each(in_.begin(), in_.end(), release);
    std::for_each(out_.begin(), out_.end(), release);
  }
  LibusbStream(const LibusbStream&) = delete;
  LibusbStream& operator=(const LibusbStream&) = delete;

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    handle_events({});
    std::size_t taken = 0;
    for (Slot& slot : out_) {
      if (taken == bytes.size() || !alive_) break;
      if (slot.busy) continue;
      const std::size_t size = std::min(bytes.size() - taken, out_size);
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(taken), size, slot.bytes.get());
      if (submit(slot, size)) taken += size;
    }
    return taken;
  }

  std::size_t read(std::span<std::uint8_t> bytes) override {
    handle_events({});
    const std::size_t count = std::min(bytes.size(), received_.size());
    std::copy_n(received_.begin(), count, bytes.begin());
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(count));
    ask_again();
    return count;
  }

  void wait(std::chrono::microseconds time) override {
    const Clock::time_point end = Clock::now() + time;
    handle_events({});
    while (received_.empty() && alive_) {
      const auto left = std::chrono::duration_cast<std::chrono::microseconds>(end - Clock::now());
      if (left.count() <= 0) return;
      handle_events(left);
    }
  }

  bool alive() const override { return alive_; }

 private:
  /// A transfer and its buffer.
  struct Slot {
    libusb_transfer* transfer = nullptr;
    std::unique_ptr<std::uint8_t[]> bytes{};
    bool busy = false;
    LibusbStream* owner = nullptr;
  };

  void prepare(Slot& slot, libusb_device_handle* handle, std::uint8_t endpoint, std::size_t size,
               libusb_transfer_cb_fn callback) {
    constexpr unsigned for_ever = 0;
    slot.transfer = libusb_alloc_transfer(0);
    slot.bytes = std::make_unique<std::uint8_t[]>(size);
    slot.owner = this;
    if (slot.transfer == nullptr)
      alive_ = false;
    else
      libusb_fill_bulk_transfer(slot.transfer, handle, endpoint, slot.bytes.get(), 0, callback,
                                &slot, for_ever);
  }

  bool submit(Slot& slot, std::size_t size) {
    if (!alive_) return false;
    slot.transfer->length = static_cast<int>(size);
    slot.busy = libusb_submit_transfer(slot.transfer) == LIBUSB_SUCCESS;
    alive_ = slot.busy;
    return slot.busy;
  }

  /// Submits transfers in their order, which is that of the bytes.
  void ask_again() {
    for (Slot& slot : in_)
      if (!slot.busy && alive_ && received_.size() < max_received) submit(slot, in_size);
  }

  static void LIBUSB_CALL on_in(libusb_transfer* transfer) {
    Slot* const slot = static_cast<Slot*>(transfer->user_data);
    if (slot == nullptr) return;
    slot->busy = false;
    slot->owner->received_.insert(slot->owner->received_.end(), transfer->buffer,
                                  transfer->buffer + transfer->actual_length);
    slot->owner->judge(*transfer);
    slot->owner->ask_again();
  }
  static void LIBUSB_CALL on_out(libusb_transfer* transfer) {
    Slot* const slot = static_cast<Slot*>(transfer->user_data);
    if (slot == nullptr) return;
    slot->busy = false;
    slot->owner->judge(*transfer);
    // libusb reports a transfer that the kernel has cancelled as completed.
    if (transfer->actual_length < transfer->length) slot->owner->alive_ = false;
  }
  /// Any failure ends the stream: unplugged, stalled, failed.
  void judge(const libusb_transfer& transfer) {
    if (transfer.status != LIBUSB_TRANSFER_COMPLETED) alive_ = false;
  }

  void handle_events(std::chrono::microseconds time) {
    timeval limit = to_timeval(time);
    const int result = libusb_handle_events_timeout_completed(context_, &limit, nullptr);
    if (result != LIBUSB_SUCCESS && result != LIBUSB_ERROR_INTERRUPTED) alive_ = false;
  }

  bool any_busy() const {
    const auto busy = [](const Slot& slot) { return slot.busy; };
    return std::any_of(in_.begin(), in_.end(), busy) || std::any_of(out_.begin(), out_.end(), busy);
  }

  libusb_context* context_;
  std::array<Slot, in_count> in_{};
  std::array<Slot, out_count> out_{};
  std::deque<std::uint8_t> received_;
  bool alive_ = true;
};

}  // namespace

std::unique_ptr<Stream> make_libusb_stream(libusb_context* context, libusb_device_handle* handle,
                                           std::uint8_t out_endpoint, std::uint8_t in_endpoint) {
  return std::make_unique<LibusbStream>(context, handle, out_endpoint, in_endpoint);
}

}  // namespace lamplock::usb
