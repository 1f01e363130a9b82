#include "sim/chip/fabric/flash_use.hpp"

#include "sim/chip/fabric/hex.hpp"
#include "sim/chip/fabric/xip_cache.hpp"

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t window = 0x1000'0000;  // the cached one, with which images are linked

}  // namespace

FlashUse::FlashUse(std::size_t flash_size) : lines_(flash_size / XipCache::line_size) {}

void FlashUse::read(std::uint32_t offset, Master master, bool hit) {
  const std::uint32_t line = offset / XipCache::line_size;
  std::uint32_t& last = last_[static_cast<std::size_t>(master)];
  if (line != last) ++lines_[line].visits;
  if (!hit) ++lines_[line].misses;
  last = line;
}

std::string FlashUse::text() const {
  std::string result = "# address visits misses\n";
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const Line& line = lines_[i];
    if (line.visits == 0) continue;
    const auto offset = static_cast<std::uint32_t>(i) * XipCache::line_size;
    result += hex(window + offset);
    result += ' ' + std::to_string(line.visits) + ' ' + std::to_string(line.misses) + '\n';
  }
  return result;
}

}  // namespace lamplock::sim::chip
