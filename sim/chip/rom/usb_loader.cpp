#include "sim/chip/rom/usb_loader.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "sim/chip/usb/registers.hpp"
#include "sim/chip/usb/usb_controller.hpp"

namespace lamplock::sim::chip {

namespace {

namespace reg_at = usb::reg;
namespace bc = usb::buffer_control;
namespace dp = usb::dpram;
namespace irq = usb::interrupt;

constexpr std::uint32_t registers = UsbController::base, dpram = UsbController::dpram_base;

// Bits of BUFF_STATUS, and places of the buffer control words: 2 x endpoint, + 1 if OUT.
constexpr std::uint32_t control_in = 0, control_out = 1;
constexpr std::uint32_t bulk_in = 2 * UsbLoader::in_endpoint;
constexpr std::uint32_t bulk_out = 2 * UsbLoader::out_endpoint + 1;
constexpr std::uint32_t bulk_out_buffer = dp::buffers, bulk_in_buffer = dp::buffers + 64;
using picoboot::packet_size;

constexpr std::uint32_t buffer_control_of(std::uint32_t index) {
  return dp::buffer_control + 4 * index;
}
/// Endpoint 0 has none.
constexpr std::uint32_t endpoint_control_of(std::uint32_t index) {
  return dp::ep_control + 4 * (index - 2);
}

// Requests (USB 2.0, tables 9-3 to 9-6).
constexpr std::uint8_t get_status = 0, clear_feature = 1, set_feature = 3, set_address = 5,
                       get_descriptor = 6, get_configuration = 8, set_configuration = 9,
                       get_interface = 10, set_interface = 11;
constexpr std::uint8_t device_type = 1, configuration_type = 2, string_type = 3;
constexpr std::uint8_t recipient_mask = 0x1f, to_interface = 1, to_endpoint = 2;
constexpr std::uint8_t kind_mask = 0x60, vendor_kind = 0x40, to_host = 0x80;
// PICOBOOT's own (2.8.5.5).
constexpr std::uint8_t interface_reset = 0x41, get_command_status = 0x42;

constexpr std::array<std::uint8_t, 18> device_descriptor = {  // 2.8.5.1
    18,
    1,
    0x10,
    0x01,
    0,
    0,
    0,
    64,
    UsbLoader::vendor & 0xff,
    UsbLoader::vendor >> 8,
    UsbLoader::product & 0xff,
    UsbLoader::product >> 8,
    0x00,
    0x01,
    1,
    2,
    3,
    1};
// The serial number is of this model: those of real chips are of their ROM.
constexpr std::array<std::string_view, 3> strings = {"Raspberry Pi", "RP2 Boot", "LAMPLOCK0001"};

}  // namespace

UsbLoader::UsbLoader(NotModelled not_modelled)
    : picoboot_(page_buffer, not_modelled), not_modelled_(std::move(not_modelled)) {}

// --- registers and buffers ---

std::uint32_t UsbLoader::reg(std::uint32_t offset) {
  return bus_->load(registers + offset, Width::word);
}
void UsbLoader::set_reg(std::uint32_t offset, std::uint32_t value) {
  bus_->store(registers + offset, value, Width::word);
}

void UsbLoader::put(std::uint32_t at, std::span<const std::uint8_t> bytes) {
  for (std::uint32_t i = 0; i < bytes.size(); i += 4) {
    std::uint32_t word = 0;
    for (std::uint32_t k = 0; k < 4 && i + k < bytes.size(); ++k)
      word |= static_cast<std::uint32_t>(bytes[i + k]) << 8 * k;
    bus_->store(dpram + at + i, word, Width::word);
  }
}

/// Fields first, AVAILABLE later, as the datasheet requires (4.1.2.5.1).
void UsbLoader::arm(std::uint32_t index, std::uint32_t fields) {
  const std::uint32_t at = dpram + buffer_control_of(index);
  bus_->store(at, fields, Width::word);
  bus_->store(at, fields | bc::available, Width::word);
}

void UsbLoader::start(std::uint32_t disabled_interfaces, LoaderBus& bus) {
  bus_ = &bus;
  disabled_ = disabled_interfaces;
  picoboot_.start();
  configured_ = false;
  for (std::uint32_t at = 0; at < dp::buffers; at += 4) bus.store(dpram + at, 0, Width::word);
  set_reg(reg_at::usb_muxing, usb::phy::to_phy | 1u << 3);
  set_reg(reg_at::usb_pwr, usb::phy::vbus_detect | usb::phy::vbus_detect_override);
  set_reg(reg_at::main_ctrl, usb::main_ctrl::controller_en);
  set_reg(reg_at::inte, irq::buff_status | irq::bus_reset | irq::setup_req);
  const std::uint32_t bulk = usb::ep_control::enable | usb::ep_control::int_1buf |
                             usb::ep_control::type_bulk << usb::ep_control::type_shift;
  bus.store(dpram + endpoint_control_of(bulk_in), bulk | bulk_in_buffer, Width::word);
  bus.store(dpram + endpoint_control_of(bulk_out), bulk | bulk_out_buffer, Width::word);
  set_reg(reg_at::sie_ctrl, usb::sie_ctrl::ep0_int_1buf | usb::sie_ctrl::pullup_en);
}

void UsbLoader::interrupt(LoaderBus& bus) {
  bus_ = &bus;
  const std::uint32_t status = reg(reg_at::ints);
  if ((status & irq::bus_reset) != 0) {
    set_reg(reg_at::sie_status, usb::sie_status::bus_reset);
    bus_reset();
  }
  // Buffers before the setup packet: they belong to the earlier transfer.
  if ((status & irq::buff_status) != 0) {
    const std::uint32_t done = reg(reg_at::buff_status);
    set_reg(reg_at::buff_status, done);
    for (const std::uint32_t index : {control_in, control_out, bulk_in, bulk_out})
      if ((done >> index & 1u) != 0) buffer_done(index);
  }
  if ((status & irq::setup_req) != 0) {
    set_reg(reg_at::sie_status, usb::sie_status::setup_rec);
    setup();
  }
}

void UsbLoader::returned(std::uint32_t result, LoaderBus& bus) {
  bus_ = &bus;
  picoboot_.returned(result, bus, *this);
}

void UsbLoader::bus_reset() {
  set_reg(reg_at::addr_endp, 0);
  for (const std::uint32_t index : {control_in, control_out, bulk_in, bulk_out})
    bus_->store(dpram + buffer_control_of(index), 0, Width::word);
  configured_ = false;
  new_address_.reset();
  picoboot_.reset();
}

void UsbLoader::buffer_done(std::uint32_t index) {
  const std::uint32_t word = bus_->load(dpram + buffer_control_of(index), Width::word);
  switch (index) {
    case control_in:
      if (new_address_) set_reg(reg_at::addr_endp, *new_address_);
      new_address_.reset();
      if (control_in_ && (control_sent_ < control_data_.size() || std::exchange(short_end_, false)))
        send_control();
      return;
    case control_out:
      return;
    case bulk_in:
      in_data1_ = !in_data1_;
      picoboot_.given(*bus_, *this);
      return;
    default:
      break;
  }
  out_data1_ = !out_data1_;
  taking_ = false;
  std::array<std::uint8_t, packet_size> packet{};
  const std::size_t size = std::min<std::size_t>(word & bc::length_mask, packet.size());
  for (std::uint32_t i = 0; i < size; ++i)
    packet[i] = static_cast<std::uint8_t>(bus_->load(dpram + bulk_out_buffer + i, Width::byte));
  picoboot_.received(std::span(packet).first(size), *bus_, *this);
}

// --- bulk endpoints ---

void UsbLoader::take() {
  if (!configured_ || halted_out_ || taking_) return;
  taking_ = true;
  arm(bulk_out, (out_data1_ ? bc::pid : 0u) | packet_size);
}

void UsbLoader::give(std::span<const std::uint8_t> packet) {
  if (!configured_ || halted_in_) return;
  put(bulk_in_buffer, packet);
  const auto size = static_cast<std::uint32_t>(packet.size());
  arm(bulk_in, bc::full | (in_data1_ ? bc::pid : 0u) | size);
}

void UsbLoader::halt(picoboot::Pipe pipe) {
  const bool in = pipe == picoboot::Pipe::in;
  (in ? halted_in_ : halted_out_) = true;
  if (!in) taking_ = false;
  bus_->store(dpram + buffer_control_of(in ? bulk_in : bulk_out), bc::stall, Width::word);
}

// --- control transfers ---

void UsbLoader::setup() {
  bus_->store(dpram + buffer_control_of(control_in), 0, Width::word);
  bus_->store(dpram + buffer_control_of(control_out), 0, Width::word);
  new_address_.reset();
  control_in_ = false;
  Setup packet{};
  for (std::uint32_t i = 0; i < packet.size(); ++i)
    packet[i] = static_cast<std::uint8_t>(bus_->load(dpram + dp::setup_packet + i, Width::byte));
  const auto length = static_cast<std::size_t>(packet[6] | packet[7] << 8);
  if (request(packet, length)) return;
  set_reg(reg_at::ep_stall_arm, 3);
  bus_->store(dpram + buffer_control_of(control_in), bc::stall, Width::word);
  bus_->store(dpram + buffer_control_of(control_out), bc::stall, Width::word);
}

/// Sends an answer of at most `length` bytes; an empty one is the status of a transfer to the
/// device.
void UsbLoader::answer(std::span<const std::uint8_t> data, std::size_t length) {
  control_data_.assign(data.begin(),
                       data.begin() + static_cast<std::ptrdiff_t>(std::min(data.size(), length)));
  control_sent_ = 0;
  control_data1_ = true;
  control_in_ = length != 0;
  // An answer shorter than requested ends with a short packet.
  short_end_ = !control_data_.empty() && control_data_.size() < length &&
               control_data_.size() % packet_size == 0;
  send_control();
}

void UsbLoader::send_control() {
  const std::size_t size = std::min<std::size_t>(packet_size, control_data_.size() - control_sent_);
  put(dp::ep0_buffer, std::span(control_data_).subspan(control_sent_, size));
  control_sent_ += size;
  // The host's status stage.
  if (control_in_ && control_sent_ == control_data_.size()) arm(control_out, bc::pid | packet_size);
  arm(control_in, bc::full | (control_data1_ ? bc::pid : 0u) | static_cast<std::uint32_t>(size));
  control_data1_ = !control_data1_;
}

bool UsbLoader::request(const Setup& packet, std::size_t length) {
  const std::uint8_t recipient = packet[0] & recipient_mask;
  if ((packet[0] & kind_mask) == vendor_kind)
    return recipient == to_interface && interface_request(packet, length);
  if ((packet[0] & kind_mask) != 0) return false;
  if (recipient == to_endpoint) return endpoint_request(packet, length);
  return standard(packet, length);
}

bool UsbLoader::standard(const Setup& packet, std::size_t length) {
  const std::array<std::uint8_t, 2> nothing{};
  const std::uint8_t configuration = configured_ ? 1 : 0;
  switch (packet[1]) {
    case get_status:
      answer(nothing, length);
      return true;
    case set_address:
      new_address_ = packet[2] & 0x7f;
      answer({}, 0);
      return true;
    case get_descriptor:
      return descriptor(packet, length);
    case get_configuration:
      answer({&configuration, 1}, length);
      return true;
    case set_configuration:
      if (packet[2] > 1) return false;
      answer({}, 0);
      configure(packet[2] == 1);
      return true;
    case get_interface:
      answer(std::span(nothing).first(1), length);
      return configured_;
    case set_interface:
      if (!configured_ || packet[2] != 0) return false;
      answer({}, 0);
      configure(true);
      return true;
    default:
      return false;
  }
}

bool UsbLoader::descriptor(const Setup& packet, std::size_t length) {
  const std::uint8_t index = packet[2];
  switch (packet[3]) {
    case device_type:
      answer(device_descriptor, length);
      return true;
    case configuration_type:
      if (index != 0) return false;
      answer(configuration_descriptor(), length);
      return true;
    case string_type:
      break;
    default:
      return false;
  }
  if (index > strings.size()) return false;
  constexpr std::array<std::uint8_t, 4> languages = {4, string_type, 0x09, 0x04};
  if (index == 0) {
    answer(languages, length);
    return true;
  }
  const std::string_view text = strings[index - 1u];
  std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(2 + 2 * text.size()), string_type};
  for (const char letter : text) {
    bytes.push_back(static_cast<std::uint8_t>(letter));
    bytes.push_back(0);
  }
  answer(bytes, length);
  return true;
}

std::vector<std::uint8_t> UsbLoader::configuration_descriptor() const {
  constexpr std::uint8_t bus_powered = 0x80, half_ampere = 250, vendor_specific = 0xff, bulk = 2;
  constexpr std::uint8_t size = 32, without_interface = 9;
  std::array<std::uint8_t, size> bytes = {9, configuration_type, size, 0, 1, 1, 0, bus_powered,
                                          half_ampere,
                                          // 2.8.5.2
                                          9, 4, 0, 0, 2, vendor_specific, 0, 0, 0,      //
                                          7, 5, out_endpoint, bulk, packet_size, 0, 0,  //
                                          7, 5, to_host | in_endpoint, bulk, packet_size, 0, 0};
  if ((disabled_ & no_picoboot) == 0) return {bytes.begin(), bytes.end()};
  bytes[2] = without_interface;
  bytes[4] = 0;
  return {bytes.begin(), bytes.begin() + without_interface};
}

void UsbLoader::configure(bool on) {
  configured_ = on;
  halted_in_ = halted_out_ = in_data1_ = out_data1_ = taking_ = false;
  bus_->store(dpram + buffer_control_of(bulk_in), 0, Width::word);
  bus_->store(dpram + buffer_control_of(bulk_out), 0, Width::word);
  picoboot_.abandon(*this);
}

bool UsbLoader::interface_request(const Setup& packet, std::size_t length) {
  if (!configured_ || (disabled_ & no_picoboot) != 0) return false;
  const bool in = (packet[0] & to_host) != 0;
  if (in && packet[1] == get_command_status && length == picoboot::status_size) {
    answer(picoboot_.status(), length);
    return true;
  }
  if (in || packet[1] != interface_reset || length != 0) return false;
  // Halts are cleared; the sequence of DATA0 and DATA1 continues.
  halted_in_ = halted_out_ = taking_ = false;
  bus_->store(dpram + buffer_control_of(bulk_in), 0, Width::word);
  bus_->store(dpram + buffer_control_of(bulk_out), 0, Width::word);
  picoboot_.abandon(*this);
  answer({}, 0);
  return true;
}

bool UsbLoader::endpoint_request(const Setup& packet, std::size_t length) {
  const std::uint8_t endpoint = packet[4];
  if (endpoint == (to_host | 0) || endpoint == 0) {
    const std::array<std::uint8_t, 2> nothing{};
    if (packet[1] != get_status) return false;
    answer(nothing, length);
    return true;
  }
  const bool in = endpoint == (to_host | in_endpoint);
  if (!configured_ || (!in && endpoint != out_endpoint)) return false;
  bool& halted = in ? halted_in_ : halted_out_;
  const std::uint32_t word = dpram + buffer_control_of(in ? bulk_in : bulk_out);
  switch (packet[1]) {
    case get_status: {
      const std::array<std::uint8_t, 2> status = {static_cast<std::uint8_t>(halted ? 1 : 0), 0};
      answer(status, length);
      return true;
    }
    case set_feature:
      halted = true;
      if (!in) taking_ = false;
      bus_->store(word, bc::stall, Width::word);
      answer({}, 0);
      return true;
    case clear_feature: {
      // USB 2.0, 9.4.5: starts again with DATA0, halted or not.
      (in ? in_data1_ : out_data1_) = false;
      const bool was_halted = std::exchange(halted, false);
      if (was_halted || (!in && taking_)) {
        bus_->store(word, 0, Width::word);
        if (!in) {
          taking_ = false;
          take();
        }
      }
      answer({}, 0);
      return true;
    }
    default:
      return false;
  }
}

}  // namespace lamplock::sim::chip
