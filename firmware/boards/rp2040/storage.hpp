// What survives a power cut, in flash: the settings, and what a program leaves behind.
//
// In:  values to keep. Out: those kept last; whether the flash took them.
// Who: the main loop, at rest: a write may erase a sector, 45 to 400 ms, and no other part of the
//      board may read the flash meanwhile.
//
// Each kind has a store on sectors of its own; both share one buffer, for SRAM is scarce. The code
// runs from flash (toolchain/arm/rp2040.ld), but for what erases and programs it (flash.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/flash.hpp"
#include "firmware/machine/kept_program.hpp"
#include "firmware/settings/store.hpp"
#include "shared/boards/pico_flash.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::rp2040 {

class Storage {
 public:
  Storage() = default;
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  /// Before anything is saved; what was kept last, or the defaults. Some milliseconds.
  settings::Values load_settings();
  void load_program(machine::KeptProgram& kept);
  /// False if the flash did not take it: then what was kept before still is.
  bool save(const settings::Values& values);
  bool save(const machine::KeptProgram& kept);

  /// Pages that held something else when they were loaded.
  std::uint32_t rejected_settings() const { return settings_.counters().rejected; }
  std::uint32_t rejected_programs() const { return program_.counters().rejected; }

 private:
  using SettingsStore = settings::RecordStore<FlashArea, settings::SettingsRecord>;
  using ProgramStore = settings::RecordStore<FlashArea, machine::KeptProgramRecord>;

  std::array<std::uint8_t, std::max(SettingsStore::buffer_size, ProgramStore::buffer_size)>
      buffer_{};
  FlashArea settings_area_{boards::settings_offset}, program_area_{boards::program_offset};
  SettingsStore settings_{settings_area_, buffer_};
  ProgramStore program_{program_area_, buffer_};
};

}  // namespace lamplock::rp2040
