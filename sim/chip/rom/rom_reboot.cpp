#include "sim/chip/rom/rom_reboot.hpp"

#include "sim/chip/rom/rom_context.hpp"

namespace lamplock::sim::chip::rom {

void reboot(LoaderBus& bus, std::uint32_t entry, std::uint32_t stack, std::uint32_t milliseconds) {
  constexpr std::uint32_t psm_wdsel = 0x4001'0008, all_but_oscillators = 0x1'fffc;
  constexpr std::uint32_t enable = 1u << 30, pauses = 7u << 24;
  const auto store = [&](std::uint32_t address, std::uint32_t value) {
    bus.store(address, value, Width::word);
  };
  store(psm_wdsel, all_but_oscillators);
  store(watchdog + clear_alias, enable | pauses);
  if (entry == 0) {
    store(boot_vector, 0);
  } else {
    const std::uint32_t thumb = entry | 1u;
    store(boot_vector, boot_magic);
    store(boot_vector + 4, thumb ^ (0u - boot_magic));
    store(boot_vector + 8, stack);
    store(boot_vector + 12, thumb);
  }
  store(watchdog_load, milliseconds * 1000);
  store(clk_ref, ref_crystal);
  store(watchdog_tick, tick_of_crystal);
  store(watchdog + set_alias, enable);
}

}  // namespace lamplock::sim::chip::rom
