#include "host/flash/picoboot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "host/flash/flash_image.hpp"

namespace lamplock::flash {
namespace {

using std::chrono::milliseconds;
using usb::TransferEnd;

constexpr std::uint32_t magic = 0x431f'd10b;
constexpr std::size_t command_size = 32, status_size = 16, arguments_at = 16, packet_size = 64;

/// Control requests to the interface: reset, and status of the last command.
constexpr std::uint8_t to_interface = 0x41, from_interface = 0xc1;
constexpr std::uint8_t interface_reset = 0x41, get_command_status = 0x42;
/// GET_STATUS of an endpoint (USB 2.0, 9.4.5).
constexpr std::uint8_t from_endpoint = 0x82, get_status = 0;

/// A loader that still erases for an earlier program answers after at most one block.
constexpr milliseconds answer_time{3'000};
/// W25Q16JV data sheet: a sector takes 400 ms at most, a page 3 ms.
constexpr milliseconds sector_erase_time{400}, page_program_time{3};
constexpr milliseconds control_time{1'000};

constexpr const char* replug =
    "unplug the board, hold BOOTSEL while plugging it in again, then run lamplock flash again";

void put(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t value) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> 8 * i);
}
std::uint32_t get(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

/// Meaning of a status, and its remedy.
struct Meaning {
  const char *what, *remedy;
};
constexpr const char* own_fault = "please report it, with the version of lamplock";
constexpr std::array<Meaning, 18> meanings = {{
    {"broke off without a reason", replug},
    {"does not know this command", "check with lamplock devices that it is an RP2040"},
    {"expects another number of argument bytes", own_fault},
    {"expects another length of data", own_fault},
    {"has no such address", "check that its flash is large enough for the image"},
    {"requires addresses and lengths of whole pages or sectors", own_fault},
    {"is being written by another program", "stop copying to the drive RPI-RP2, then flash again"},
    {"is restarting already", "wait until the board is back, then flash again"},
    {"failed in the flash chip", replug},
    {"cannot do this in its present state", replug},
    {"does not permit it", "check whether this part of its flash is protected"},
    {"does not accept the argument", own_fault},
    {"has too small a buffer", own_fault},
    {"requires an earlier command", replug},
    {"found data that were changed meanwhile", replug},
    {"found invalid data", replug},
    {"did not find the requested item", own_fault},
    {"cannot make this change", "check whether this part of its flash is protected"},
}};

}  // namespace

enum class Picoboot::Command : std::uint8_t {
  exclusive_access = 0x01,
  reboot = 0x02,
  flash_erase = 0x03,
  write = 0x05,
  exit_xip = 0x06,
  read = 0x84  // bit 7: data come from the loader
};

/// A command to be sent, with its name for errors.
struct Picoboot::Order {
  Command command{};
  std::string name{};
  std::array<std::uint32_t, 3> arguments{};
  std::uint8_t argument_bytes = 0;
  std::uint32_t transfer = 0;  ///< bytes of data
};

/// The answer to get_command_status.
struct Picoboot::Status {
  std::uint32_t token = 0;
  PicobootStatus code = PicobootStatus::ok;
};

Picoboot::Picoboot(usb::Device& device, const usb::DeviceInfo& info) : device_(device) {
  find_interface(info);
  const TransferEnd end = device_.claim(interface_);
  if (end == TransferEnd::gone) fail({end, 0}, {.name = "opening it"});
  if (end != TransferEnd::done)
    throw PicobootError(Exit::no_device, "another program uses it",
                        "close that program (picotool, another lamplock), then flash again");
  recover();
}

/// Finds the vendor-specific interface with two bulk endpoints: number 1 beside the drive, or the
/// only one.
void Picoboot::find_interface(const usb::DeviceInfo& info) {
  using Kind = usb::Endpoint::Kind;
  for (const usb::Interface& interface : info.interfaces) {
    if (interface.class_code != usb::vendor_specific || interface.endpoints.size() != 2) continue;
    const usb::Endpoint &first = interface.endpoints[0], &second = interface.endpoints[1];
    const bool first_in = (first.address & usb::direction_in) != 0;
    const bool second_in = (second.address & usb::direction_in) != 0;
    if (first.kind != Kind::bulk || second.kind != Kind::bulk || first_in == second_in) continue;
    interface_ = interface.number;
    out_ = first_in ? second.address : first.address;
    in_ = first_in ? first.address : second.address;
    return;
  }
  throw PicobootError(Exit::no_device, "its PICOBOOT interface is switched off",
                      "hold BOOTSEL while plugging in, or copy the image to its drive: --drive");
}

// --- commands ---

void Picoboot::take_exclusive_access() {
  run({Command::exclusive_access, "exclusive access", {1}, 1, 0}, answer_time);
}

void Picoboot::exit_xip() { run({Command::exit_xip, "exit of XIP", {}, 0, 0}, answer_time); }

void Picoboot::erase(std::uint32_t address, std::uint32_t size) {
  const std::int64_t sectors = size / std::uint32_t{sector_size};
  run({Command::flash_erase, fmt::format("erase at 0x{:08x}", address), {address, size}, 8, 0},
      answer_time + sectors * sector_erase_time);
}

void Picoboot::write(std::uint32_t address, std::span<const std::uint8_t> bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  const Order order{
      Command::write, fmt::format("write at 0x{:08x}", address), {address, size}, 8, size};
  const std::int64_t pages = size / std::uint32_t{page_size} + 1;
  send(order);
  check(device_.bulk_out(out_, bytes, answer_time + pages * page_program_time), size, order);
  take_empty(answer_time, order);
}

void Picoboot::read(std::uint32_t address, std::span<std::uint8_t> bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  const Order order{
      Command::read, fmt::format("read at 0x{:08x}", address), {address, size}, 8, size};
  send(order);
  check(device_.bulk_in(in_, bytes, answer_time), size, order);
  check(device_.bulk_out(out_, {}, answer_time), 0, order);
}

void Picoboot::reboot(milliseconds delay) {
  const auto delay_ms = static_cast<std::uint32_t>(delay.count());
  const Order order{Command::reboot, "restart", {0, 0, delay_ms}, 12, 0};
  send(order);
  std::array<std::uint8_t, packet_size> packet{};
  const usb::Transfer answer = device_.bulk_in(in_, packet, answer_time);
  // The device may leave the bus before its answer was read.
  if (answer.end != TransferEnd::gone) check(answer, 0, order);
}

// --- the way of a command ---

void Picoboot::send(const Order& order) {
  std::array<std::uint8_t, command_size> packet{};
  put(packet, 0, magic);
  put(packet, 4, ++token_);
  packet[8] = static_cast<std::uint8_t>(order.command);
  packet[9] = order.argument_bytes;
  put(packet, 12, order.transfer);
  for (std::size_t i = 0; i < order.arguments.size(); ++i)
    put(packet, arguments_at + 4 * i, order.arguments[i]);
  check(device_.bulk_out(out_, packet, answer_time), packet.size(), order);
}

void Picoboot::run(const Order& order, milliseconds patience) {
  send(order);
  take_empty(patience, order);
}

/// Ends a command without data, or with data to the loader.
void Picoboot::take_empty(milliseconds patience, const Order& order) {
  std::array<std::uint8_t, packet_size> packet{};
  check(device_.bulk_in(in_, packet, patience), 0, order);
}

void Picoboot::check(const usb::Transfer& transfer, std::size_t size, const Order& order) {
  if (!transfer.done()) fail(transfer, order);
  if (transfer.size == size) return;
  recover();
  throw PicobootError(
      Exit::job_failed,
      fmt::format("{}: {} bytes were transferred, not {}", order.name, transfer.size, size),
      "check the cable, then flash again");
}

void Picoboot::fail(const usb::Transfer& transfer, const Order& order) {
  switch (transfer.end) {
    case TransferEnd::stalled:
      fail_refused(order, status());
    case TransferEnd::gone:
      throw PicobootError(Exit::no_device,
                          fmt::format("{}: it was unplugged, or restarted", order.name), replug);
    case TransferEnd::timed_out:
      fail_unanswered(order);
    default:
      throw PicobootError(Exit::no_device,
                          fmt::format("{}: the transfer over USB failed", order.name),
                          "try another cable or port, then flash again");
  }
}

/// The ROM receives the last data of a write before it checks them: it then refuses by halting the
/// OUT endpoint, which this session no longer reads, and never sends the packet that ends the
/// command.
void Picoboot::fail_unanswered(const Order& order) {
  const std::optional<Status> answer = status();
  if (answer && answer->token == token_ && answer->code != PicobootStatus::ok)
    fail_refused(order, answer);
  throw PicobootError(Exit::no_device, fmt::format("{}: it does not answer", order.name), replug);
}

void Picoboot::fail_refused(const Order& order, const std::optional<Status>& answer) {
  recover();
  if (!answer || answer->token != token_)
    throw PicobootError(Exit::job_failed, fmt::format("{}: refused, no reason given", order.name),
                        replug);
  const auto code = static_cast<std::uint32_t>(answer->code);
  if (code >= meanings.size())
    throw PicobootError(Exit::job_failed,
                        fmt::format("{}: refused with the unknown status {}", order.name, code),
                        replug, answer->code);
  const Meaning& meaning = meanings[code];
  throw PicobootError(Exit::job_failed,
                      fmt::format("{}: it {} (status {})", order.name, meaning.what, code),
                      meaning.remedy, answer->code);
}

// --- after a refusal ---

std::optional<Picoboot::Status> Picoboot::status() {
  std::array<std::uint8_t, status_size> bytes{};
  const usb::Transfer answer =
      device_.control({from_interface, get_command_status, 0, interface_}, bytes, control_time);
  if (!answer.done() || answer.size != bytes.size()) return std::nullopt;
  return Status{get(bytes, 0), static_cast<PicobootStatus>(get(bytes, 4))};
}

/// Only a halted endpoint may be cleared: clearing resets the packet sequence at both ends, which
/// not every device does for an endpoint that is not halted.
bool Picoboot::halted(std::uint8_t endpoint) {
  std::array<std::uint8_t, 2> bytes{};
  const usb::Transfer answer =
      device_.control({from_endpoint, get_status, 0, endpoint}, bytes, control_time);
  return answer.done() && answer.size == bytes.size() && (bytes[0] & 1u) != 0;
}

/// A failure here is not reported: the next command fails too and reports it.
void Picoboot::recover() {
  for (const std::uint8_t endpoint : {in_, out_})
    if (halted(endpoint)) device_.clear_halt(endpoint);
  device_.control({to_interface, interface_reset, 0, interface_}, {}, control_time);
}

}  // namespace lamplock::flash
