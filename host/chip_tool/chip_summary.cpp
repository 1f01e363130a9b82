#include "host/chip_tool/chip_summary.hpp"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <array>
#include <utility>
#include <vector>

namespace lamplock::chip_tool {
namespace {

namespace chip = sim::chip;
using chip::Clock;

constexpr std::array<std::pair<const char*, Clock>, 6> clocks{{{"clk_ref", Clock::ref},
                                                               {"clk_sys", Clock::sys},
                                                               {"clk_peri", Clock::peri},
                                                               {"clk_usb", Clock::usb},
                                                               {"clk_adc", Clock::adc},
                                                               {"clk_rtc", Clock::rtc}}};

double ratio(ChipRun& run, double wall_seconds) {
  return wall_seconds > 0 ? sim::seconds(run.now()) / wall_seconds : 0;
}

/// What the USB has to complain about, from both ends of the cable.
std::vector<std::string> usb_violations(ChipRun& run) {
  const auto& device = run.chip().usb().violations();
  const auto& host = run.usb_host().violations();
  std::vector<std::string> all(device.begin(), device.end());
  all.insert(all.end(), host.begin(), host.end());
  return all;
}

std::string hertz(double hz) {
  if (hz >= 1e6) return fmt::format("{:.9g} MHz", hz / 1e6);
  if (hz >= 1e3) return fmt::format("{:.9g} kHz", hz / 1e3);
  return fmt::format("{:.9g} Hz", hz);
}

}  // namespace

std::string chip_summary(ChipRun& run, double wall_seconds) {
  chip::Chip& chip = run.chip();
  std::string text = fmt::format("simulated {:.6f} s in {:.2f} s: {:.2f} x real time\n",
                                 sim::seconds(run.now()), wall_seconds, ratio(run, wall_seconds));
  text +=
      fmt::format("cycles    core 0 {}, core 1 {}\n", chip.core(0).cycle(), chip.core(1).cycle());
  for (unsigned gpio = 0; gpio < chip::gpio_count; ++gpio) {
    const chip::PadCount& pad = run.pads().pads()[gpio];
    if (pad.edges() != 0) text += fmt::format("edges     gpio{:<3} {}\n", gpio, pad.edges());
  }
  if (chip.watchdog_resets() != 0)
    text += fmt::format("resets    {} by the watchdog\n", chip.watchdog_resets());
  for (const std::string& each : usb_violations(run)) text += "USB       " + each + '\n';
  for (const std::string& each : chip.not_modelled()) text += "not modelled: " + each + '\n';
  return text;
}

std::string chip_frequencies(ChipRun& run) {
  std::string text;
  for (const auto& [name, clock] : clocks)
    text += fmt::format("{:<9} {}\n", name,
                        hertz(static_cast<double>(run.chip().system().clocks.hz(clock))));
  for (unsigned gpio = 0; gpio < chip::gpio_count; ++gpio) {
    const chip::PadCount& pad = run.pads().pads()[gpio];
    if (pad.rises > 1)
      text += fmt::format("gpio{:<5} {} on average from the first to the last of {} rising edges\n",
                          gpio, hertz(pad.hz()), pad.rises);
  }
  return text;
}

cli::Json chip_json(ChipRun& run, double wall_seconds) {
  chip::Chip& chip = run.chip();
  cli::Json json;
  json["simulated_ps"] = run.now();
  json["cycles"] = {chip.core(0).cycle(), chip.core(1).cycle()};
  for (const auto& [name, clock] : clocks) json["clocks_hz"][name] = chip.system().clocks.hz(clock);
  json["pins"] = cli::Json::object();
  for (unsigned gpio = 0; gpio < chip::gpio_count; ++gpio) {
    const chip::PadCount& pad = run.pads().pads()[gpio];
    if (pad.edges() == 0) continue;
    json["pins"][fmt::format("gpio{}", gpio)] = {
        {"rises", pad.rises}, {"falls", pad.falls}, {"mean_hz", pad.hz()}};
  }
  json["watchdog_resets"] = chip.watchdog_resets();
  json["usb_violations"] = usb_violations(run);
  json["not_modelled"] = chip.not_modelled();
  if (const auto* script = run.script()) {
    const bool passed = script->done() && !script->failure();
    json["script"]["passed"] = passed;
    if (!passed) {
      const auto failure = script->failure() ? *script->failure() : script->standing();
      json["script"]["line"] = failure.line;
      json["script"]["expected"] = failure.expected;
      json["script"]["seen"] = failure.seen;
      json["script"]["at_ps"] = failure.at;
    }
  }
  json["wall"] = {{"seconds", wall_seconds}, {"ratio", ratio(run, wall_seconds)}};
  return json;
}

}  // namespace lamplock::chip_tool
