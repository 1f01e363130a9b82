// The simulated RP2040 as a whole: cores, memories, every block, wired as in the datasheet.
//
// In:  an image in its flash; power, time; levels on its pins (Gpio), a host on its USB cable.
// Out: levels on its pins, packets, what its UARTs send; reports of what is not modelled.
// Who: a board (chip_board/), tests. Deterministic: the same calls give the same run to the cycle.
//
// The core with the lower cycle makes the next step: cores run instruction by instruction, all
// other blocks when the wheel has them due or when they are accessed. A reset of the chip
// (watchdog, SYSRESETREQ, power) takes place between two instructions.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "sim/chip/cpu/core.hpp"
#include "sim/chip/cpu/fault.hpp"
#include "sim/chip/fabric/bus.hpp"
#include "sim/chip/fabric/irq_lines.hpp"
#include "sim/chip/fabric/time_wheel.hpp"
#include "sim/chip/fabric/timing.hpp"
#include "sim/chip/flash/flash_chip.hpp"
#include "sim/chip/flash/xip.hpp"
#include "sim/chip/gpio/gpio.hpp"
#include "sim/chip/image/image.hpp"
#include "sim/chip/pio_dma_clock.hpp"
#include "sim/chip/rom/boot_rom.hpp"
#include "sim/chip/sio/sio.hpp"
#include "sim/chip/system.hpp"
#include "sim/chip/usb/usb_controller.hpp"
#include "sim/chip/usb/usb_pins.hpp"

namespace lamplock::sim::chip {

struct ChipOptions {
  Timing timing{};
  FlashTiming flash_timing{};
  std::size_t flash_size = FlashChip::default_size;
  UsbErrata usb_errata{};
  std::uint64_t seed = 1;                          ///< of the flash contents after a power cut
  unsigned rom_version = BootRom::latest_version;  ///< 1 in stepping B0, 2 in B1, 3 in B2
};

/// Called before each step of a core (an instruction, an exception entry), see Chip::watch_steps().
class StepWatcher {
 public:
  virtual ~StepWatcher() = default;
  /// Returns false to keep the core where it is; run_until() then returns.
  virtual bool before_step(Core& core) = 0;
};

/// One chip with its flash.
class Chip final : private ClockListener, private TickListener {
 public:
  explicit Chip(const ChipOptions& options = {});
  Chip(const Chip&) = delete;
  Chip& operator=(const Chip&) = delete;

  /// Puts an image into the flash (and SRAM, if it says so); before power_on(). Throws
  /// std::runtime_error, beginning with `where`, if a part does not fit.
  void load(const Image& image, const std::string& where);
  /// Applies power: both cores start in the ROM.
  void power_on() { system_.reset(ChipReset::power_on); }

  // The chip starts again from any state.
  /// Short failure of all power: the flash keeps its contents, SRAM is filled with noise.
  void power_cut();
  /// Short failure of the core's supply: SRAM is filled with noise; the flash has its own supply
  /// and continues. No effect if the firmware has switched the detector off.
  void brown_out();
  /// Short low pulse on the RUN pin: SRAM is kept, the flash continues.
  void run_pin() { system_.reset(ChipReset::run_pin); }

  /// Runs until both cores have reached `until` and are between two instructions; now() is the
  /// lower of their cycles.
  void run_until(Cycle until);
  /// With a watcher the cores run step by step: slower, but the same run. null: none.
  void watch_steps(StepWatcher* watcher) { watcher_ = watcher; }
  /// Called inside a step of a core that was requested to stop: run_until() returns after that
  /// step.
  void halt() { halted_ = true; }
  Cycle now() const { return wheel_.now(); }
  Picoseconds time() const { return wheel_.time(); }

  TimeWheel& wheel() { return wheel_; }
  const TimeWheel& wheel() const { return wheel_; }
  Bus& bus() { return bus_; }
  Gpio& gpio() { return gpio_; }
  Core& core(int id) { return cores_[static_cast<std::size_t>(id)]; }
  FlashChip& flash() { return flash_; }
  Xip& xip() { return xip_; }
  BootRom& rom() { return rom_; }
  System& system() { return system_; }
  UsbController& usb() { return usb_; }
  PioDmaClock& pio_dma() { return pio_dma_; }

  /// Accesses that are not modelled, each once, in order.
  const std::vector<std::string>& not_modelled() const { return not_modelled_; }
  /// Fatal faults of the program, in order: of each kind the first on each core.
  const std::vector<Fault>& faults() const { return faults_; }
  /// Resets by the watchdog since the chip was made.
  std::uint32_t watchdog_resets() const { return watchdog_resets_; }

 private:
  NotModelled reporter();
  void note(Fault fault);
  void note_at_core0(FaultKind kind, FaultCause cause);
  void watchdog_fired();
  void map();
  void attach_core(int id);
  void clocks_changed() override;
  void ticks_moved() override;
  void lose_memory();
  void restart_cores();
  void attach_gates();
  void fall_asleep();
  void wake_up(Cycle at);
  bool between_instructions() const;
  Core* lone();
  std::size_t earlier_core() const;
  void run_both(Cycle until);
  void run_alone(Core& core, Cycle until);
  bool watched_step(Cycle until);
  void bring_along(std::size_t sleeper);
  void wait_for_woken(std::size_t woken);

  std::vector<std::string> not_modelled_;
  std::set<std::string> known_;
  Timing timing_;
  TimeWheel wheel_;
  IrqLines irqs_;
  Bus bus_;
  Gpio gpio_;
  FlashChip flash_;
  Xip xip_;
  BootRom rom_;
  Sio sio_;
  System system_;
  PioDmaClock pio_dma_;
  std::array<std::uint8_t, Bus::usb_dpram_size> usb_dpram_{};
  UsbController usb_;
  UsbPins usb_pins_;
  std::array<Core, 2> cores_;
  std::array<bool, 2> held_{true, true};       ///< in reset
  std::array<bool, 2> restart_{false, false};  ///< released, has not started yet
  Core* runs_alone_ = nullptr;                 ///< while the other one is idle
  std::vector<Fault> faults_;
  std::uint32_t watchdog_resets_ = 0;
  std::uint64_t seed_;
  StepWatcher* watcher_ = nullptr;
  bool halted_ = false;
  bool asleep_ = false;     ///< SLEEP_EN decides about the clocks
  bool may_sleep_ = false;  ///< a core has fallen asleep, or the DMA has become idle
};

}  // namespace lamplock::sim::chip
