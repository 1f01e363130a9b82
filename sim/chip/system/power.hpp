// PSM and VREG_AND_CHIP_RESET: the order of power-up, and why the chip was reset last (RP2040
// datasheet, 2.13, 2.10-2.12).
//
// In:  registers; the watchdog; resets of the whole chip.
// Out: a call for each stage that is reset or released.
// Who: the bus; System and the chip, which attach the stages.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "sim/chip/fabric/peripheral.hpp"

namespace lamplock::sim::chip {

/// Stages in the order of power-up: bits of FRCE_ON, FRCE_OFF, WDSEL and DONE (2.13.5).
enum class PsmBit : std::uint8_t {
  rosc,
  xosc,
  clocks,
  resets,
  busfabric,
  rom,
  sram0,
  sram1,
  sram2,
  sram3,
  sram4,
  sram5,
  xip,
  vreg_and_chip_reset,
  sio,
  proc0,
  proc1
};
inline constexpr std::size_t psm_stage_count = 17;

/// The power-on state machine. Each stage is released when the stage before it is done (2.13.1): a
/// stage that is put into reset puts all later ones into reset as well, and the sequence runs from
/// there. The processors are both at its end, side by side.
class Psm final : public Peripheral {
 public:
  /// Called with true when a stage is put into reset, with false when it is released.
  using Stage = std::function<void(bool held)>;
  explicit Psm(NotModelled not_modelled);

  void attach(PsmBit bit, Stage stage);
  /// The watchdog has fired: the sequence runs again from the first stage that WDSEL selects.
  void watchdog_hold();
  void watchdog_release();
  /// Power-up: all stages are held, then released in order.
  void restart();

  std::string_view name() const override { return "PSM"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;

 private:
  void put(std::uint32_t stages, bool held);
  std::uint32_t held_off() const;

  NotModelled not_modelled_;
  std::array<std::vector<Stage>, psm_stage_count> stages_{};
  std::uint32_t force_on_ = 0, force_off_ = 0, watchdog_select_ = 0;
};

/// The cause of a reset of the whole chip. Software cannot distinguish power-on and brown-out (both
/// are HAD_POR). A watchdog's reset is none of these: CHIP_RESET keeps its value.
enum class ChipReset : std::uint8_t { power_on, brown_out, run_pin, debug_port };

/// Regulator, brown-out detector, and the cause of the last reset of the chip.
class VregAndChipReset final : public Peripheral {
 public:
  explicit VregAndChipReset(NotModelled not_modelled);

  /// Records the cause of a reset that is about to take place.
  void note(ChipReset cause);
  /// Whether the brown-out detector is on (2.10.3).
  bool brown_out_enabled() const { return (brown_out_ & 1u) != 0; }

  std::string_view name() const override { return "VREG_AND_CHIP_RESET"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t offset) const override;
  /// Resets the registers; the cause is kept.
  void reset() override;

 private:
  NotModelled not_modelled_;
  std::uint32_t regulator_ = 0, brown_out_ = 0, cause_ = 0;
};

}  // namespace lamplock::sim::chip
