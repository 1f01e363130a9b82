#include "host/usb/simulated_usb.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

#include "host/error.hpp"
#include "sim/chip/usb_host/descriptors.hpp"

namespace lamplock::usb {
namespace {

using Milliseconds = std::chrono::milliseconds;
using sim::chip::VendorHost;
using Bytes = VendorHost::Bytes;
namespace descriptor = sim::chip::usb::descriptor;

sim::Picoseconds picoseconds(std::chrono::microseconds time) {
  return time.count() * sim::ps_per_us;
}

std::uint16_t half(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
}
std::uint8_t low(std::size_t value) { return static_cast<std::uint8_t>(value & 0xff); }
std::uint8_t high(std::size_t value) { return static_cast<std::uint8_t>(value >> 8 & 0xff); }

/// Interfaces of a configuration descriptor without alternate settings (USB 2.0, 9.6).
std::vector<Interface> interfaces_of(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t interface_size = 9, endpoint_size = 7;
  std::vector<Interface> found;
  bool first_setting = false;
  for (std::size_t at = 0; at + 2 <= bytes.size() && bytes[at] >= 2; at += bytes[at]) {
    const auto rest = bytes.subspan(at);
    if (rest[1] == descriptor::interface && rest.size() >= interface_size) {
      first_setting = rest[3] == 0;
      if (first_setting) found.push_back({rest[2], rest[5], rest[6], rest[7], {}});
    } else if (rest[1] == descriptor::endpoint && rest.size() >= endpoint_size && first_setting) {
      found.back().endpoints.push_back(
          {rest[2], static_cast<Endpoint::Kind>(rest[3] & 3u), half(rest, 4)});
    }
  }
  return found;
}

/// The device until it restarts: after a restart it is another one.
class SimulatedDevice final : public Device {
 public:
  explicit SimulatedDevice(VendorHost& host) : host_(host), departures_(host.departures()) {}

  TransferEnd claim(std::uint8_t) override {
    return here() ? TransferEnd::done : TransferEnd::gone;
  }
  Transfer control(const Setup& setup, std::span<std::uint8_t> data, Milliseconds) override;
  Transfer bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                    Milliseconds time) override;
  Transfer bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                   Milliseconds time) override;
  TransferEnd clear_halt(std::uint8_t endpoint) override {
    if (!here()) return TransferEnd::gone;
    return host_.clear_halt(endpoint) ? TransferEnd::done : TransferEnd::failed;
  }
  std::unique_ptr<Stream> stream(std::uint8_t out_endpoint, std::uint8_t in_endpoint) override;

  bool here() const { return host_.connected() && host_.departures() == departures_; }
  void pass(std::chrono::microseconds time) { host_.wait(picoseconds(time)); }

 private:
  TransferEnd end_of(VendorHost::End end) const {
    if (end == VendorHost::End::done) return TransferEnd::done;
    if (!here()) return TransferEnd::gone;
    if (end == VendorHost::End::stalled) return TransferEnd::stalled;
    return end == VendorHost::End::timed_out ? TransferEnd::timed_out : TransferEnd::failed;
  }

  VendorHost& host_;
  std::uint64_t departures_;
};

/// On the wire an endpoint's number has no direction bit.
std::uint8_t number_of(std::uint8_t endpoint) {
  return static_cast<std::uint8_t>(endpoint & ~direction_in);
}

Transfer SimulatedDevice::control(const Setup& setup, std::span<std::uint8_t> data, Milliseconds) {
  if (!here()) return {TransferEnd::gone, 0};
  const std::array<std::uint8_t, 8> packet = {
      setup.type,       setup.request,     low(setup.value), high(setup.value),
      low(setup.index), high(setup.index), low(data.size()), high(data.size())};
  const VendorHost::Transfer moved = host_.control(packet, data);
  std::copy_n(moved.data.begin(), std::min(moved.data.size(), data.size()), data.begin());
  return {end_of(moved.end), moved.moved};
}

Transfer SimulatedDevice::bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                                   Milliseconds time) {
  if (!here()) return {TransferEnd::gone, 0};
  host_.set_timeout(picoseconds(time));
  const VendorHost::Transfer moved = host_.bulk_out(number_of(endpoint), bytes);
  return {end_of(moved.end), moved.moved};
}

Transfer SimulatedDevice::bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                                  Milliseconds time) {
  if (!here()) return {TransferEnd::gone, 0};
  host_.set_timeout(picoseconds(time));
  const VendorHost::Transfer moved = host_.bulk_in(number_of(endpoint), bytes.size());
  const std::size_t size = std::min(moved.data.size(), bytes.size());
  std::copy_n(moved.data.begin(), size, bytes.begin());
  if (moved.data.size() > bytes.size()) return {TransferEnd::overflow, size};
  return {end_of(moved.end), size};
}

/// One transfer at a time: a simulated bus does not run while the host computes.
class SimulatedStream final : public Stream {
 public:
  SimulatedStream(SimulatedDevice& device, std::uint8_t out, std::uint8_t in)
      : device_(device), out_(out), in_(in) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (bytes.empty()) return 0;
    const Transfer moved = device_.bulk_out(out_, bytes, patience);
    judge(moved.end);
    return moved.size;
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    const std::size_t size = std::min(bytes.size(), received_.size());
    const auto end = received_.begin() + static_cast<std::ptrdiff_t>(size);
    std::copy(received_.begin(), end, bytes.begin());
    received_.erase(received_.begin(), end);
    return size;
  }
  void wait(std::chrono::microseconds time) override {
    if (!received_.empty() || !alive()) return;
    std::array<std::uint8_t, packet_size> packet{};
    const auto milliseconds = std::chrono::ceil<Milliseconds>(time);
    const Transfer moved = device_.bulk_in(in_, packet, milliseconds);
    judge(moved.end);
    received_.insert(received_.end(), packet.begin(),
                     packet.begin() + static_cast<std::ptrdiff_t>(moved.size));
  }
  bool alive() const override { return !failed_ && device_.here(); }

 private:
  static constexpr Milliseconds patience{1};
  static constexpr std::size_t packet_size = 64;
  void judge(TransferEnd end) {
    if (end != TransferEnd::done && end != TransferEnd::timed_out) failed_ = true;
  }

  SimulatedDevice& device_;
  std::uint8_t out_, in_;
  std::deque<std::uint8_t> received_;
  bool failed_ = false;
};

std::unique_ptr<Stream> SimulatedDevice::stream(std::uint8_t out_endpoint,
                                                std::uint8_t in_endpoint) {
  return std::make_unique<SimulatedStream>(*this, out_endpoint, in_endpoint);
}

}  // namespace

SimulatedUsb::SimulatedUsb(sim::chip::Chip& chip)
    : SimulatedUsb(chip, [&chip](sim::chip::Cycle to) { chip.run_until(to); }) {}

SimulatedUsb::SimulatedUsb(sim::chip::Chip& chip, Run run)
    : chip_(chip), host_(chip.wheel(), chip.usb(), std::move(run)) {}

/// A string descriptor, with '?' for characters other than ASCII; empty if there is none.
std::string SimulatedUsb::text(std::uint8_t index) {
  if (index == 0) return "";
  constexpr std::uint8_t get_descriptor = 6, us_english_low = 0x09, us_english_high = 0x04;
  const VendorHost::Transfer answer =
      host_.control({direction_in, get_descriptor, index, descriptor::string, us_english_low,
                     us_english_high, 255, 0});
  std::string text;
  for (std::size_t at = 2; answer.done() && at + 1 < answer.data.size(); at += 2) {
    const std::uint16_t letter = half(answer.data, at);
    text += letter < 0x80 ? static_cast<char>(letter) : '?';
  }
  return text;
}

/// Enumerates the device; false if none is plugged in.
bool SimulatedUsb::attach() {
  constexpr std::size_t device_size = 18;
  if (device_ && host_.departures() == departures_ && host_.connected()) return true;
  device_.reset();
  if (!host_.connected() || !host_.enumerate(0)) return false;
  const Bytes& bytes = host_.device_descriptor();
  if (bytes.size() < device_size) return false;
  departures_ = host_.departures();
  DeviceInfo info;
  info.vendor = half(bytes, 8);
  info.product = half(bytes, 10);
  info.version_bcd = half(bytes, 12);
  info.place = place;
  info.interfaces = interfaces_of(host_.configuration_descriptor());
  info.manufacturer = text(bytes[14]);
  info.name = text(bytes[15]);
  info.serial = text(bytes[16]);
  device_ = info;
  return true;
}

std::vector<DeviceInfo> SimulatedUsb::devices() {
  if (!attach()) return {};
  return {*device_};
}

std::unique_ptr<Device> SimulatedUsb::open(const DeviceInfo& device) {
  if (!attach() || device.vendor != device_->vendor || device.product != device_->product)
    throw Error(Exit::no_device, "simulated USB", "the device was unplugged",
                "wait until it is back");
  return std::make_unique<SimulatedDevice>(host_);
}

void SimulatedUsb::sleep(Milliseconds time) { host_.wait(picoseconds(time)); }

Milliseconds SimulatedUsb::now() { return Milliseconds(chip_.time() / sim::ps_per_ms); }

}  // namespace lamplock::usb
