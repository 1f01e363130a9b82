#include "host/link/usb_serial_transport.hpp"

#include <algorithm>

#include "host/error.hpp"

namespace lamplock::link {
namespace {

constexpr std::uint8_t communications_class = 0x02, data_class = 0x0a;
constexpr std::uint8_t class_request_to_interface = 0x21, set_control_line_state = 0x22;
constexpr std::uint16_t dtr = 1;
constexpr std::chrono::milliseconds control_time{1'000};

/// The interface of a class; throws if the device has none.
const usb::Interface& interface_of(const usb::DeviceInfo& info, std::uint8_t class_code) {
  const auto found =
      std::find_if(info.interfaces.begin(), info.interfaces.end(),
                   [=](const usb::Interface& i) { return i.class_code == class_code; });
  if (found == info.interfaces.end() || (class_code == data_class && found->endpoints.size() != 2))
    throw Error(Exit::no_device, "USB device " + info.place, "has no serial port",
                "check that it runs lamplock");
  return *found;
}

bool is_in(const usb::Endpoint& endpoint) { return (endpoint.address & usb::direction_in) != 0; }

}  // namespace

UsbSerialTransport::UsbSerialTransport(usb::Bus& bus, const usb::DeviceInfo& info)
    : bus_(bus), device_(bus.open(info)) {
  const usb::Interface& control = interface_of(info, communications_class);
  const usb::Interface& data = interface_of(info, data_class);
  const bool first_in = is_in(data.endpoints[0]);
  if (device_->claim(control.number) != usb::TransferEnd::done ||
      device_->claim(data.number) != usb::TransferEnd::done ||
      !device_
           ->control({class_request_to_interface, set_control_line_state, dtr, control.number}, {},
                     control_time)
           .done())
    throw Error(Exit::no_device, "USB device " + info.place, "its serial port cannot be opened",
                "end other programs that use it");
  stream_ = device_->stream(data.endpoints[first_in ? 1 : 0].address,
                            data.endpoints[first_in ? 0 : 1].address);
}

}  // namespace lamplock::link
