#include "host/chip_tool/chip_summary.hpp"

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "host/chip_tool/chip_faults.hpp"
#include "host/chip_tool/chip_run.hpp"
#include "sim/chip/profile/profile.hpp"
#include "sim/chip/script/runner.hpp"
#include "sim/chip/script/script_time.hpp"

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

/// Violations of the USB protocol, from both ends of the cable.
std::vector<std::string> usb_violations(ChipRun& run) {
  const auto& device = run.chip().usb().violations();
  const auto& host = run.usb_host().violations();
  std::vector<std::string> all(device.begin(), device.end());
  all.insert(all.end(), host.begin(), host.end());
  return all;
}

/// Why the run ended, as a word of the JSON document.
const char* end_word(RunEnd end) {
  switch (end) {
    case RunEnd::script:
      return "script";
    case RunEnd::until:
      return "until";
    case RunEnd::default_limit:
      return "default_limit";
    case RunEnd::interrupt:
      return "interrupt";
    case RunEnd::terminated:
      return "terminated";
    case RunEnd::debugger:
      return "debugger";
  }
  return "";
}

std::string hertz(double hz) {
  if (hz >= 1e6) return fmt::format("{:.9g} MHz", hz / 1e6);
  if (hz >= 1e3) return fmt::format("{:.9g} kHz", hz / 1e3);
  return fmt::format("{:.9g} Hz", hz);
}

}  // namespace

std::string end_text(const RunResult& result) {
  const std::string limit = chip::script::time_text(result.limit);
  switch (result.end) {
    case RunEnd::script:
      return "end of the script";
    case RunEnd::until:
      return "--until " + limit + " reached";
    case RunEnd::default_limit:
      return "default limit of a script reached, " + limit;
    case RunEnd::interrupt:
      return "interrupted";
    case RunEnd::terminated:
      return "SIGTERM";
    case RunEnd::debugger:
      return "ended by the debugger";
  }
  return {};
}

chip::script::Failure open_step(const ChipRun& run, const RunResult& result) {
  // If a limit has ended the run, the last instructions may have ended after it.
  return run.script()->not_complete(std::min(run.now(), result.limit));
}

std::string chip_summary(ChipRun& run, const RunResult& result) {
  chip::Chip& chip = run.chip();
  const double wall_seconds = result.wall_seconds;
  std::string text = fmt::format("simulated {:.6f} s in {:.2f} s: {:.2f} x real time\n",
                                 sim::seconds(run.now()), wall_seconds, ratio(run, wall_seconds));
  text += "ended     " + end_text(result) + '\n';
  text +=
      fmt::format("cycles    core 0 {}, core 1 {}\n", chip.core(0).cycle(), chip.core(1).cycle());
  for (unsigned gpio = 0; gpio < chip::gpio_count; ++gpio) {
    const chip::PadCount& pad = run.pads().pads()[gpio];
    if (pad.edges() != 0) text += fmt::format("edges     gpio{:<3} {}\n", gpio, pad.edges());
  }
  for (const chip::Fault& fault : chip.faults())
    text += fmt::format("fault     {}{}\n", fault_text(run, fault),
                        run.allows(fault) ? " (allowed)" : "");
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

cli::Json chip_json(ChipRun& run, const RunResult& result) {
  chip::Chip& chip = run.chip();
  cli::Json json;
  json["simulated_ps"] = run.now();
  json["ended"] = end_word(result.end);
  json["cycles"] = {chip.core(0).cycle(), chip.core(1).cycle()};
  for (const auto& [name, clock] : clocks) json["clocks_hz"][name] = chip.system().clocks.hz(clock);
  json["pins"] = cli::Json::object();
  for (unsigned gpio = 0; gpio < chip::gpio_count; ++gpio) {
    const chip::PadCount& pad = run.pads().pads()[gpio];
    if (pad.edges() == 0) continue;
    json["pins"][fmt::format("gpio{}", gpio)] = {
        {"rises", pad.rises}, {"falls", pad.falls}, {"mean_hz", pad.hz()}};
  }
  json["faults"] = faults_json(run);
  json["watchdog_resets"] = chip.watchdog_resets();
  json["usb_violations"] = usb_violations(run);
  json["not_modelled"] = chip.not_modelled();
  if (const auto* script = run.script()) {
    const bool passed = script->done() && !script->failure();
    json["script"]["passed"] = passed;
    if (!passed) {
      const auto failure = script->failure() ? *script->failure() : open_step(run, result);
      json["script"]["line"] = failure.line;
      json["script"]["expected"] = failure.expected;
      json["script"]["seen"] = failure.seen;
      json["script"]["at_ps"] = failure.at;
    }
  }
  json["wall"] = {{"seconds", result.wall_seconds}, {"ratio", ratio(run, result.wall_seconds)}};
  return json;
}

}  // namespace lamplock::chip_tool
