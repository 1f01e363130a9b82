#include "sim/chip/rom/picoboot.hpp"

#include <algorithm>
#include <utility>

#include "sim/chip/rom/rom_context.hpp"
#include "sim/chip/rom/rom_reboot.hpp"

namespace lamplock::sim::chip {

using namespace picoboot;

namespace {

using rom::flash_page, rom::flash_sector;

/// Where the host may read and write (2.8.5.4.4, 2.8.5.4.5).
struct Region {
  std::uint32_t first, size;
  bool writable;
};
constexpr std::uint32_t flash_base = 0x1000'0000, flash_size = 16u << 20;
constexpr std::array<Region, 4> regions = {{{0, 16 * 1024, false},
                                            {flash_base, flash_size, true},
                                            {0x1500'0000, 16 * 1024, true},
                                            {0x2000'0000, 264 * 1024, true}}};

bool in_flash(std::uint32_t address) { return address - flash_base < flash_size; }

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes[at + i];
  return value;
}

}  // namespace

Picoboot::Picoboot(std::uint32_t buffer, NotModelled not_modelled)
    : buffer_(buffer), not_modelled_(std::move(not_modelled)) {}

void Picoboot::start() {
  rebooting_ = calling_ = false;
  vectors_ = 0;
  reset();
}

void Picoboot::reset() {
  step_ = Step::command;
  command_ = {};
  token_ = 0;
  status_ = Status::ok;
  in_progress_ = false;
  dropped_ = calling_;
  call_.reset();
}

void Picoboot::abandon(Pipes& pipes) {
  reset();
  pipes.take();
}

std::array<std::uint8_t, status_size> Picoboot::status() const {
  std::array<std::uint8_t, status_size> bytes{};
  for (unsigned i = 0; i < 4; ++i) {
    bytes[i] = static_cast<std::uint8_t>(token_ >> 8 * i);
    bytes[4 + i] = static_cast<std::uint8_t>(static_cast<std::uint32_t>(status_) >> 8 * i);
  }
  bytes[8] = static_cast<std::uint8_t>(command_);
  bytes[9] = in_progress_ ? 1 : 0;
  return bytes;
}

void Picoboot::received(std::span<const std::uint8_t> packet, LoaderBus& bus, Pipes& pipes) {
  switch (step_) {
    case Step::command:
      begin(packet, bus, pipes);
      return;
    case Step::data_out:
      data(packet, bus, pipes);
      return;
    case Step::acknowledge_out:
      step_ = Step::command;
      pipes.take();
      return;
    case Step::data_in:
    case Step::acknowledge_in:
      return;
  }
}

void Picoboot::given(LoaderBus& bus, Pipes& pipes) {
  if (step_ == Step::data_in) {
    next_in(bus, pipes);
  } else if (step_ == Step::acknowledge_in) {
    step_ = Step::command;
    pipes.take();
  }
}

// --- commands ---

void Picoboot::begin(std::span<const std::uint8_t> packet, LoaderBus& bus, Pipes& pipes) {
  // In this case even the status remains unchanged.
  if (packet.size() != command_size || word(packet, 0) != magic) {
    refuse(pipes);
    return;
  }
  token_ = word(packet, 4);
  command_ = static_cast<Command>(packet[8]);
  argument_bytes_ = packet[9];
  transfer_ = word(packet, 12);
  for (std::size_t i = 0; i < arguments_.size(); ++i) arguments_[i] = word(packet, 16 + 4 * i);
  status_ = check();
  if (status_ != Status::ok) {
    refuse(pipes);
    return;
  }
  in_progress_ = true;
  execute(bus, pipes);
}

/// Status of the packet itself.
Status Picoboot::check() const {
  std::uint32_t size = 0, data = 0;
  switch (command_) {
    case Command::exclusive_access:
      size = 1;
      break;
    case Command::reboot:
      size = 12;
      data = transfer_;  // which is not used
      break;
    case Command::exit_xip:
    case Command::enter_command_xip:
      break;
    case Command::vectorize_flash:
      size = 4;
      break;
    case Command::flash_erase:
      size = 8;
      break;
    case Command::write:
    case Command::read:
      size = 8;
      data = arguments_[1];
      break;
    case Command::exec:
      if (not_modelled_) not_modelled_("ROM USB boot loader: PICOBOOT EXEC refused");
      return Status::unknown_command;
    default:
      return Status::unknown_command;
  }
  if (argument_bytes_ != size) return Status::invalid_command_length;
  return transfer_ == data ? Status::ok : Status::invalid_transfer_length;
}

/// Checks the next 256 bytes, or the rest.
Status Picoboot::check_data(bool writes) const {
  if (rebooting_) return Status::rebooting;
  const std::uint32_t size = std::min(left_, flash_page);
  for (const Region& region : regions) {
    if (address_ - region.first >= region.size || size > region.size - (address_ - region.first))
      continue;
    if (writes && !region.writable) break;
    return in_flash(address_) && address_ % flash_page != 0 ? Status::bad_alignment : Status::ok;
  }
  return Status::invalid_address;
}

bool Picoboot::can_erase() const {
  const std::uint32_t size = arguments_[1];
  return !rebooting_ && size != 0 && address_ % flash_sector == 0 && size % flash_sector == 0 &&
         in_flash(address_) && size <= flash_size - (address_ - flash_base);
}

/// The ROM accepts every even address; an address that is not a word's would make its next call
/// fail.
bool Picoboot::can_hold_vectors() const {
  const Region& sram = regions[3];
  return !rebooting_ && address_ % 4 == 0 &&
         address_ - sram.first <= sram.size - 4 * (services + 1);
}

void Picoboot::execute(LoaderBus& bus, Pipes& pipes) {
  address_ = arguments_[0];
  left_ = transfer_;
  filled_ = emptied_ = 0;
  switch (command_) {
    case Command::exclusive_access:  // against mass storage, which is not there
    case Command::exec:
      break;
    case Command::reboot:
      reboot(bus);
      break;
    case Command::flash_erase:
      if (!can_erase()) break;
      call(Service::erase_range, address_ - flash_base, arguments_[1]);
      return;
    case Command::exit_xip:
    case Command::enter_command_xip:
      if (rebooting_) break;
      call(command_ == Command::exit_xip ? Service::exit_xip : Service::enter_command_xip, 0, 0);
      return;
    case Command::vectorize_flash:
      if (can_hold_vectors()) vectorize(bus);
      break;
    case Command::write:
      if (left_ == 0) break;
      step_ = Step::data_out;
      found_ = check_data(true);
      pipes.take();
      return;
    case Command::read:
      if (left_ == 0) break;
      step_ = Step::data_in;
      next_in(bus, pipes);
      return;
  }
  finish(pipes);
}

void Picoboot::refuse(Pipes& pipes) {
  in_progress_ = false;
  step_ = Step::command;
  pipes.halt(Pipe::in);
  pipes.halt(Pipe::out);
}

/// The other endpoint is halted until the OUT endpoint or the interface is reset.
void Picoboot::refuse_data(Status status, Pipes& pipes) {
  const Pipe pipe = step_ == Step::data_in ? Pipe::in : Pipe::out;
  status_ = status;
  in_progress_ = false;
  step_ = Step::command;
  pipes.halt(pipe);
}

void Picoboot::finish(Pipes& pipes) {
  in_progress_ = false;
  // An empty packet against the direction of the data.
  if (command_ == Command::read) {
    step_ = Step::acknowledge_out;
    pipes.take();
  } else {
    step_ = Step::acknowledge_in;
    pipes.give({});
  }
}

// --- data ---

void Picoboot::next_in(LoaderBus& bus, Pipes& pipes) {
  if (left_ == 0) {
    finish(pipes);
    return;
  }
  if ((transfer_ - left_) % flash_page == 0) {
    if (const Status found = check_data(false); found != Status::ok) {
      refuse_data(found, pipes);
      return;
    }
  }
  if (in_flash(address_) && emptied_ == filled_) {
    call(Service::page_read, address_ - flash_base, buffer_);
    return;
  }
  const bool flash = in_flash(address_);
  const std::uint32_t size = std::min({left_, packet_size, flash ? filled_ - emptied_ : left_});
  std::array<std::uint8_t, packet_size> packet{};
  for (std::uint32_t i = 0; i < size; ++i) {
    const std::uint32_t from = flash ? buffer_ + emptied_ + i : address_ + i;
    packet[i] = static_cast<std::uint8_t>(bus.load(from, Width::byte));
  }
  emptied_ += flash ? size : 0;
  address_ += size;
  left_ -= size;
  pipes.give(std::span(packet).first(size));
}

void Picoboot::data(std::span<const std::uint8_t> packet, LoaderBus& bus, Pipes& pipes) {
  if (packet.size() > left_) {
    refuse_data(Status::invalid_transfer_length, pipes);
    return;
  }
  const auto size = static_cast<std::uint32_t>(packet.size());
  const bool flash = in_flash(address_), good = found_ == Status::ok;
  for (std::uint32_t i = 0; good && i < size; ++i)
    bus.store(flash ? buffer_ + filled_ + i : address_ + filled_ + i, packet[i], Width::byte);
  left_ -= size;
  filled_ += size;
  if (filled_ < flash_page && left_ != 0) {
    pipes.take();
    return;
  }
  // An error in a page is reported after the whole page has arrived.
  if (!good) {
    refuse_data(found_, pipes);
  } else if (flash) {
    for (; filled_ < flash_page; ++filled_) bus.store(buffer_ + filled_, 0, Width::byte);
    call(Service::page_program, address_ - flash_base, buffer_);
  } else {
    next_out(pipes);
  }
}

/// A page has been written.
void Picoboot::next_out(Pipes& pipes) {
  address_ += flash_page;
  filled_ = 0;
  if (left_ == 0) {
    finish(pipes);
    return;
  }
  found_ = check_data(true);
  pipes.take();
}

// --- flash functions ---

void Picoboot::call(Service service, std::uint32_t first, std::uint32_t second) {
  call_ = Call{service, {first, second}};
}

std::optional<Call> Picoboot::take_call() {
  if (calling_) return std::nullopt;
  const std::optional<Call> call = std::exchange(call_, std::nullopt);
  calling_ = call.has_value();
  return call;
}

void Picoboot::returned(std::uint32_t result, LoaderBus& bus, Pipes& pipes) {
  calling_ = false;
  if (std::exchange(dropped_, false)) return;
  const bool moves = step_ == Step::data_out || step_ == Step::data_in;
  if (moves && result != 0) {
    refuse_data(static_cast<Status>(result), pipes);
  } else if (step_ == Step::data_out) {
    next_out(pipes);
  } else if (step_ == Step::data_in) {
    filled_ = flash_page;
    emptied_ = 0;
    next_in(bus, pipes);
  } else {
    finish(pipes);
  }
}

void Picoboot::vectorize(LoaderBus& bus) {
  vectors_ = address_;
  bus.store(vectors_, 4 * (services + 1), Width::word);
  for (std::uint32_t i = 0; i < services; ++i)
    bus.store(vectors_ + 4 + 4 * i, functions_[i], Width::word);
}

void Picoboot::reboot(LoaderBus& bus) {
  rebooting_ = true;
  // At least a millisecond, for the answer (assumed).
  rom::reboot(bus, arguments_[0], arguments_[1], std::max(arguments_[2], 1u));
}

}  // namespace lamplock::sim::chip
