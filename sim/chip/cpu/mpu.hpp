// The memory protection unit of a core: eight regions (ARMv6-M Architecture Reference Manual, B3.5;
// RP2040 datasheet, 2.4.6).
//
// In:  its registers; accesses and fetches below the private peripheral bus.
// Out: whether they are permitted. Who: Core, while the unit is on.
#pragma once

#include <array>
#include <cstdint>

namespace lamplock::sim::chip {

enum class MpuAccess : std::uint8_t { read, write, fetch };

class Mpu {
 public:
  static constexpr std::uint32_t region_count = 8;

  void reset() { *this = Mpu(); }
  bool enabled() const { return (control_ & enable) != 0; }

  /// Registers by their offset from MPU_CTRL: CTRL, RNR, RBAR, RASR.
  std::uint32_t read(std::uint32_t offset) const;
  void write(std::uint32_t offset, std::uint32_t value);

  /// `privileged`: the code that makes the access. `in_fault`: in HardFault or NMI, where the unit
  /// is off unless HFNMIENA is set.
  bool permits(std::uint32_t address, MpuAccess access, bool privileged, bool in_fault) const;

 private:
  static constexpr std::uint32_t enable = 1u << 0, in_faults_too = 1u << 1,
                                 background_for_privileged = 1u << 2;
  struct Region {
    std::uint32_t base = 0;        ///< bits 31..8
    std::uint32_t attributes = 0;  ///< RASR
    bool contains(std::uint32_t address) const;
    bool permits(MpuAccess access, bool privileged) const;
  };

  std::uint32_t control_ = 0;
  std::uint32_t number_ = 0;
  std::array<Region, region_count> regions_{};
};

}  // namespace lamplock::sim::chip
