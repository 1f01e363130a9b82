// SYSINFO, SYSCFG, TBMAN, BUSCTRL: small blocks that identify the chip or configure it (RP2040
// datasheet, 2.20, 2.21, 2.23, 2.1.4).
//
// In:  registers.
// Out: identification of an RP2040 of stepping B2; settings, passed to the blocks concerned.
// Who: the bus.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>

#include "sim/chip/fabric/arbiter.hpp"
#include "sim/chip/fabric/peripheral.hpp"

namespace lamplock::sim::chip {

/// A block that only identifies the chip; writes are lost.
class Identification final : public Peripheral {
 public:
  /// SYSINFO, or TBMAN, which says that this is a chip and not an FPGA.
  static Identification sysinfo(NotModelled not_modelled);
  static Identification tbman(NotModelled not_modelled);
  std::string_view name() const override { return name_; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t /*offset*/, std::uint32_t /*value*/) override {}
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override {}

 private:
  Identification(std::string_view name, std::span<const std::uint32_t> words,
                 NotModelled not_modelled);
  std::string_view name_;
  std::span<const std::uint32_t> words_;
  NotModelled not_modelled_;
};

/// SYSCFG. NMI masks and synchroniser bypass take effect through the callbacks.
class Syscfg final : public Peripheral {
 public:
  struct Callbacks {
    std::function<void(int core, std::uint32_t irqs)> nmi_mask;
    std::function<void(std::uint32_t pins)> synchroniser_bypass;  ///< GPIO 0-29
  };
  Syscfg(Callbacks callbacks, NotModelled not_modelled);
  std::string_view name() const override { return "SYSCFG"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;

 private:
  void report(std::uint32_t offset) const;

  Callbacks callbacks_;
  NotModelled not_modelled_;
  std::array<std::uint32_t, 7> registers_{};
};

/// BUSCTRL: priorities of the masters. Of the events that its counters count, the contested
/// accesses of all ports but XIP are modelled.
class Busctrl final : public Peripheral {
 public:
  explicit Busctrl(NotModelled not_modelled);
  std::string_view name() const override { return "BUSCTRL"; }
  std::uint32_t read(std::uint32_t offset) override;
  std::uint32_t peek(std::uint32_t offset) const override;
  void write(std::uint32_t offset, std::uint32_t value) override;
  std::uint32_t write_clear_bits(std::uint32_t /*offset*/) const override { return 0; }
  void reset() override;
  /// Connects the arbiter with these priorities and counts.
  void connect(Arbiter& arbiter) { arbiter_ = &arbiter; }

 private:
  std::uint32_t events(std::size_t counter) const;
  std::uint32_t count(std::size_t counter) const;

  NotModelled not_modelled_;
  Arbiter* arbiter_ = nullptr;
  std::uint32_t priority_ = 0;
  std::array<std::uint32_t, 4> held_{};   ///< the count when its event was chosen
  std::array<std::uint32_t, 4> since_{};  ///< events of the port up to then
  std::array<std::uint32_t, 4> select_{};
};

}  // namespace lamplock::sim::chip
