#include "sim/chip/usb_host/vendor_host.hpp"

#include <algorithm>
#include <utility>

#include "sim/chip/usb_host/descriptors.hpp"
#include "sim/chip/usb_host/usb_host.hpp"

namespace lamplock::sim::chip {

using usb::Pid;

namespace {

constexpr Picoseconds frame_time = ps_per_ms;
constexpr UsbHostOptions times{};
constexpr Picoseconds control_timeout = 5 * ps_per_s;  // USB 2.0, 9.2.6.1
constexpr int attempts = 3;                            ///< at a transaction without an answer
constexpr std::uint8_t to_host = 0x80;
constexpr std::uint8_t own_address = 1;

}  // namespace

VendorHost::VendorHost(TimeWheel& wheel, usb::DeviceEnd& device, std::function<void(Cycle)> run)
    : wheel_(wheel), device_(device), run_(std::move(run)), engine_(wheel, device) {
  engine_.on_done([this](const usb::Transaction&, const usb::Result& result) { result_ = result; });
  device_.connect(this, wheel_.time());
}

VendorHost::~VendorHost() { device_.connect(nullptr, wheel_.time()); }

// --- time ---

void VendorHost::run_to(Picoseconds time) {
  while (wheel_.time() < time) run_(std::max(wheel_.cycle_at(time), wheel_.now() + 1));
}

void VendorHost::wait(Picoseconds time) {
  const Picoseconds end = wheel_.time() + time;
  while (next_frame_ >= 0 && next_frame_ <= end) {
    run_to(next_frame_);
    if (next_frame_ < 0) break;  // the device was disconnected meanwhile
    device_.start_of_frame(frame_, wheel_.time());
    frame_ = (frame_ + 1) & 0x7ff;
    next_frame_ += frame_time;
  }
  run_to(end);
}

void VendorHost::reset() {
  next_frame_ = -1;
  device_.begin_reset(wheel_.time());
  wait(times.reset);
  device_.end_reset(wheel_.time());
  next_frame_ = wheel_.time();
  wait(times.reset_recovery);
  address_ = 0;
  data1_.clear();
}

void VendorHost::pull_up_changed(bool on, Picoseconds) {
  if (on) return;
  ++departures_;
  next_frame_ = -1;
  address_ = 0;
}

// --- transactions ---

VendorHost::End VendorHost::end_of(const usb::Result& result) {
  if (!result.answer) return End::silent;
  if (*result.answer == Pid::stall) return End::stalled;
  return *result.answer == Pid::nak ? End::timed_out : End::done;
}

usb::Result VendorHost::transact(const usb::Transaction& transaction, Picoseconds timeout) {
  const Picoseconds end = wheel_.time() + timeout;
  int silences = 0;
  for (;;) {
    // A transaction must not extend over the beginning of a frame.
    const Picoseconds most = usb::bit_times(usb::transaction_bits(usb::max_packet)) * 2;
    Picoseconds at = std::max(bus_free_, wheel_.time());
    if (next_frame_ >= 0 && at + most > next_frame_) {
      wait(next_frame_ - wheel_.time());
      at = wheel_.time() + usb::bit_times(usb::token_bits + usb::gap_bits);
    }
    result_.reset();
    engine_.start(transaction, at);
    while (!result_) run_(wheel_.now() + 1 + wheel_.frequency() / 1'000'000);
    bus_free_ = result_->end;
    run_to(bus_free_);
    if (!result_->answer && ++silences < attempts) continue;
    if (result_->answer != Pid::nak || wheel_.time() >= end) return *result_;
  }
}

// --- transfers ---

VendorHost::Transfer VendorHost::bulk_out(std::uint8_t endpoint,
                                          std::span<const std::uint8_t> data) {
  Transfer transfer;
  do {
    const std::size_t size = std::min(usb::max_packet, data.size() - transfer.moved);
    usb::Transaction out{.token = Pid::out, .address = address_, .endpoint = endpoint, .data = {}};
    out.data.pid = data1_[endpoint] ? Pid::data1 : Pid::data0;
    out.data.size = size;
    std::copy_n(data.begin() + static_cast<std::ptrdiff_t>(transfer.moved), size,
                out.data.bytes.begin());
    transfer.end = end_of(transact(out, timeout_));
    if (!transfer.done()) return transfer;
    data1_[endpoint] = !data1_[endpoint];
    transfer.moved += size;
  } while (transfer.moved < data.size());
  return transfer;
}

VendorHost::Transfer VendorHost::bulk_in(std::uint8_t endpoint, std::size_t size) {
  Transfer transfer;
  bool& data1 = data1_[endpoint | to_host];
  for (;;) {
    const usb::Result result = transact(
        {.token = Pid::in, .address = address_, .endpoint = endpoint, .data = {}}, timeout_);
    transfer.end = end_of(result);
    if (!transfer.done()) return transfer;
    if (*result.answer != (data1 ? Pid::data1 : Pid::data0)) continue;  // repeated
    data1 = !data1;
    const std::span<const std::uint8_t> payload = result.data.payload();
    transfer.data.insert(transfer.data.end(), payload.begin(), payload.end());
    transfer.moved = transfer.data.size();
    if (payload.size() < usb::max_packet || transfer.moved >= size) return transfer;
  }
}

VendorHost::Transfer VendorHost::control(const std::array<std::uint8_t, 8>& setup,
                                         std::span<const std::uint8_t> data) {
  Transfer transfer;
  const auto step = [&](Pid token, bool one, std::span<const std::uint8_t> payload) {
    usb::Transaction transaction{.token = token, .address = address_, .endpoint = 0, .data = {}};
    transaction.data.pid = one ? Pid::data1 : Pid::data0;
    transaction.data.size = payload.size();
    std::copy(payload.begin(), payload.end(), transaction.data.bytes.begin());
    const usb::Result result = transact(transaction, control_timeout);
    transfer.end = end_of(result);
    return result;
  };
  step(Pid::setup, false, setup);
  if (!transfer.done()) return transfer;
  const bool in = (setup[0] & to_host) != 0;
  const auto length = static_cast<std::size_t>(setup[6] | setup[7] << 8);
  bool one = true;
  while (in && transfer.moved < length) {
    const usb::Result result = step(Pid::in, one, {});
    if (!transfer.done()) return transfer;
    one = !one;
    const std::span<const std::uint8_t> payload = result.data.payload();
    transfer.data.insert(transfer.data.end(), payload.begin(), payload.end());
    transfer.moved = transfer.data.size();
    if (payload.size() < usb::max_packet) break;
  }
  while (!in && transfer.moved < data.size()) {
    const std::size_t size = std::min(usb::max_packet, data.size() - transfer.moved);
    step(Pid::out, one, data.subspan(transfer.moved, size));
    if (!transfer.done()) return transfer;
    one = !one;
    transfer.moved += size;
  }
  // Status: an empty DATA1 the other way.
  step(in && length != 0 ? Pid::out : Pid::in, true, {});
  return transfer;
}

bool VendorHost::clear_halt(std::uint8_t endpoint) {
  constexpr std::uint8_t endpoint_recipient = 2, clear_feature = 1;
  data1_[endpoint] = false;
  return control({endpoint_recipient, clear_feature, 0, 0, endpoint, 0, 0, 0}).done();
}

// --- enumeration ---

bool VendorHost::read_descriptor(std::uint8_t type, std::size_t size, Bytes& bytes) {
  constexpr std::uint8_t get_descriptor = 6;
  const Transfer answer =
      control({to_host, get_descriptor, 0, type, 0, 0, static_cast<std::uint8_t>(size),
               static_cast<std::uint8_t>(size >> 8)});
  bytes = answer.data;
  return answer.done() && bytes.size() >= 2;
}

bool VendorHost::enumerate(Picoseconds patience) {
  namespace descriptor = usb::descriptor;
  constexpr std::uint8_t set_address = 5, set_configuration = 9;
  constexpr std::size_t device_size = 18, head_size = 9;
  next_frame_ = -1;
  for (const Picoseconds end = wheel_.time() + patience; !connected(); wait(ps_per_ms))
    if (wheel_.time() >= end) return false;
  wait(times.debounce);
  reset();
  if (!control({0, set_address, own_address, 0, 0, 0, 0, 0}).done()) return false;
  address_ = own_address;
  wait(times.address_recovery);
  if (!read_descriptor(descriptor::device, device_size, device_descriptor_)) return false;
  Bytes head;
  if (!read_descriptor(descriptor::configuration, head_size, head) || head.size() < head_size)
    return false;
  const auto size = static_cast<std::size_t>(head[2] | head[3] << 8);
  if (!read_descriptor(descriptor::configuration, size, configuration_descriptor_)) return false;
  return control({0, set_configuration, 1, 0, 0, 0, 0, 0}).done();
}

}  // namespace lamplock::sim::chip
