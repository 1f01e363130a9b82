#include "sim/chip/chip.hpp"

#include <algorithm>
#include <random>
#include <stdexcept>

#include "sim/chip/fabric/hex.hpp"
#include "sim/chip/rom/rom_on_core.hpp"

namespace lamplock::sim::chip {
namespace {

// Where blocks lie that System does not know (RP2040 datasheet, 2.2).
constexpr std::uint32_t io_qspi_base = 0x4001'8000;
constexpr std::uint32_t pads_qspi_base = 0x4002'0000;
constexpr std::uint32_t dma_base = 0x5000'0000;
constexpr std::uint32_t pio0_base = 0x5020'0000;
constexpr std::uint32_t pio1_base = 0x5030'0000;
constexpr std::uint32_t flash_base = 0x1000'0000, flash_limit = 0x1100'0000;
constexpr std::uint32_t rom_vectors = 0;
/// Maximum further cycles of a run until no core is in the middle of an instruction: two loops of
/// multiple accesses may never both be between two.
constexpr Cycle patience = 1000;

}  // namespace

Chip::Chip(const ChipOptions& options)
    : timing_(options.timing),
      bus_(wheel_, timing_, reporter()),
      gpio_(wheel_, irqs_, reporter()),
      flash_(options.flash_size, options.flash_timing, reporter(), options.seed),
      xip_(wheel_, bus_, flash_, reporter()),
      rom_(bus_.rom(), xip_.pins(), reporter(), options.rom_version),
      sio_(
          wheel_, gpio_, irqs_, [this] { return xip_.pins().inputs(); }, reporter()),
      system_(wheel_, gpio_, sio_, irqs_,
              {[this](int core, std::uint32_t irqs) {
                 cores_[static_cast<std::size_t>(core)].set_nmi_mask(irqs);
               },
               [this] { watchdog_fired(); }},
              reporter()),
      pio_dma_(wheel_, bus_, gpio_, irqs_, timing_, reporter()),
      usb_(wheel_, irqs_, usb_dpram_, reporter(), options.usb_errata),
      usb_pins_(gpio_, usb_),
      cores_{Core(0, bus_, wheel_, irqs_, timing_, reporter()),
             Core(1, bus_, wheel_, irqs_, timing_, reporter())},
      seed_(options.seed) {
  map();
  sio_.follow_cores([this](std::size_t core) { return cores_[core].cycle(); });
  rom_.on_bad_boot_block = [this] {
    note_at_core0(FaultKind::boot_block, FaultCause::boot_checksum);
  };
  system_.clocks.listen(*this);
  system_.ticks.listen(*this);
  clocks_changed();
  for (int id = 0; id < 2; ++id) attach_core(id);
  attach_gates();
}

NotModelled Chip::reporter() {
  return [this](const std::string& what) {
    if (known_.insert(what).second) not_modelled_.push_back(what);
  };
}

void Chip::note(Fault fault) {
  if (fault.cause == FaultCause::undefined_instruction && fault.pc == BootRom::fault_address)
    fault.cause = FaultCause::rom_access;
  for (const Fault& known : faults_)
    if (known.kind == fault.kind && known.core == fault.core) return;
  fault.at = wheel_.time_of(fault.cycle);
  faults_.push_back(fault);
}

void Chip::note_at_core0(FaultKind kind, FaultCause cause) {
  note({kind, cause, 0, 0, cores_[0].reg(15), cores_[0].reg(14), wheel_.now()});
}

void Chip::watchdog_fired() {
  ++watchdog_resets_;
  note_at_core0(FaultKind::watchdog, system_.watchdog.was_forced() ? FaultCause::watchdog_forced
                                                                   : FaultCause::watchdog_timer);
}

void Chip::map() {
  Resets& resets = system_.resets;
  system_.map(bus_, gpio_);
  system_.connect(pio_dma_.dreqs());
  xip_.connect(pio_dma_.dreqs());
  bus_.map_sio(sio_.core(0), sio_.core(1));
  system_.psm.attach(PsmBit::xip, [this](bool held) {
    if (held) xip_.reset();
  });
  bus_.map(io_qspi_base, resets.attach(ResetBit::io_qspi, xip_.pins().io()));
  bus_.map(pads_qspi_base, resets.attach(ResetBit::pads_qspi, xip_.pins().pads()));
  bus_.map(dma_base, resets.attach(ResetBit::dma, pio_dma_.dma()));
  bus_.map(pio0_base, resets.attach(ResetBit::pio0, pio_dma_.pio0()));
  bus_.map(pio1_base, resets.attach(ResetBit::pio1, pio_dma_.pio1()));
  bus_.map(UsbController::base, resets.attach(ResetBit::usbctrl, usb_));
  bus_.map_memory(UsbController::dpram_base, usb_dpram_, true);
  bus_.watch_memory(UsbController::dpram_base,
                    [this](std::uint32_t offset, std::uint32_t before, std::uint32_t after) {
                      usb_.dpram_stored(offset, before, after);
                    });
}

void Chip::attach_core(int id) {
  const auto i = static_cast<std::size_t>(id);
  Core& core = cores_[i];
  attach_rom(rom_, core, bus_);
  system_.psm.attach(id == 0 ? PsmBit::proc0 : PsmBit::proc1, [this, i](bool held) {
    held_[i] = held;
    if (!held) restart_[i] = true;
    for (Core& each : cores_) each.request_stop();
  });
  core.on_fault = [this](const Fault& fault) { note(fault); };
  core.on_reset_request = [this, i] {
    restart_[i] = true;
    cores_[i].request_stop();
  };
  core.on_event = [this, i] {
    if (!held_[1 - i]) cores_[1 - i].idle_to(cores_[i].cycle());
    cores_[1 - i].send_event();
    cores_[i].request_stop();
  };
  // While one core runs alone, a line change that it notices may wake the other one.
  core.on_lines_changed = [this, i](Cycle when) {
    Core& other = cores_[1 - i];
    if (held_[1 - i]) return;
    if (!other.idle()) return other.lines_changed(when);
    other.idle_to(wheel_.now());
    if (!other.idle()) wait_for_woken(1 - i);
  };
  core.on_deep_sleep = [this, i](bool asleep) {
    if (!asleep) return wake_up(cores_[i].cycle());
    may_sleep_ = true;
    if (runs_alone_ == &cores_[i]) cores_[i].request_stop();
  };
  core.on_woken = [this, i] {
    if (!held_[i] && runs_alone_ == &cores_[1 - i]) wait_for_woken(i);
  };
}

// The core that ran alone must not advance further ahead of the one that it has woken.
void Chip::wait_for_woken(std::size_t woken) {
  cores_[1 - woken].wait_for(&cores_[woken]);
  cores_[1 - woken].request_stop();
}

void Chip::attach_gates() {
  const auto attach = [this](ClockGate gate, ResetBit block, auto set_clock) {
    system_.clocks.on_gate(gate, [this, block, set_clock](bool runs) {
      system_.resets.set_clock(block, runs);
      set_clock(runs);
    });
  };
  attach(ClockGate::sys_dma, ResetBit::dma, [this](bool runs) { pio_dma_.set_dma_clock(runs); });
  attach(ClockGate::sys_pio0, ResetBit::pio0,
         [this](bool runs) { pio_dma_.set_pio_clock(0, runs); });
  attach(ClockGate::sys_pio1, ResetBit::pio1,
         [this](bool runs) { pio_dma_.set_pio_clock(1, runs); });
  pio_dma_.dma().on_idle = [this] {
    may_sleep_ = true;
    if (runs_alone_ != nullptr && runs_alone_->sleeping_deeply()) runs_alone_->request_stop();
  };
}

// Both cores sleep deeply, counting one that is held in reset, and the DMA is idle (2.11.2).
void Chip::fall_asleep() {
  may_sleep_ = false;
  const Core* last = nullptr;
  for (std::size_t i = 0; i < cores_.size(); ++i) {
    if (held_[i]) continue;
    if (!cores_[i].sleeping_deeply()) return;
    if (last == nullptr || last->cycle() < cores_[i].cycle()) last = &cores_[i];
  }
  if (asleep_ || last == nullptr || !pio_dma_.dma().idle()) return;
  // An event before then may wake a core.
  const Cycle at = std::max(last->cycle(), wheel_.now());
  for (std::size_t i = 0; i < cores_.size(); ++i) {
    if (held_[i]) continue;
    cores_[i].idle_to(at);
    if (!cores_[i].sleeping_deeply()) return;
  }
  wheel_.advance_to(at);
  asleep_ = true;
  system_.clocks.set_asleep(true);
}

void Chip::wake_up(Cycle at) {
  if (!asleep_) return;
  wheel_.advance_to(at);
  asleep_ = false;
  system_.clocks.set_asleep(false);
}

void Chip::clocks_changed() {
  usb_.set_usb_clock(system_.clocks.hz(Clock::usb));
  ticks_moved();
}

// The reference of SysTick (RP2040 datasheet, 2.4.8). Where a tick is not a whole number of cycles
// of clk_sys, SysTick counts the nearest.
void Chip::ticks_moved() {
  constexpr std::uint64_t many = 1000;
  const TickGenerator& ticks = system_.ticks;
  const Cycle next = ticks.cycle_of(ticks.ticks() + 1);
  const Cycle last = ticks.cycle_of(ticks.ticks() + 1 + many);
  const Cycle period = last == never_cycle ? 0 : (last - next + many / 2) / many;
  for (Core& core : cores_) core.systick().set_reference(period, next, wheel_.now());
}

void Chip::load(const Image& image, const std::string& where) {
  for (const ImagePart& part : image.parts) {
    std::span<std::uint8_t> memory;
    if (part.address >= flash_base && part.address < flash_limit) {
      const std::size_t offset = part.address - flash_base;
      if (offset < flash_.storage().size()) memory = flash_.storage().subspan(offset);
    } else {
      memory = bus_.memory_at(part.address);
    }
    if (memory.size() < part.bytes.size())
      throw std::runtime_error(where + ": " + std::to_string(part.bytes.size()) +
                               " bytes do not fit at " + hex(part.address) +
                               "; choose a larger flash or a smaller image");
    std::copy(part.bytes.begin(), part.bytes.end(), memory.begin());
  }
}

void Chip::lose_memory() {
  std::mt19937_64 noise(seed_ + wheel_.now());
  for (std::uint8_t& byte : bus_.sram()) byte = static_cast<std::uint8_t>(noise());
  for (std::uint8_t& byte : usb_dpram_) byte = static_cast<std::uint8_t>(noise());
}

void Chip::power_cut() {
  lose_memory();
  xip_.power_cut();
  system_.reset(ChipReset::power_on);
}

void Chip::brown_out() {
  if (!system_.vreg.brown_out_enabled()) return;
  lose_memory();
  system_.reset(ChipReset::brown_out);
}

void Chip::restart_cores() {
  for (std::size_t i = 0; i < cores_.size(); ++i) {
    if (!restart_[i] || held_[i]) continue;
    restart_[i] = false;
    wake_up(wheel_.now());
    if (i == 0) rom_.reset();
    cores_[i].reset(rom_vectors);
  }
}

void Chip::run_until(Cycle until) {
  for (;;) {
    restart_cores();
    if (halted_) {
      halted_ = false;
      return;
    }
    if (may_sleep_) fall_asleep();
    if (held_[0] && held_[1]) {
      wheel_.advance_to(std::min(until, wheel_.next()));
      if (wheel_.now() >= until) return;
      continue;
    }
    // The wheel does not move while cores run from memory.
    const Cycle reached = std::min(held_[0] ? never_cycle : cores_[0].cycle(),
                                   held_[1] ? never_cycle : cores_[1].cycle());
    if (reached >= until && (between_instructions() || reached - until >= patience)) {
      // The core with the lower cycle notices events first, as it does while both run.
      const std::size_t first = earlier_core();
      for (const std::size_t i : {first, 1 - first})
        if (!held_[i]) cores_[i].run_events(reached);
      // No further than any event that may have run within their last instructions.
      wheel_.advance_to(reached);
      return;
    }
    const Cycle limit = std::max(until, reached + 1);
    if (watcher_ == nullptr)
      run_both(limit);
    else if (!watched_step(limit))
      return;
  }
}

bool Chip::between_instructions() const {
  return (held_[0] || !cores_[0].paused()) && (held_[1] || !cores_[1].paused());
}

// The core that runs while the other one is idle or held; null: both run.
Core* Chip::lone() {
  for (std::size_t i = 0; i < cores_.size(); ++i)
    if (!held_[i] && (held_[1 - i] || cores_[1 - i].idle())) return &cores_[i];
  return nullptr;
}

std::size_t Chip::earlier_core() const { return cores_[0].cycle() <= cores_[1].cycle() ? 0 : 1; }

void Chip::run_both(Cycle until) {
  if (Core* core = lone()) {
    run_alone(*core, until);
    bring_along(1 - static_cast<std::size_t>(core->id()));
  } else {
    bus_.set_two_cores(true);
    Core::run_two(cores_[0], cores_[1], until);
  }
}

void Chip::run_alone(Core& core, Cycle until) {
  bus_.set_two_cores(false);
  core.wait_for(nullptr);
  runs_alone_ = &core;
  core.run_until(until);
  runs_alone_ = nullptr;
}

// Moves a sleeping core to the time of the other one, which handles due events first.
void Chip::bring_along(std::size_t sleeper) {
  if (!held_[sleeper] && !cores_[sleeper].idle()) return;
  Core& core = cores_[1 - sleeper];
  core.run_events(core.cycle());
  core.wait_for(nullptr);
  if (!held_[sleeper]) cores_[sleeper].idle_to(core.cycle());
}

// One step of run_both(), with the watcher.
bool Chip::watched_step(Cycle until) {
  const Core* alone = lone();
  bus_.set_two_cores(alone == nullptr);
  const std::size_t i = alone != nullptr ? static_cast<std::size_t>(alone->id()) : earlier_core();
  Core& core = cores_[i];
  if (alone == nullptr) core.wait_for(&cores_[1 - i]);
  bool runs = true;
  if (core.idle()) {
    const Cycle before = core.cycle();
    core.idle_to(until);
    if (core.cycle() == before && core.idle()) core.step();  // handles request_stop()
  } else if (core.cycle() < until) {
    core.run_events(core.cycle());
    if (core.owes())
      core.give_back();
    else if (core.paused() || (runs = watcher_->before_step(core)))
      core.step();
  }
  core.wait_for(nullptr);
  if (runs && cores_[1 - i].idle()) bring_along(1 - i);
  return runs;
}

}  // namespace lamplock::sim::chip
