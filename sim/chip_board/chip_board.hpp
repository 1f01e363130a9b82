// A Pico with the flash image on it, in the simulated world: pads to lamp, drives and laser, USB to
// a host.
//
// In:  an image, settings for its flash, a world. Out: the same facade as the virtual board's.
// The pins are those of the map (shared/boards/all_boards.hpp). Outside of them are the electronics
// that docs/wiring.md draws: switches normally closed to ground; drives enabled by a low level, or
// by a high one if set so; active-low inputs of drives have a pull-up.
//
// Time: the chip's wheel runs everything; the world's events are parts of it, so that a lamp edge
// reaches the pad in its exact cycle. Time 0 is power-up; boot and enumeration take some 0.2 s.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/boards/all_boards.hpp"
#include "shared/settings_table.hpp"
#include "sim/board.hpp"
#include "sim/chip/chip.hpp"
#include "sim/chip/usb_host/usb_host.hpp"
#include "sim/chip_board/drive_wire.hpp"
#include "sim/world/world.hpp"

namespace lamplock::sim {

struct ChipBoardOptions {
  chip::ChipOptions chip{};
  chip::UsbHostOptions usb{};
  /// Wiring and electronics of the board with this map; default: as the wires of docs/wiring.md for
  /// the map of the stored settings, without the resistors.
  std::optional<boards::PinMap> wiring{};
};

/// One board in its world.
class ChipBoard final : public Board,
                        private PinListener,
                        private VoltageListener,
                        private chip::PadListener,
                        private chip::Timed {
 public:
  /// Loads the image, stores `stored` in the flash as the board itself would, and powers up. Throws
  /// std::runtime_error if the image cannot be used.
  ChipBoard(const chip::Image& image, const settings::Values& stored, const WorldConfig& world,
            const ChipBoardOptions& options = {});
  ~ChipBoard() override;
  ChipBoard(const ChipBoard&) = delete;
  ChipBoard& operator=(const ChipBoard&) = delete;

  /// Runs until the host has found the serial port; false if it has not within `limit`.
  bool run_until_found(Picoseconds limit);

  std::string_view name() const override { return "chip"; }
  /// Interface that the host uses from now on, at first the serial port; the other one is closed.
  void talk_over(chip::UsbFunction function);

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    return host_.write(bytes, function_);
  }
  std::size_t read(std::span<std::uint8_t> bytes) override { return host_.read(bytes, function_); }
  bool has_output() const override { return host_.has_output(function_); }
  void reconnect() override { host_.reset_device(); }
  void set_host_present(bool present) override { host_.set_dtr(present); }
  void run_until(Picoseconds until) override;
  Picoseconds now() const override { return chip_.wheel().time(); }
  PinBus& bus() override { return bus_; }
  World& world() override { return *world_; }
  const World& world() const override { return *world_; }
  const std::vector<LatticeShot>& lattice_shots() const override { return lattice_shots_; }

  /// Pin map that is wired.
  boards::PinMap map() const { return map_; }
  chip::Chip& chip() { return chip_; }
  chip::UsbHost& usb_host() { return host_; }
  /// Drives on the board that is wired; null if it has none.
  DriveWire* drive_wire() { return drive_wire_ ? &*drive_wire_ : nullptr; }
  /// Short power failure; the world continues.
  void power_cut() { chip_.power_cut(); }
  /// Contents of the settings area of the flash, as the next start would read it.
  settings::Values stored_settings();

 private:
  void pin_changed(Pin pin, bool level, Picoseconds at) override;
  void voltage_changed(double volts, Picoseconds at) override;
  void pad_changed(unsigned gpio, bool level, chip::Cycle at) override;
  void run(chip::Cycle to) override;
  void clock_changed() override { plan(); }
  void plan();
  void connect_pads(const settings::Values& stored, const DriveConfig& drives);
  void connect_resistors(const settings::Values& stored);
  void drive(Pin pin, bool level);
  void switch_drives(Picoseconds at);
  void measure_pwm(bool level, Picoseconds at);
  std::uint16_t attenuator(Picoseconds at);
  void settle_pwm(Picoseconds at);
  void put_power(std::uint16_t power, Picoseconds at);

  PinBus bus_;
  std::unique_ptr<World> world_;
  chip::Chip chip_;
  chip::UsbHost host_;
  chip::UsbFunction function_ = chip::UsbFunction::serial;
  chip::TimeWheel::Slot slot_;
  const boards::PinMap map_;
  struct Pad {
    Pin pin = Pin::count;
    bool inverted = false;   ///< the wire has the opposite level
    bool pulled_up = false;  ///< outside: high while the board does not drive it
  };
  std::array<std::optional<Pad>, chip::gpio_count> outputs_{};
  /// The filter after LASER PWM.
  struct Pwm {
    bool level = false;
    Picoseconds rose = 0;
    Picoseconds ends = 0;     ///< the period that it fell in
    std::uint16_t power = 0;  ///< last reported
  };
  Pwm pwm_;
  std::uint32_t enables_ = 0;  ///< pads that are one wire, Pin::enable
  std::optional<DriveWire> drive_wire_;
  std::vector<LatticeShot> lattice_shots_;  ///< stays empty: pins do not show lattice ticks
};

}  // namespace lamplock::sim
