#include "sim/chip/cpu/mpu.hpp"

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t base_mask = 0xffff'ff00;
constexpr std::uint32_t rbar_valid = 1u << 4, rbar_region = 0xf;
// XN, AP, S, C, B, SRD, SIZE, ENABLE.
constexpr std::uint32_t rasr_mask = 0x1707'ff3f;
constexpr std::uint32_t rasr_enable = 1, rasr_execute_never = 1u << 28;
constexpr unsigned min_region_size = 7;  // 2^8 bytes

}  // namespace

std::uint32_t Mpu::read(std::uint32_t offset) const {
  const Region& region = regions_[number_];
  switch (offset) {
    case 0x0:
      return control_;
    case 0x4:
      return number_;
    case 0x8:
      return region.base | number_;
    default:
      return region.attributes;
  }
}

void Mpu::write(std::uint32_t offset, std::uint32_t value) {
  switch (offset) {
    case 0x0:
      control_ = value & (enable | in_faults_too | background_for_privileged);
      return;
    case 0x4:
      number_ = value % region_count;
      return;
    case 0x8:
      if ((value & rbar_valid) != 0) number_ = (value & rbar_region) % region_count;
      regions_[number_].base = value & base_mask;
      return;
    default:
      regions_[number_].attributes = value & rasr_mask;
      return;
  }
}

bool Mpu::Region::contains(std::uint32_t address) const {
  if ((attributes & rasr_enable) == 0) return false;
  const unsigned size = attributes >> 1 & 31u;
  if (size < min_region_size) return false;
  // 2^(size + 1) bytes at a multiple of that, in eight parts of which each may be left out.
  const std::uint32_t inside = size == 31 ? ~0u : (2u << size) - 1u;
  if (((address ^ base) & ~inside) != 0) return false;
  return (attributes >> (8 + ((address & inside) >> (size - 2))) & 1u) == 0;
}

bool Mpu::Region::permits(MpuAccess access, bool privileged) const {
  if (access == MpuAccess::fetch && (attributes & rasr_execute_never) != 0) return false;
  const bool write = access == MpuAccess::write;
  switch (attributes >> 24 & 7u) {
    case 1:
      return privileged;
    case 2:
      return privileged || !write;
    case 3:
      return true;
    case 5:
      return privileged && !write;
    case 6:
    case 7:
      return !write;
    default:
      return false;
  }
}

bool Mpu::permits(std::uint32_t address, MpuAccess access, bool privileged, bool in_fault) const {
  if (!enabled() || (in_fault && (control_ & in_faults_too) == 0)) return true;
  // The region with the highest number decides.
  for (std::uint32_t i = region_count; i-- != 0;)
    if (regions_[i].contains(address)) return regions_[i].permits(access, privileged);
  return privileged && (control_ & background_for_privileged) != 0;
}

}  // namespace lamplock::sim::chip
