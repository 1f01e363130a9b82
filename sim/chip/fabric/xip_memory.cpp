#include "sim/chip/fabric/xip_memory.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace lamplock::sim::chip {

namespace {

// Bits of the address that choose the alias (2.6.3.1).
constexpr std::uint32_t alias_no_allocate = 1u << 24, alias_no_lookup = 1u << 25;
constexpr std::uint32_t alias_bits = alias_no_allocate | alias_no_lookup;

}  // namespace

XipMemory::XipMemory(std::span<std::uint8_t> flash, std::function<std::uint32_t()> line_fill,
                     XipStream& stream, NotModelled not_modelled)
    : flash_(flash),
      line_fill_(std::move(line_fill)),
      stream_(stream),
      not_modelled_(std::move(not_modelled)) {}

void XipMemory::flush(Cycle at) {
  cache_.flush();
  flush_end_ = at + flush_cycles;
}

std::uint32_t XipMemory::flush_wait(Cycle at) const {
  return at < flush_end_ ? static_cast<std::uint32_t>(flush_end_ - at) : 0;
}

std::span<std::uint8_t> XipMemory::flash_at(std::uint32_t address) const {
  if (!readable_) return {};
  return flash_.subspan(address & (flash_.size() - 1));
}

// The port serves one access after the other. Returns the cycles that an access waits beyond the
// one that every access takes; at least `transfer` of them are for the serial interface.
std::uint32_t XipMemory::occupy(Master master, Cycle at, Cycle transfer) {
  Cycle start = std::max(at, flush_end_);
  if (master != holder_ && start >= begin_) start = std::max(start, end_);
  holder_ = master;
  if (start != end_) begin_ = start;
  if (transfer != 0) start = stream_.line_transfer(start, transfer);
  end_ = start + transfer + 1;
  return static_cast<std::uint32_t>(end_ - at - 1);
}

Access XipMemory::read(std::uint32_t address, Width width, Master master, Cycle at) {
  // The DMA runs inside an event, at the right time already.
  if (stream_.active() && master != Master::dma) stream_.bring_time_to(at);
  const bool look_up = enabled_ && (address & alias_no_lookup) == 0;
  const bool allocate = enabled_ && (address & alias_no_allocate) == 0;
  const std::uint32_t first = address & ~(XipCache::line_size - 1);
  std::uint8_t* line = enabled_ ? cache_.find(address) : nullptr;
  const bool hit = look_up && line != nullptr;
  cache_.count(hit);
  Cycle transfer = 0;
  const std::uint8_t* source = line;
  if (!hit) {
    if (!readable_) {
      if (not_modelled_) not_modelled_("XIP read while no flash is mapped");
      return {0, 0, true};
    }
    source = &flash_[first & (flash_.size() - 1)];
    transfer = line_fill_();
    if (allocate) {
      if (line == nullptr) line = cache_.replace(address);
      std::memcpy(line, source, XipCache::line_size);
    }
  }
  if (use_ != nullptr)
    use_->read(address & static_cast<std::uint32_t>(flash_.size() - 1), master, hit);
  Access access;
  std::memcpy(&access.value, source + (address - first), static_cast<std::size_t>(width));
  access.wait = occupy(master, at, transfer);
  return access;
}

Access XipMemory::write(std::uint32_t address, Master master, Cycle at) {
  if ((address & alias_bits) != 0) return {0, 0, bad_write_fault_};
  cache_.invalidate(address);
  return {0, occupy(master, at, 0), false};
}

}  // namespace lamplock::sim::chip
