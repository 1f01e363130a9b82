#include "sim/chip/rom/rom_on_core.hpp"

namespace lamplock::sim::chip {

namespace {

constexpr std::uint32_t vtor_register = 0xe000'ed08, scr_register = 0xe000'ed10;
constexpr std::uint32_t private_space = 0xe000'0000;

/// A core with the interface that the ROM needs.
class CoreView final : public RomCore {
 public:
  CoreView(Core& core, Bus& bus) : core_(core), bus_(bus) {}
  std::uint32_t reg(unsigned number) const override { return core_.reg(number); }
  void set_reg(unsigned number, std::uint32_t value) override { core_.set_reg(number, value); }
  Access load(std::uint32_t address, Width width, Cycle at) override {
    return bus_.read(address, width, master(), at);
  }
  Access store(std::uint32_t address, std::uint32_t value, Width width, Cycle at) override {
    if (address < private_space) return bus_.write(address, value, width, master(), at);
    if (address == vtor_register) core_.set_vtor(value);
    if (address == scr_register) core_.set_scr(value);
    return {};
  }
  unsigned id() const override { return static_cast<unsigned>(core_.id()); }

 private:
  Master master() const { return core_.id() == 0 ? Master::core0 : Master::core1; }
  Core& core_;
  Bus& bus_;
};

Core::Native call(BootRom& rom, Core& core, Bus& bus, std::uint32_t address) {
  core.set_reg(15, address);
  CoreView view(core, bus);
  const BootRom::Step step = rom.step(view, core.cycle());
  // The undefined instruction at the ROM's end raises a HardFault, as the failed access does.
  if (step.fault) core.set_reg(15, BootRom::fault_address);
  return {step.cycles, core.reg(15) == address ? Core::Then::again : Core::Then::jumped};
}

}  // namespace

void attach_rom(BootRom& rom, Core& core, Bus& bus) {
  for (std::uint32_t address = 0; address < Bus::rom_size; address += 2) {
    if (!rom.is_trap(address)) continue;
    std::uint32_t last = address;
    while (rom.is_trap(last + 2)) last += 2;
    core.add_native(address, last, [&rom, &bus](Core& caller, std::uint32_t at) {
      return call(rom, caller, bus, at);
    });
    address = last;
  }
}

}  // namespace lamplock::sim::chip
