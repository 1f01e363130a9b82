// Data in flash that survives a power cut: the settings, and the data that a program keeps.
//
// In:  values to keep. Out: those kept last; whether writing succeeded.
// Who: the main loop, at rest: a write may erase a sector, 45 to 400 ms, and no other part of the
//      board may read the flash meanwhile.
//
// Each kind has a store on its own sectors; both share one buffer, since SRAM is scarce. The code
// runs from flash (toolchain/arm/rp2040.ld), except for erasing and programming (flash.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "firmware/boards/rp2040/storage/flash.hpp"
#include "firmware/machine/console/persistent_state.hpp"
#include "firmware/settings/store.hpp"
#include "shared/boards/pico_flash.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::rp2040 {

class Storage {
 public:
  Storage() = default;
  Storage(const Storage&) = delete;
  Storage& operator=(const Storage&) = delete;

  /// Before anything is saved; returns the values kept last, or the defaults. Some milliseconds.
  settings::Values load_settings();
  bool has_settings() const { return !settings_.empty(); }
  void load_program(machine::PersistentState& kept);
  /// False if writing failed: then the previous values are still kept.
  bool save(const settings::Values& values);
  bool save(const machine::PersistentState& kept);

  /// Pages that did not contain a valid record when they were loaded.
  std::uint32_t rejected_settings() const { return settings_.counters().rejected; }
  std::uint32_t rejected_programs() const { return program_.counters().rejected; }

 private:
  using SettingsStore = settings::RecordStore<FlashArea, settings::SettingsRecord>;
  using ProgramStore = settings::RecordStore<FlashArea, machine::PersistentStateRecord>;

  std::array<std::uint8_t, std::max(SettingsStore::buffer_size, ProgramStore::buffer_size)>
      buffer_{};
  FlashArea settings_area_{boards::settings_offset}, program_area_{boards::program_offset};
  SettingsStore settings_{settings_area_, buffer_};
  ProgramStore program_{program_area_, buffer_};
};

}  // namespace lamplock::rp2040
