#include "sim/chip/rom/picoboot.hpp"

#include <algorithm>
#include <utility>

#include "sim/chip/rom/rom_reboot.hpp"

namespace lamplock::sim::chip {

using namespace picoboot;

namespace {

constexpr std::uint32_t page = 256, sector = 4096, packet_size = 64;

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
  if (packet.size() != command_size || word(packet, 0) != magic) {
    refuse(Status::unknown_error, pipes);
    return;
  }
  token_ = word(packet, 4);
  command_ = static_cast<Command>(packet[8]);
  argument_bytes_ = packet[9];
  transfer_ = word(packet, 12);
  for (std::size_t i = 0; i < arguments_.size(); ++i) arguments_[i] = word(packet, 16 + 4 * i);
  status_ = Status::ok;
  std::uint32_t size = 0;
  Status found = check(size);
  if (found == Status::ok && argument_bytes_ != size) found = Status::invalid_command_length;
  if (found != Status::ok) {
    refuse(found, pipes);
    return;
  }
  in_progress_ = true;
  execute(bus, pipes);
}

Status Picoboot::check(std::uint32_t& size) const {
  if (rebooting_) return Status::rebooting;
  const bool moves = command_ == Command::read || command_ == Command::write;
  const Status lengths =
      transfer_ == (moves ? arguments_[1] : 0) ? Status::ok : Status::invalid_transfer_length;
  switch (command_) {
    case Command::exclusive_access:
      size = 1;
      return lengths;
    case Command::reboot:
      size = 12;
      return lengths;
    case Command::exit_xip:
    case Command::enter_command_xip:
      return lengths;
    case Command::vectorize_flash:
      size = 4;
      return lengths;
    case Command::flash_erase:
      size = 8;
      return lengths != Status::ok ? lengths : check_range(sector, true, true);
    case Command::write:
      size = 8;
      return lengths != Status::ok ? lengths : check_range(page, false, true);
    case Command::read:
      size = 8;
      return lengths != Status::ok ? lengths : check_range(1, false, false);
    case Command::exec:
      if (not_modelled_) not_modelled_("ROM USB boot loader: PICOBOOT EXEC refused");
      break;
  }
  return Status::unknown_command;
}

/// `alignment` is wanted in flash only.
Status Picoboot::check_range(std::uint32_t alignment, bool flash_only, bool writes) const {
  const std::uint32_t first = arguments_[0], size = arguments_[1];
  for (const Region& region : regions) {
    if (first - region.first >= region.size || size > region.size - (first - region.first))
      continue;
    if ((writes && !region.writable) || (flash_only && !in_flash(first))) break;
    const bool sizes_too = flash_only;
    const bool aligned = first % alignment == 0 && (!sizes_too || size % alignment == 0);
    return in_flash(first) && !aligned ? Status::bad_alignment : Status::ok;
  }
  return Status::invalid_address;
}

void Picoboot::execute(LoaderBus& bus, Pipes& pipes) {
  address_ = arguments_[0];
  left_ = transfer_;
  filled_ = emptied_ = 0;
  switch (command_) {
    case Command::exclusive_access:  // against mass storage, which is not there
      break;
    case Command::reboot:
      reboot(bus);
      break;
    case Command::flash_erase:
      if (arguments_[1] == 0) break;
      call(Service::erase_range, address_ - flash_base, arguments_[1]);
      return;
    case Command::exit_xip:
      call(Service::exit_xip, 0, 0);
      return;
    case Command::enter_command_xip:
      call(Service::enter_command_xip, 0, 0);
      return;
    case Command::vectorize_flash:
      if (address_ % 4 != 0 || address_ - regions[3].first > regions[3].size - 4 * (services + 1)) {
        refuse(address_ % 4 != 0 ? Status::bad_alignment : Status::invalid_address, pipes);
        return;
      }
      vectorize(bus);
      break;
    case Command::write:
      if (left_ == 0) break;
      step_ = Step::data_out;
      pipes.take();
      return;
    case Command::read:
      if (left_ == 0) break;
      step_ = Step::data_in;
      next_in(bus, pipes);
      return;
    case Command::exec:
      break;
  }
  finish(pipes);
}

void Picoboot::refuse(Status status, Pipes& pipes) {
  status_ = status;
  in_progress_ = false;
  step_ = Step::command;
  pipes.halt();
}

void Picoboot::finish(Pipes& pipes) {
  in_progress_ = false;
  // An empty packet against the direction of the data; IN if there were none.
  if (command_ == Command::read && transfer_ != 0) {
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
    refuse(Status::invalid_transfer_length, pipes);
    return;
  }
  const auto size = static_cast<std::uint32_t>(packet.size());
  const bool flash = in_flash(address_);
  for (std::uint32_t i = 0; i < size; ++i)
    bus.store(flash ? buffer_ + filled_ + i : address_ + i, packet[i], Width::byte);
  left_ -= size;
  if (!flash) {
    address_ += size;
  } else {
    filled_ += size;
    if (left_ == 0)
      for (; filled_ < page; ++filled_) bus.store(buffer_ + filled_, 0, Width::byte);
    if (filled_ == page) {
      call(Service::page_program, address_ - flash_base, buffer_);
      return;
    }
  }
  if (left_ == 0)
    finish(pipes);
  else
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
  if (result != 0) {
    refuse(Status::unknown_error, pipes);
    return;
  }
  if (step_ == Step::data_out) {
    address_ += page;
    filled_ = 0;
    if (left_ == 0)
      finish(pipes);
    else
      pipes.take();
  } else if (step_ == Step::data_in) {
    filled_ = page;
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
