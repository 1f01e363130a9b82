#include "host/run/board_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "host/error.hpp"
#include "host/file/staged_file.hpp"
#include "host/gpio/read_line_table.hpp"
#include "host/report/statistics.hpp"
#include "host/run/board_names.hpp"
#include "host/run/report_folder.hpp"
#include "host/run/simulated_boards.hpp"
#include "host/units.hpp"
#include "sim/world/drive_settings.hpp"
#include "sim/world/lamp_settings.hpp"

namespace lamplock::run {
namespace {

constexpr double percent = 0.01;

}  // namespace

bool LampFaults::any() const {
  return jitter_us != 0 || wander_percent != 0 || dropouts_percent != 0 || runts_percent != 0;
}

sim::LampConfig LampFaults::lamp(const settings::Values& values) const {
  sim::LampConfig config = sim::lamp_of(values);
  config.jitter_us = jitter_us;
  config.wander = wander_percent * percent;
  config.dropout = dropouts_percent * percent;
  config.runt = runts_percent * percent;
  config.seed = seed;
  try {
    sim::PinBus bus;
    const sim::Lamp trial(config, bus);
  } catch (const std::invalid_argument& error) {
    throw Error(Exit::bad_input, "simulated lamp", error.what(),
                "check --lamp, --jitter, --wander, --dropouts and --runts");
  }
  return config;
}

sim::DriveConfig SimulatedDrives::drives(const settings::Values& values) const {
  sim::DriveConfig config = sim::drives_of(values);
  std::copy(lag_us.begin(), lag_us.end(), config.lag_us.begin());
  return config;
}

std::optional<sim::HeatConfig> SimulatedSpot::heat(const settings::Values& values) const {
  if (!any()) return std::nullopt;
  const sim::HeatConfig config{.gain_k = numbers[0],
                               .time_constant_s = numbers[1],
                               .volts_at_rest = numbers[3],
                               .kelvin_per_volt = numbers[2],
                               .steps_per_mm = in_units(values, settings::Id::steps_per_mm_x)};
  const bool is_volts =
      config.volts_at_rest >= 0 && config.volts_at_rest <= sim::HeatSensor::reference_volts;
  if (config.gain_k > 0 && config.time_constant_s > 0 && config.kelvin_per_volt != 0 && is_volts)
    return config;
  throw Error(Exit::bad_input, "--spot", "these numbers describe no spot and no sensor",
              "give its rise at full power and its time constant, above 0, the rise per volt, not "
              "0, and 0 to 3.3 V: --spot 500,0.05,200,0.5");
}

gpio::LineTable BoardOptions::line_table() const {
  if (is_simulated()) {
    // The environment variable is for every command, also for those without a real board.
    const char* const every_command = std::getenv(lines_variable);
    if (!lines.empty() && (every_command == nullptr || lines != every_command))
      throw Error(Exit::bad_input, "--lines", "a simulated board has no lines of this computer",
                  "leave it out, or give the real board with --board");
    return {};
  }
  if (!lines.empty()) return gpio::read_line_table(lines);
  return profile.empty() ? gpio::LineTable{} : gpio::read_machine_lines(profile);
}

sim::chip::UsbFunction BoardOptions::usb_function() const {
  return usb == "stream" ? sim::chip::UsbFunction::vendor : sim::chip::UsbFunction::serial;
}

std::vector<Output> BoardOptions::outputs() const {
  std::vector<Output> all{{"--vcd", vcd},           {"--shots", shots},
                          {"--timing", timing},     {"--plot", plot.file},
                          {"--progress", progress}, {"--statistics", statistics}};
  for (const std::filesystem::path& file : files_of_report(report))
    all.push_back({"--report", file.string()});
  return all;
}

void BoardOptions::check_resume() const {
  if (!progress.empty()) check_target(progress);
  const auto refuse = [](const char* what, const char* remedy) {
    throw Error(Exit::bad_input, "--resume", what, remedy);
  };
  if (!resume) return;
  if (is_simulated()) refuse("a simulated board forgets its job", "leave it out, or give --from");
  if (dry) refuse("a dry run has no progress to continue", "leave out --resume or --dry");
  if (from != 0 || fired != 0)
    refuse("determines itself where to continue", "leave out --from and --fired");
}

void BoardOptions::check_timing() const {
  if (timing.empty()) return;
  if (board != chip_board)
    throw Error(Exit::bad_input, "--timing", "only the chip has cycles to count",
                "leave it out, or use --board chip");
  check_target(timing);
}

void BoardOptions::check_simulated_only() const {
  const std::array<std::pair<const char*, bool>, 5> of_simulation{
      {{"--vcd", !vcd.empty()},
       {"--shots", !shots.empty()},
       {"--jitter, --wander, --dropouts, --runts", faults.any()},
       {"--drive-lag", drives.any()},
       {"--spot", spot.any()}}};
  for (const auto& [option, is_given] : of_simulation)
    if (is_given && !is_simulated())
      throw Error(Exit::bad_input, option, "works on simulated boards only",
                  "leave it out, or use --board virtual");
}

void BoardOptions::check(const std::vector<std::string>& inputs, const std::string& save) const {
  check_board_name(board);
  std::vector<Output> all = outputs();
  all.push_back({"--save", save});
  check_distinct(all, inputs);
  if (!vcd.empty()) check_target(vcd);
  if (!shots.empty()) check_target(shots);
  if (!report.empty()) check_report_folder(report);
  if (!report.empty() && (from != 0 || fired != 0 || resume)) refuse_first_part(report);
  if (!statistics.empty()) {
    check_target(statistics);
    report::check_statistics(statistics);
  }
  check_timing();
  if (usb != "serial" && board != chip_board)
    throw Error(Exit::bad_input, "--usb " + usb, "applies only to the simulated chip",
                "leave it out; a real board's pulse stream is --board usb");
  plot.check();
  if (plot.any() && board != virtual_board)
    throw Error(Exit::bad_input, "--plot", "only the virtual board records its ticks",
                "leave it out, or use --board virtual");
  check_image(board, image);
  check_resume();
  line_table();
  check_simulated_only();
}

}  // namespace lamplock::run
