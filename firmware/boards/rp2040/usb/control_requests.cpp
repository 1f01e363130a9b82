#include "firmware/boards/rp2040/usb/control_requests.hpp"

#include "firmware/boards/rp2040/usb/microsoft_os.hpp"

namespace lamplock::rp2040::usb {
namespace {

// bmRequestType: direction, type and recipient (USB 2.0, table 9-2).
constexpr std::uint8_t type_mask = 0x60;
constexpr std::uint8_t type_standard = 0x00;
constexpr std::uint8_t type_class = 0x20;
constexpr std::uint8_t type_vendor = 0x40;
constexpr std::uint8_t recipient_mask = 0x1f;
constexpr std::uint8_t to_device = 0;
constexpr std::uint8_t to_interface = 1;
constexpr std::uint8_t to_endpoint = 2;

// Standard requests (USB 2.0, table 9-4).
constexpr std::uint8_t get_status = 0;
constexpr std::uint8_t clear_feature = 1;
constexpr std::uint8_t set_feature = 3;
constexpr std::uint8_t set_address_request = 5;
constexpr std::uint8_t get_descriptor = 6;
constexpr std::uint8_t get_configuration = 8;
constexpr std::uint8_t set_configuration_request = 9;
constexpr std::uint8_t get_interface = 10;
constexpr std::uint8_t set_interface = 11;

constexpr std::uint16_t feature_endpoint_halt = 0;  // USB 2.0, table 9-6
constexpr std::uint16_t max_address = 127;

// Requests of the abstract control model (PSTN 1.2, table 13).
constexpr std::uint8_t set_line_coding = 0x20;
constexpr std::uint8_t get_line_coding = 0x21;
constexpr std::uint8_t set_control_line_state = 0x22;
constexpr std::uint8_t send_break = 0x23;

constexpr Reaction stall{};
constexpr Reaction acknowledge{Answer::acknowledge, Effect::none, 0, {}};

constexpr Reaction acknowledge_with(Effect effect, Pipes pipes = 0) {
  return {Answer::acknowledge, effect, pipes, {}};
}
Reaction send(std::span<const std::uint8_t> data) { return {Answer::send, Effect::none, 0, data}; }

/// The endpoint of a request's wIndex, none if the device lacks it.
constexpr Pipes pipe_of(std::uint16_t index) {
  switch (index) {
    case data_endpoint:
      return pipe_out;
    case direction_in | data_endpoint:
      return pipe_in;
    case direction_in | notify_endpoint:
      return pipe_notify;
    case stream_endpoint:
      return pipe_stream_out;
    case direction_in | stream_endpoint:
      return pipe_stream_in;
    default:
      return 0;
  }
}

/// The endpoints of an interface.
constexpr Pipes pipes_of_interface(std::uint16_t index) {
  switch (index) {
    case control_interface:
      return pipe_notify;
    case data_interface:
      return pipe_in | pipe_out;
    default:
      return pipe_stream_in | pipe_stream_out;
  }
}

/// Windows sends it before or after it sets a configuration.
Reaction vendor_request(const SetupPacket& setup) {
  const bool asked = setup.type == (direction_in | type_vendor | to_device) &&
                     setup.request == microsoft_request && setup.value == 0 &&
                     setup.index == microsoft_set_index;
  return asked ? send(microsoft_set) : stall;
}

}  // namespace

void ControlRequests::set_serial_number(std::string_view text) {
  for (std::size_t i = 0; i < serial_number_size; ++i)
    serial_number_[2 + 2 * i] = static_cast<std::uint8_t>(i < text.size() ? text[i] : '0');
}

void ControlRequests::reset() {
  configuration_ = 0;
  address_ = 0;
  control_lines_ = 0;
  halted_ = 0;
}

Reaction ControlRequests::setup(const SetupPacket& setup) {
  const std::uint8_t recipient = setup.type & recipient_mask;
  if ((setup.type & type_mask) == type_class)
    return recipient == to_interface ? class_request(setup) : stall;
  if ((setup.type & type_mask) == type_vendor) return vendor_request(setup);
  if ((setup.type & type_mask) != type_standard) return stall;
  switch (recipient) {
    case to_device:
      return device_request(setup);
    case to_interface:
      return interface_request(setup);
    case to_endpoint:
      return endpoint_request(setup);
    default:
      return stall;
  }
}

Reaction ControlRequests::device_request(const SetupPacket& setup) {
  if (setup.to_host()) {
    switch (setup.request) {
      case get_status:
        return setup.index == 0 ? reply_status(setup, false) : stall;
      case get_descriptor:
        return descriptor(setup);
      case get_configuration:
        return setup.index == 0 ? reply_byte(setup, configuration_) : stall;
      default:
        return stall;
    }
  }
  // No feature of the device can be set: no remote wake-up, no test modes at full speed.
  switch (setup.request) {
    case set_address_request:
      return set_address(setup);
    case set_configuration_request:
      return set_configuration(setup);
    default:
      return stall;
  }
}

Reaction ControlRequests::descriptor(const SetupPacket& setup) const {
  const std::uint8_t index = low_byte(setup.value);
  switch (high_byte(setup.value)) {
    case descriptor_type::device:
      return index == 0 && setup.index == 0 ? send(device_descriptor) : stall;
    case descriptor_type::configuration:
      return index == 0 && setup.index == 0 ? send(configuration_descriptor) : stall;
    case descriptor_type::string:
      return string(setup);
    case descriptor_type::bos:
      return index == 0 && setup.index == 0 ? send(bos_descriptor) : stall;
    default:  // device qualifier and other speed: full speed only (USB 2.0, 9.6.2)
      return stall;
  }
}

Reaction ControlRequests::string(const SetupPacket& setup) const {
  const std::uint8_t index = low_byte(setup.value);
  if (index == string_index::languages) return send(language_descriptor);
  if (setup.index != language_us_english) return stall;
  switch (index) {
    case string_index::manufacturer:
      return send(manufacturer_descriptor);
    case string_index::product:
      return send(product_descriptor);
    case string_index::serial_number:
      return send(serial_number_);
    case string_index::function:
      return send(function_descriptor);
    case string_index::stream:
      return send(stream_descriptor);
    default:
      return stall;
  }
}

Reaction ControlRequests::set_address(const SetupPacket& setup) {
  const bool valid = setup.value <= max_address && setup.index == 0 && setup.length == 0;
  if (!valid || configured()) return stall;
  address_ = low_byte(setup.value);
  return acknowledge_with(Effect::use_address);
}

Reaction ControlRequests::set_configuration(const SetupPacket& setup) {
  if (setup.value > configuration_value || setup.index != 0 || setup.length != 0) return stall;
  configuration_ = low_byte(setup.value);
  halted_ = 0;
  control_lines_ = 0;
  return acknowledge_with(configured() ? Effect::configure : Effect::deconfigure);
}

Reaction ControlRequests::interface_request(const SetupPacket& setup) {
  if (!configured() || setup.index >= interface_count) return stall;
  if (setup.to_host()) {
    if (setup.request == get_status) return reply_status(setup, false);
    if (setup.request == get_interface) return reply_byte(setup, 0);
    return stall;
  }
  if (setup.request != set_interface || setup.value != 0 || setup.length != 0) return stall;
  // The setting becomes effective: toggles and halts of its endpoints start again (9.1.1.5).
  const Pipes pipes = pipes_of_interface(setup.index);
  halted_ = static_cast<Pipes>(halted_ & ~pipes);
  return acknowledge_with(Effect::restart, pipes);
}

Reaction ControlRequests::endpoint_request(const SetupPacket& setup) {
  const bool control = (setup.index & 0xff7f) == 0;
  const Pipes pipe = configured() ? pipe_of(setup.index) : Pipes{0};
  if (!control && pipe == 0) return stall;
  if (setup.to_host())
    return setup.request == get_status ? reply_status(setup, (halted_ & pipe) != 0) : stall;
  if (setup.value != feature_endpoint_halt || setup.length != 0) return stall;
  if (setup.request == clear_feature) {
    if (control) return acknowledge;  // never halted (9.4.5)
    halted_ = static_cast<Pipes>(halted_ & ~pipe);
    return acknowledge_with(Effect::restart, pipe);
  }
  if (setup.request != set_feature || control) return stall;
  halted_ = static_cast<Pipes>(halted_ | pipe);
  return acknowledge_with(Effect::halt, pipe);
}

Reaction ControlRequests::class_request(const SetupPacket& setup) {
  if (!configured() || setup.index != control_interface) return stall;
  if (setup.to_host())
    return setup.request == get_line_coding && setup.value == 0 ? send(line_coding_) : stall;
  switch (setup.request) {
    case set_line_coding:
      return setup.length == line_coding_size ? Reaction{Answer::receive, Effect::none, 0, {}}
                                              : stall;
    case set_control_line_state: {
      if (setup.length != 0) return stall;
      const bool was_open = dtr();
      control_lines_ = static_cast<std::uint8_t>(setup.value & 3);
      if (dtr() && !was_open) ++opened_;
      return acknowledge;
    }
    case send_break:
      return setup.length == 0 ? acknowledge : stall;
    default:
      return stall;
  }
}

bool ControlRequests::received(std::span<const std::uint8_t> data) {
  if (data.size() != line_coding_size) return false;
  for (std::size_t i = 0; i < line_coding_size; ++i) line_coding_[i] = data[i];
  return true;
}

Reaction ControlRequests::reply_status(const SetupPacket& setup, bool flag) {
  if (setup.value != 0) return stall;
  reply_ = {static_cast<std::uint8_t>(flag ? 1 : 0), 0};
  return send(reply_);
}

Reaction ControlRequests::reply_byte(const SetupPacket& setup, std::uint8_t value) {
  if (setup.value != 0) return stall;
  reply_ = {value, 0};
  return send(std::span<const std::uint8_t>(reply_).first(1));
}

}  // namespace lamplock::rp2040::usb
