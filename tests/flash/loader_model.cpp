#include "tests/flash/loader_model.hpp"

#include <algorithm>

namespace lamplock::flash::test {
namespace {

using usb::Transfer;
using usb::TransferEnd;

constexpr std::uint32_t base = 0x1000'0000, page_bytes = 256, sector_bytes = 4096;
constexpr std::size_t packet = 64;
constexpr std::uint32_t flash_end = 0x2000'0000;  // as in the ROM
constexpr std::uint32_t bad_command = 1, bad_length = 2, bad_transfer = 3, bad_address = 4,
                        bad_alignment = 5;

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t at) {
  return bytes[at] | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
         static_cast<std::uint32_t>(bytes[at + 2]) << 16 |
         static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

}  // namespace

usb::DeviceInfo LoaderModel::info(bool with_drive) {
  usb::DeviceInfo info;
  info.vendor = 0x2e8a;
  info.product = 0x0003;
  info.place = "1-4";
  info.name = "RP2 Boot";
  info.manufacturer = "Raspberry Pi";
  info.serial = "E0C9125B0D9B";
  const auto bulk = usb::Endpoint::Kind::bulk;
  if (with_drive) info.interfaces.push_back({0, 8, 6, 0x50, {{0x81, bulk, 64}, {0x02, bulk, 64}}});
  info.interfaces.push_back({static_cast<std::uint8_t>(with_drive ? 1 : 0),
                             0xff,
                             0,
                             0,
                             {{out, bulk, 64}, {in, bulk, 64}}});
  return info;
}

/// Counts a packet or flash operation; false from the cut on.
bool LoaderModel::step() {
  if (!gone_ && steps_++ == faults_.cut_at) gone_ = true;
  return !gone_;
}

TransferEnd LoaderModel::claim(std::uint8_t) {
  if (gone_) return TransferEnd::gone;
  return faults_.claimed_by_other ? TransferEnd::failed : TransferEnd::done;
}

TransferEnd LoaderModel::clear_halt(std::uint8_t endpoint) {
  if (gone_) return TransferEnd::gone;
  halted_.erase(endpoint);
  if (endpoint == out && state_ == State::dropped) state_ = State::command;
  return TransferEnd::done;
}

Transfer LoaderModel::control(const usb::Setup& setup, std::span<std::uint8_t> data,
                              std::chrono::milliseconds) {
  if (!step()) return {TransferEnd::gone, 0};
  if (setup.type == 0x82 && setup.request == 0 && data.size() == 2) {
    data[0] = halted_.contains(static_cast<std::uint8_t>(setup.index)) ? 1 : 0;
    data[1] = 0;
    return {TransferEnd::done, 2};
  }
  if (setup.type == 0x41 && setup.request == 0x41 && data.empty()) {
    ++resets_;
    halted_at_reset_ = !halted_.empty();
    halted_.clear();
    state_ = State::command;
    token_ = status_ = 0;
    return {TransferEnd::done, 0};
  }
  if (setup.type != 0xc1 || setup.request != 0x42 || data.size() != 16 || faults_.status_fails)
    return {TransferEnd::stalled, 0};
  std::fill(data.begin(), data.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < 4; ++i) {
    data[i] = static_cast<std::uint8_t>(token_ >> 8 * i);
    data[4 + i] = static_cast<std::uint8_t>(status_ >> 8 * i);
  }
  data[8] = command_;
  return {TransferEnd::done, 16};
}

void LoaderModel::refuse(std::uint32_t status) {
  status_ = status;
  state_ = State::dropped;
  halted_ = {in, out};
}

void LoaderModel::refuse_data(std::uint32_t status, std::uint8_t endpoint) {
  status_ = status;
  state_ = State::dropped;
  halted_ = {endpoint};
}

Transfer LoaderModel::bulk_out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                               std::chrono::milliseconds) {
  std::size_t moved = 0;
  do {
    if (!step()) return {TransferEnd::gone, moved};
    if (halted_.contains(endpoint)) return {TransferEnd::stalled, moved};
    const auto part = bytes.subspan(moved, std::min(packet, bytes.size() - moved));
    if (state_ == State::command) {
      begin(part);
    } else if (state_ == State::end_out) {
      state_ = State::command;
    } else if (state_ == State::data_out) {
      page_.insert(page_.end(), part.begin(), part.end());
      left_ -= static_cast<std::uint32_t>(part.size());
      if (page_.size() == page_bytes || left_ == 0) take_page();
      if (gone_) return {TransferEnd::gone, moved};
    } else {
      return {TransferEnd::timed_out, moved};
    }
    moved += part.size();
  } while (moved < bytes.size());
  return {TransferEnd::done, moved};
}

Transfer LoaderModel::bulk_in(std::uint8_t endpoint, std::span<std::uint8_t> bytes,
                              std::chrono::milliseconds) {
  if (silent_) return {TransferEnd::timed_out, 0};
  std::size_t moved = 0;
  for (;;) {
    if (!step()) return {TransferEnd::gone, moved};
    if (halted_.contains(endpoint)) return {TransferEnd::stalled, moved};
    if (state_ == State::end_in) {
      state_ = State::command;
      if (command_ == 2) gone_ = rebooted_ = true;
      return {TransferEnd::done, moved};
    }
    if (state_ != State::data_in) return {TransferEnd::timed_out, moved};
    const std::uint32_t done = transfer_ - left_;
    if (const std::uint32_t status = done % page_bytes == 0 ? judge_data(done) : 0; status != 0) {
      refuse_data(status, in);
      return {TransferEnd::stalled, moved};
    }
    const std::size_t size = std::min<std::size_t>({packet, left_, bytes.size() - moved});
    const auto to = bytes.subspan(moved, size);
    if (xip_left_) {
      std::copy_n(flash_.bytes.begin() + static_cast<std::ptrdiff_t>(place()), size, to.begin());
    } else {
      std::fill(to.begin(), to.end(), std::uint8_t{0});
    }
    address_ += static_cast<std::uint32_t>(size);
    left_ -= static_cast<std::uint32_t>(size);
    moved += size;
    if (left_ == 0) state_ = State::end_out;
    if (size < packet || moved == bytes.size()) return {TransferEnd::done, moved};
  }
}

void LoaderModel::begin(std::span<const std::uint8_t> bytes) {
  const std::size_t number = commands_++;
  // Even the status is the usual one then.
  if (bytes.size() != 32 || word(bytes, 0) != 0x431f'd10b) return refuse(status_);
  token_ = word(bytes, 4);
  command_ = bytes[8];
  argument_bytes_ = bytes[9];
  transfer_ = word(bytes, 12);
  for (std::size_t i = 0; i < 4; ++i) arguments_[i] = word(bytes, 16 + 4 * i);
  status_ = 0;
  refused_ = number == faults_.refused_command;
  if (refused_ && faults_.refused_at == RefusedAt::packet) return refuse(faults_.status);
  if (number == faults_.silent_command) silent_ = true;
  if (const std::uint32_t status = judge(); status != 0) return refuse(status);
  execute();
}

/// Checks the packet alone.
std::uint32_t LoaderModel::judge() const {
  const bool moves = command_ == 5 || command_ == 0x84;
  const std::uint32_t wanted = moves || command_ == 3 ? 8
                               : command_ == 1        ? 1
                               : command_ == 2        ? 12
                                                      : 0;
  if (!moves && command_ != 1 && command_ != 2 && command_ != 3 && command_ != 6)
    return bad_command;
  if (argument_bytes_ != wanted) return bad_length;
  return command_ != 2 && transfer_ != (moves ? arguments_[1] : 0) ? bad_transfer : 0;
}

/// The ROM's check of the 256 bytes after the first `done`. Only flash exists.
std::uint32_t LoaderModel::judge_data(std::uint32_t done) const {
  const bool first = done == 0, last = transfer_ - done <= page_bytes;
  if (refused_ && (faults_.refused_at == RefusedAt::first_data ? first : last))
    return faults_.status;
  const std::uint32_t size = std::min(page_bytes, transfer_ - done);
  if (address_ < base || address_ > flash_end - size) return bad_address;
  return address_ % page_bytes != 0 ? bad_alignment : 0;
}

void LoaderModel::execute() {
  address_ = arguments_[0];
  left_ = transfer_;
  page_.clear();
  state_ = State::end_in;
  if (command_ == 5 && left_ != 0) state_ = State::data_out;
  if (command_ == 0x84) state_ = left_ != 0 ? State::data_in : State::end_out;
  if (refused_) return;
  if (command_ == 1) exclusive_ = (arguments_[0] & 0xff) != 0;
  if (command_ == 6) xip_left_ = true;
  if (command_ == 3) erase();
}

/// Called when a page of data, or the rest, has arrived.
void LoaderModel::take_page() {
  const auto size = static_cast<std::uint32_t>(page_.size());
  if (const std::uint32_t status = judge_data(transfer_ - left_ - size); status != 0)
    return refuse_data(status, out);
  page_.resize(page_bytes, 0);
  if (!step()) return program({});
  program(page_);
  page_.clear();
  if (left_ == 0) state_ = State::end_in;
}

/// The flash ignores address bits that it does not have.
std::size_t LoaderModel::place() const { return (address_ - base) % FlashModel::size; }

void LoaderModel::erase() {
  if (faults_.erases_nothing || !xip_left_) return;
  const std::uint32_t size = arguments_[1];
  if (address_ % sector_bytes != 0 || size % sector_bytes != 0) return;
  if (address_ < base || address_ > flash_end || size > flash_end - address_) return;
  for (; address_ < arguments_[0] + size; address_ += sector_bytes) {
    flash_.erased_sectors.push_back(static_cast<std::uint32_t>(place()));
    const auto begin = flash_.bytes.begin() + static_cast<std::ptrdiff_t>(place());
    if (step()) {
      std::fill_n(begin, sector_bytes, std::uint8_t{0xff});
      continue;
    }
    // A cut leaves arbitrary contents.
    std::generate_n(begin, sector_bytes, [&] { return static_cast<std::uint8_t>(random_()); });
    return;
  }
}

/// Programs the page that has arrived; at a cut, only some of its bits.
void LoaderModel::program(std::span<const std::uint8_t> page) {
  // Unless XIP is left first, the flash ignores commands.
  if (!xip_left_) return;
  const bool cut = page.empty();
  const auto offset = static_cast<std::uint32_t>(place());
  flash_.programmed_pages.push_back(offset);
  for (std::uint32_t i = 0; i < page_.size(); ++i) {
    const std::uint8_t undone = cut ? static_cast<std::uint8_t>(random_()) : std::uint8_t{0};
    std::uint8_t& byte = flash_.bytes[offset + i];
    byte = static_cast<std::uint8_t>(byte & (page_[i] | undone));
    if (flash_.stuck.contains(offset + i)) byte = 0;
  }
  address_ += page_bytes;
}

}  // namespace lamplock::flash::test
