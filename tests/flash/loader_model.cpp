#include "tests/flash/loader_model.hpp"

#include <algorithm>

namespace lamplock::flash::test {
namespace {

using usb::Transfer;
using usb::TransferEnd;

constexpr std::uint32_t base = 0x1000'0000, page_bytes = 256, sector_bytes = 4096;
constexpr std::size_t packet = 64;
constexpr std::uint32_t bad_length = 2, bad_transfer = 3, bad_address = 4, bad_alignment = 5;

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

/// One packet or flash operation; false from the cut on.
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
  state_ = State::command;
  halted_ = {in, out};
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
      if (page_.size() == page_bytes || left_ == 0) {
        if (!step()) program({});
        if (gone_) return {TransferEnd::gone, moved};
        program(page_);
        page_.clear();
      }
      if (left_ == 0) state_ = State::end_in;
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
    const std::size_t size = std::min<std::size_t>({packet, left_, bytes.size() - moved});
    std::copy_n(flash_.bytes.begin() + (address_ - base), size,
                bytes.begin() + static_cast<std::ptrdiff_t>(moved));
    address_ += static_cast<std::uint32_t>(size);
    left_ -= static_cast<std::uint32_t>(size);
    moved += size;
    if (left_ == 0) state_ = State::end_out;
    if (size < packet || moved == bytes.size()) return {TransferEnd::done, moved};
  }
}

void LoaderModel::begin(std::span<const std::uint8_t> bytes) {
  const std::size_t number = commands_++;
  if (bytes.size() != 32 || word(bytes, 0) != 0x431f'd10b) return refuse(8);
  token_ = word(bytes, 4);
  command_ = bytes[8];
  argument_bytes_ = bytes[9];
  transfer_ = word(bytes, 12);
  for (std::size_t i = 0; i < 4; ++i) arguments_[i] = word(bytes, 16 + 4 * i);
  status_ = 0;
  if (number == faults_.refused_command) return refuse(faults_.status);
  if (number == faults_.silent_command) silent_ = true;
  if (const std::uint32_t status = judge(); status != 0) return refuse(status);
  execute();
}

/// RP2040 datasheet, 2.8.5.4.
std::uint32_t LoaderModel::judge() const {
  const std::uint32_t first = arguments_[0], size = arguments_[1];
  const bool flash = command_ == 3 || command_ == 5 || command_ == 0x84;
  const std::uint32_t wanted = flash ? 8 : command_ == 1 ? 1 : command_ == 2 ? 12 : 0;
  if (!flash && command_ != 1 && command_ != 2 && command_ != 6) return 1;
  if (argument_bytes_ != wanted) return bad_length;
  if (transfer_ != (flash && command_ != 3 ? size : 0)) return bad_transfer;
  if (!flash) return 0;
  if (first < base || first - base >= FlashModel::size || size > FlashModel::size - (first - base))
    return bad_address;
  const std::uint32_t unit = command_ == 3 ? sector_bytes : command_ == 5 ? page_bytes : 1;
  return first % unit != 0 || (command_ == 3 && size % unit != 0) ? bad_alignment : 0;
}

void LoaderModel::execute() {
  address_ = arguments_[0];
  left_ = transfer_;
  page_.clear();
  state_ = State::end_in;
  // Without XIP left first the flash does not listen.
  if (!xip_left_ && (command_ == 3 || command_ == 5 || command_ == 0x84)) return refuse(8);
  if (command_ == 1) exclusive_ = (arguments_[0] & 0xff) != 0;
  if (command_ == 6) xip_left_ = true;
  if (command_ == 3) erase();
  if (command_ == 5 && left_ != 0) state_ = State::data_out;
  if (command_ == 0x84 && left_ != 0) state_ = State::data_in;
}

void LoaderModel::erase() {
  if (faults_.erases_nothing) return;
  for (std::uint32_t at = 0; at < arguments_[1]; at += sector_bytes) {
    const std::uint32_t offset = address_ - base + at;
    flash_.erased_sectors.push_back(offset);
    const auto begin = flash_.bytes.begin() + offset;
    if (step()) {
      std::fill_n(begin, sector_bytes, std::uint8_t{0xff});
      continue;
    }
    // A cut leaves anything.
    std::generate_n(begin, sector_bytes, [&] { return static_cast<std::uint8_t>(random_()); });
    return;
  }
}

/// With the page that has come; or, at a cut, with some of its bits.
void LoaderModel::program(std::span<const std::uint8_t> page) {
  const bool cut = page.empty();
  const std::uint32_t offset = address_ - base;
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
