// The six pins between the chip and its flash: IO_QSPI and PADS_QSPI (RP2040 datasheet, 2.19.6.2
// and 2.19.6.4), as far as they bear on the flash and on the BOOTSEL button.
//
// In:  registers; the button, which pulls chip select low through a resistor.
// Out: forcing of chip select, data lines that are disconnected, levels of lines that are not
//      driven, SIO's GPIO_HI_IN.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "sim/chip/fabric/peripheral.hpp"

namespace lamplock::sim::chip {

/// Effect of OUTOVER on a pin.
enum class OutOver : std::uint8_t { normal, invert, low, high };

/// Both blocks of registers.
class QspiPins {
 public:
  /// Order of the pins in IO_QSPI and in GPIO_HI_IN.
  enum Index : std::uint8_t { sclk, ss, sd0, sd1, sd2, sd3, count };

  explicit QspiPins(NotModelled not_modelled);
  QspiPins(const QspiPins&) = delete;
  QspiPins& operator=(const QspiPins&) = delete;

  Peripheral& io() { return io_; }
  Peripheral& pads() { return pads_; }

  /// Calls before and after each change of a register.
  void on_change(std::function<void()> before, std::function<void()> after);

  OutOver select_override() const;
  /// Levels of IO0..IO3 where the host drives `driven` with `levels` and the flash does not drive.
  unsigned lines(unsigned driven, unsigned levels) const;

  void press_bootsel(bool pressed) { bootsel_ = pressed; }
  /// Bits of SIO's GPIO_HI_IN with the pins at rest: chip select high unless the button pulls it
  /// low.
  std::uint32_t inputs() const;

 private:
  struct Io final : Peripheral {
    explicit Io(QspiPins& pins) : owner(pins) {}
    std::string_view name() const override { return "IO_QSPI"; }
    std::uint32_t read(std::uint32_t offset) override;
    std::uint32_t peek(std::uint32_t offset) const override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
    void reset() override;
    QspiPins& owner;
    std::array<std::uint32_t, count> control{};
  };
  struct Pads final : Peripheral {
    explicit Pads(QspiPins& pins) : owner(pins) { set_defaults(); }
    std::string_view name() const override { return "PADS_QSPI"; }
    std::uint32_t read(std::uint32_t offset) override;
    std::uint32_t peek(std::uint32_t offset) const override;
    void write(std::uint32_t offset, std::uint32_t value) override;
    std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
    void reset() override;
    void set_defaults();
    QspiPins& owner;
    std::uint32_t voltage = 0;
    std::array<std::uint32_t, count> pad{};  ///< in the order of the registers
  };
  void change(const std::function<void()>& what);

  NotModelled not_modelled_;
  Io io_;
  Pads pads_;
  std::function<void()> before_, after_;
  bool bootsel_ = false;
};

}  // namespace lamplock::sim::chip
