#include "host/usb/libusb_bus.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <thread>
#include <utility>

#include "host/access.hpp"
#include "host/error.hpp"
#include "host/usb/libusb_stream.hpp"

namespace lamplock::usb {
namespace {

using Milliseconds = std::chrono::milliseconds;
using Context = std::shared_ptr<libusb_context>;

/// For libusb 0 means no time-out.
unsigned timeout(Milliseconds time) {
  return static_cast<unsigned>(
      std::clamp<std::int64_t>(time.count(), 1, std::numeric_limits<int>::max()));
}

TransferEnd end_of(int result) {
  switch (result) {
    case LIBUSB_ERROR_TIMEOUT:
      return TransferEnd::timed_out;
    case LIBUSB_ERROR_PIPE:
      return TransferEnd::stalled;
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return TransferEnd::gone;
    case LIBUSB_ERROR_OVERFLOW:
      return TransferEnd::overflow;
    default:
      return result < 0 ? TransferEnd::failed : TransferEnd::done;
  }
}

/// An open handle. libusb accepts no const data to send, but does not change them.
class LibusbDevice final : public Device {
 public:
  LibusbDevice(Context context, libusb_device_handle* handle)
      : context_(std::move(context)), handle_(handle) {}
  ~LibusbDevice() override {
    for (const std::uint8_t number : claimed_) libusb_release_interface(handle_, number);
    libusb_close(handle_);
  }
  LibusbDevice(const LibusbDevice&) = delete;
  LibusbDevice& operator=(const LibusbDevice&) = delete;

  TransferEnd claim(std::uint8_t interface_number) override {
    const TransferEnd end = end_of(libusb_claim_interface(handle_, interface_number));
    if (end == TransferEnd::done) claimed_.push_back(interface_number);
    return end;
  }

  Transfer control(const Setup& setup, std::span<std::uint8_t> data, Milliseconds time) override {
    const int result = libusb_control_transfer(
        handle_, setup.type, setup.request, setup.value, setup.index, data.data(),
        static_cast<std::uint16_t>(data.size()), timeout(time));
    return {end_of(result), static_cast<std::size_t>(std::max(result, 0))};
  }

  Transfer bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                    Milliseconds time) override {
    return bulk(endpoint, const_cast<std::uint8_t*>(bytes.data()), bytes.size(), time);
  }
  Transfer bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                   Milliseconds time) override {
    return bulk(endpoint, bytes.data(), bytes.size(), time);
  }
  TransferEnd clear_halt(std::uint8_t endpoint) override {
    return end_of(libusb_clear_halt(handle_, endpoint));
  }
  std::unique_ptr<Stream> stream(std::uint8_t out_endpoint, std::uint8_t in_endpoint) override {
    return make_libusb_stream(context_.get(), handle_, out_endpoint, in_endpoint);
  }

 private:
  Transfer bulk(std::uint8_t endpoint, std::uint8_t* bytes, std::size_t size, Milliseconds time) {
    int moved = 0;
    const int result = libusb_bulk_transfer(handle_, endpoint, bytes, static_cast<int>(size),
                                            &moved, timeout(time));
    return {end_of(result), static_cast<std::size_t>(std::max(moved, 0))};
  }

  Context context_;
  libusb_device_handle* handle_;
  std::vector<std::uint8_t> claimed_;
};

/// "1-4.2", the kernel's name; root hubs are "usb1".
std::string place_of(libusb_device* device) {
  constexpr int max_ports = 7;  // USB 3.2, 10.16.2.8: five hubs in series, and margin
  std::array<std::uint8_t, max_ports> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), max_ports);
  const unsigned bus = libusb_get_bus_number(device);
  if (count <= 0) return fmt::format("usb{}", bus);
  std::string place = fmt::format("{}-{}", bus, ports[0]);
  for (int i = 1; i < count; ++i) place += fmt::format(".{}", ports[static_cast<std::size_t>(i)]);
  return place;
}

/// The device's node on Linux.
std::string node_of(libusb_device* device) {
  return fmt::format("/dev/bus/usb/{:03}/{:03}", libusb_get_bus_number(device),
                     libusb_get_device_address(device));
}

Interface interface_of(const libusb_interface_descriptor& from) {
  Interface interface {
    from.bInterfaceNumber, from.bInterfaceClass, from.bInterfaceSubClass, from.bInterfaceProtocol,
    {}
  };
  constexpr unsigned kind_mask = 3, size_mask = 0x7ff;  // USB 2.0, table 9-13
  interface.endpoints.reserve(from.bNumEndpoints);
  for (std::size_t i = 0; i < from.bNumEndpoints; ++i) {
    const libusb_endpoint_descriptor& endpoint = from.endpoint[i];
    interface.endpoints.push_back(
        {endpoint.bEndpointAddress, static_cast<Endpoint::Kind>(endpoint.bmAttributes & kind_mask),
         static_cast<std::uint16_t>(endpoint.wMaxPacketSize & size_mask)});
  }
  return interface;
}

std::vector<Interface> interfaces_of(libusb_device* device) {
  libusb_config_descriptor* configuration = nullptr;
  if (libusb_get_active_config_descriptor(device, &configuration) != LIBUSB_SUCCESS) return {};
  std::vector<Interface> interfaces;
  interfaces.reserve(configuration->bNumInterfaces);
  for (std::size_t i = 0; i < configuration->bNumInterfaces; ++i)
    if (const libusb_interface& all = configuration->interface[i]; all.num_altsetting > 0)
      interfaces.push_back(interface_of(all.altsetting[0]));
  libusb_free_config_descriptor(configuration);
  return interfaces;
}

/// The list of the present devices, freed at the end.
class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) {
    if (context != nullptr) count_ = libusb_get_device_list(context, &devices_);
  }
  ~DeviceList() {
    constexpr int with_devices = 1;
    if (devices_ != nullptr) libusb_free_device_list(devices_, with_devices);
  }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;

  std::span<libusb_device* const> all() const {
    return {devices_, static_cast<std::size_t>(std::max<ssize_t>(count_, 0))};
  }

 private:
  libusb_device** devices_ = nullptr;
  ssize_t count_ = 0;
};

[[noreturn]] void fail_open(const DeviceInfo& info, const AccessProblem& problem) {
  const std::string where = fmt::format("USB device {}", info.place);
  if (problem) throw Error(Exit::no_device, where, problem.what, problem.remedy);
  throw Error(Exit::no_device, where, "was unplugged", "plug it in again");
}

}  // namespace

LibusbBus::LibusbBus() {
  libusb_context* context = nullptr;
  if (libusb_init(&context) == LIBUSB_SUCCESS) context_ = Context(context, libusb_exit);
}

std::vector<DeviceInfo> LibusbBus::devices() {
  std::vector<DeviceInfo> found;
  const DeviceList list(context_.get());
  for (libusb_device* device : list.all()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) continue;
    DeviceInfo info;
    info.vendor = descriptor.idVendor;
    info.product = descriptor.idProduct;
    info.version_bcd = descriptor.bcdDevice;
    info.place = place_of(device);
    info.interfaces = interfaces_of(device);
    info.manufacturer = sysfs_.text(info.place, "manufacturer");
    info.name = sysfs_.text(info.place, "product");
    info.serial = sysfs_.text(info.place, "serial");
    info.problem = access_problem(node_of(device)).text();
    found.push_back(std::move(info));
  }
  std::sort(found.begin(), found.end(),
            [](const DeviceInfo& a, const DeviceInfo& b) { return a.place < b.place; });
  return found;
}

std::unique_ptr<Device> LibusbBus::open(const DeviceInfo& info) {
  const DeviceList list(context_.get());
  for (libusb_device* device : list.all()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS ||
        descriptor.idVendor != info.vendor || descriptor.idProduct != info.product ||
        place_of(device) != info.place)
      continue;
    libusb_device_handle* handle = nullptr;
    if (libusb_open(device, &handle) != LIBUSB_SUCCESS)
      fail_open(info, access_problem(node_of(device)));
    return std::make_unique<LibusbDevice>(context_, handle);
  }
  fail_open(info, {});
}

void LibusbBus::sleep(Milliseconds time) { std::this_thread::sleep_for(time); }

Milliseconds LibusbBus::now() {
  return std::chrono::duration_cast<Milliseconds>(
      std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace lamplock::usb
