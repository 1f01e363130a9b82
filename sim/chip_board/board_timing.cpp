#include "sim/chip_board/board_timing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numeric>

namespace lamplock::sim {
namespace {

using boards::Role;

/// The pattern that the image fills its stacks with (firmware/boards/rp2040/base/stack.hpp).
constexpr std::uint32_t stack_paint = 0x5aa55aa5;
constexpr std::uint32_t sram_base = 0x2000'0000;
constexpr std::uint32_t ram_total = 256 * 1024;

std::uint32_t address_of(const chip::Image& image, const char* name) {
  const chip::ImageSymbol* symbol = image.find(name);
  return symbol == nullptr ? 0 : symbol->address;
}

std::uint32_t stack_used(const std::span<std::uint8_t> stack) {
  std::size_t clean = 0;
  while (clean + sizeof stack_paint <= stack.size() &&
         std::memcmp(&stack[clean], &stack_paint, sizeof stack_paint) == 0)
    clean += sizeof stack_paint;
  return static_cast<std::uint32_t>(stack.size() - clean);
}

/// The image's use of an interrupt (firmware/boards/rp2040/base/interrupts.hpp).
std::string purpose(const std::string& name) {
  constexpr std::array<std::array<const char*, 2>, 5> purposes{{{"IO_BANK0", "e-stop"},
                                                                {"TIMER_1", "beat"},
                                                                {"PIO0_0", "lamp edge"},
                                                                {"USBCTRL", "USB"},
                                                                {"exception 42", "fill"}}};
  for (const auto& [irq, what] : purposes)
    if (name == irq) return what;
  return name;
}

template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), pattern, values...);
  return line.data();
}

}  // namespace

BoardTiming::BoardTiming(ChipBoard& board, const chip::Image& image)
    : board_(board),
      image_(image),
      calls_(board.chip().core(0), image.symbols),
      calls1_(board.chip().core(1), image.symbols),
      sync_gpio_(*boards::find_gpio(board.map(), Role::lamp_sync)),
      q_switch_gpio_(*boards::find_gpio(board.map(), Role::q_switch)),
      tick_gpio_(*boards::find_gpio(board.map(), Role::tick_line)),
      sync_inverted_((boards::inverted_pins(boards::pins(board.map())) >> sync_gpio_ & 1) != 0) {
  find_step_edges();
  board.chip().gpio().listen(static_cast<chip::PadListener&>(*this));
}

void BoardTiming::find_step_edges() {
  using settings::Id;
  using settings::PulseMode;
  const settings::Values values = board_.stored_settings();
  for (int axis = 0; axis < max_axes; ++axis) {
    const auto first = boards::find_gpio(board_.map(), boards::step_role(axis));
    const auto second = boards::find_gpio(board_.map(), boards::dir_role(axis));
    if (!first || !second) continue;
    const auto mode = static_cast<PulseMode>(values.whole(Id::pulse_mode_x, axis));
    const auto mark = [&](unsigned gpio, Id invert) {
      const bool active_low = (values.whole(invert) >> axis & 1) != 0;
      step_edges_[gpio][active_low ? 0 : 1] = true;
      if (mode == PulseMode::quadrature) step_edges_[gpio] = {true, true};
    };
    mark(*first, Id::step_invert);
    if (mode != PulseMode::step_dir) mark(*second, Id::direction_invert);
  }
}

void BoardTiming::pad_changed(unsigned gpio, bool level, chip::Cycle at) {
  Pad& pad = pads_[gpio];
  // The first edges come when the pin gets its function.
  if (step_edges_[gpio][level ? 1 : 0] && pads_[tick_gpio_].rises != 0) measure_steps(at);
  if (!level) {
    if (pad.rises != 0) pad.min_high = std::min(pad.min_high, at - pad.rose);
    pad.fell = at;
    return;
  }
  if (pad.rises != 0) pad.min_low = std::min(pad.min_low, at - pad.fell);
  ++pad.rises;
  pad.rose = at;
  if (gpio == q_switch_gpio_) {
    const Pad& sync = pads_[sync_gpio_];
    phases_.push_back(static_cast<std::int64_t>(at - (sync_inverted_ ? sync.fell : sync.rose)));
  }
}

void BoardTiming::measure_steps(chip::Cycle at) {
  const auto latency = static_cast<std::int64_t>(at - pads_[tick_gpio_].rose);
  if (first_step_) step_latency_ = latency;
  first_step_ = false;
  ++steps_;
  step_error_worst_ = std::max(step_error_worst_, std::abs(latency - step_latency_));
}

TimingTable BoardTiming::table(Picoseconds delay) const {
  TimingTable table;
  const double hz = static_cast<double>(board_.chip().wheel().frequency());
  table.cycle_ns = 1e9 / hz;
  table.shots = phases_.size();
  if (!phases_.empty()) {
    const double delay_ns = static_cast<double>(delay) / ps_per_ns;
    std::vector<double> off;
    for (const std::int64_t cycles : phases_)
      off.push_back(static_cast<double>(cycles) * table.cycle_ns - delay_ns);
    table.phase_mean_ns =
        std::accumulate(off.begin(), off.end(), 0.0) / static_cast<double>(off.size());
    for (double& each : off) each = std::abs(each);
    std::sort(off.begin(), off.end());
    table.phase_p999_ns = off[(off.size() - 1) * 999 / 1000];
    table.phase_worst_ns = off.back();
  }
  table.steps = steps_;
  table.step_error_worst_ns = static_cast<double>(step_error_worst_) * table.cycle_ns;
  const auto us = [&](double cycles) { return cycles * table.cycle_ns / 1000; };
  const double all = static_cast<double>(std::max<chip::Cycle>(profile_.cycles(), 1));
  for (const chip::ProfileEntry& entry : profile_.exceptions()) {
    const double load = static_cast<double>(entry.total) / all;
    table.interrupts.push_back({purpose(entry.name), entry.count, us(entry.mean()),
                                us(static_cast<double>(entry.longest)), load});
    table.interrupt_load += load;
  }
  table.max_masked_us = us(static_cast<double>(profile_.max_masked()));
  const auto& one = profile1_;
  table.planner_load = 1 - static_cast<double>(one.asleep()) /
                               static_cast<double>(std::max<chip::Cycle>(one.cycles(), 1));
  for (const std::size_t core : {0u, 1u}) {
    const std::string name = core == 0 ? "stack" : "second_stack";
    const std::uint32_t bottom = address_of(image_, (name + "_bottom").c_str());
    const std::uint32_t top = address_of(image_, (name + "_top").c_str());
    if (bottom >= top) continue;
    table.stacks[core].size = top - bottom;
    table.stacks[core].used = stack_used(board_.chip().bus().memory_at(bottom).first(top - bottom));
  }
  table.ram_used = address_of(image_, "bss_end") - sram_base + address_of(image_, "rings_end") -
                   address_of(image_, "rings_begin");
  table.ram_size = ram_total;
  table.flash_used = static_cast<std::uint32_t>(image_.size());
  table.flash_size = static_cast<std::uint32_t>(board_.chip().flash().storage().size());
  for (const boards::PinUse& use : boards::pins(board_.map())) {
    const Pad& pad = pads_[use.gpio];
    if (pad.rises == 0) continue;
    const auto ps = [&](chip::Cycle cycles) {
      return cycles == chip::never_cycle
                 ? never
                 : static_cast<Picoseconds>(static_cast<double>(cycles) * table.cycle_ns * 1000);
    };
    table.pins.push_back(
        {std::string(use.name), use.gpio, pad.rises, ps(pad.min_high), ps(pad.min_low)});
  }
  return table;
}

std::string timing_text(const TimingTable& t) {
  const auto kib = [](std::uint32_t bytes) { return bytes / 1024.0; };
  std::string text = "timing of the chip, cycle by cycle\n";
  text += format(
      "  shot phase: mean %.1f ns, p99.9 %.1f ns, worst %.1f ns from the set delay (%llu shots)\n",
      t.phase_mean_ns, t.phase_p999_ns, t.phase_worst_ns, static_cast<unsigned long long>(t.shots));
  text += format("  step edges: worst %.1f ns off the tick lattice (%llu steps)\n",
                 t.step_error_worst_ns, static_cast<unsigned long long>(t.steps));
  for (const TimingTable::Interrupt& each : t.interrupts)
    text += format("  interrupt %-14s mean %7.2f us, longest %7.2f us, %5.1f %% of the time\n",
                   each.name.c_str(), each.mean_us, each.max_us, 100 * each.load);
  text += format("  interrupts off: at most %.2f us\n", t.max_masked_us);
  text += format("  CPU load of interrupts: %.1f %%\n", 100 * t.interrupt_load);
  text += format("  planner (core 1): %.1f %% of the time\n", 100 * t.planner_load);
  text +=
      format("  RAM %.1f of %.0f KiB, flash %.1f of %.0f KiB, stacks %u of %u and %u of %u bytes\n",
             kib(t.ram_used), kib(t.ram_size), kib(t.flash_used), kib(t.flash_size),
             t.stacks[0].used, t.stacks[0].size, t.stacks[1].used, t.stacks[1].size);
  for (const PinEdges& pin : t.pins)
    text += format("  pin %-13s GPIO %2u: %9llu pulses, shortest high %8.3f us, low %8.3f us\n",
                   pin.name.c_str(), pin.gpio, static_cast<unsigned long long>(pin.rises),
                   pin.min_high == never ? 0.0 : static_cast<double>(pin.min_high) / ps_per_us,
                   pin.min_low == never ? 0.0 : static_cast<double>(pin.min_low) / ps_per_us);
  return text;
}

}  // namespace lamplock::sim
