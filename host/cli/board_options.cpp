#include "host/cli/board_options.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "host/cli/board_names.hpp"
#include "host/cli/boards.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/report_folder.hpp"
#include "host/cli/staged_file.hpp"
#include "host/cli/validators.hpp"
#include "host/error.hpp"
#include "host/gpio/read_line_table.hpp"
#include "host/link/sender.hpp"
#include "host/report/statistics.hpp"
#include "host/units.hpp"
#include "sim/world/drive_settings.hpp"
#include "sim/world/lamp_settings.hpp"

namespace lamplock::cli {
namespace {

using settings::Id;

constexpr double percent = 0.01;
constexpr unsigned max_shots = 255;       ///< at one point, of the pulse stream
constexpr unsigned max_baud = 4'000'000;  ///< of what the kernel knows (termbits.h)
constexpr const char* lines_variable = "LAMPLOCK_LINES";
constexpr const char* board_group = "Board";
constexpr const char* lamp_group = "Lamp of a simulated board";
constexpr const char* drives_group = "Drives of a simulated board";

}  // namespace

void LampFaults::add(Command& app) {
  app.add_option("--jitter", &jitter_us, "Every flash early or late by up to this")
      .value_name("US")
      .group(lamp_group);
  app.add_option("--wander", &wander_percent, "Swing of the period, peak to peak, in 10 s")
      .value_name("PERCENT")
      .group(lamp_group);
  app.add_option("--dropouts", &dropouts_percent, "Flashes that are missing")
      .value_name("PERCENT")
      .group(lamp_group);
  app.add_option("--runts", &runts_percent, "Flashes with a pulse of noise beside them")
      .value_name("PERCENT")
      .group(lamp_group);
  app.add_option("--seed", &seed, "Another seed, other faults")
      .check(number_from(0, true))
      .value_name("N")
      .show_default()
      .group(lamp_group);
}

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

void SimulatedDrives::add(Command& app) {
  app.add_option("--drive-lag", &lag_us, "How late each axis follows its steps, X first")
      .count({0, max_axes})
      .check(number_in({0.0, settings::row(Id::drive_lag_x).max_milli / milli_per_unit}))
      .value_name("US,US,...")
      .group(drives_group);
}

sim::DriveConfig SimulatedDrives::drives(const settings::Values& values) const {
  sim::DriveConfig config = sim::drives_of(values);
  std::copy(lag_us.begin(), lag_us.end(), config.lag_us.begin());
  return config;
}

void BoardOptions::add_choice(Command& app) {
  app.add_option("--board", &board,
                 "virtual: the firmware core on a virtual clock, fast; chip: the flash image, "
                 "instruction by instruction; auto: the board that is plugged in; usb or "
                 "usb:SERIAL: its pulse stream; else a serial port or HOST:PORT")
      .value_name("virtual|chip|auto|usb|PORT")
      .show_default()
      .group(board_group);
  app.add_option("--image", &image, "Flash image for the chip; without it that of this build")
      .value_name("FILE")
      .group(board_group);
  app.add_option("--usb", &usb, "What the chip is talked to over: serial port or pulse stream")
      .check(one_of({"serial", "stream"}))
      .value_name("serial|stream")
      .show_default()
      .group(board_group);
  app.add_option("--baud", &baud, "Speed of a serial port [baud]; has no effect on USB")
      .check(number_in({1u, max_baud}))
      .value_name("BAUD")
      .show_default()
      .group(board_group);
  app.add_option("--lines", &lines,
                 "E-stop, door and interlock on lines of this computer (TOML), watched while a "
                 "real board works; else [lines] of the machine profile")
      .environment(lines_variable)
      .value_name("FILE")
      .group(board_group);
}

gpio::LineTable BoardOptions::line_table() const {
  if (is_simulated()) {
    // What stands in the environment is for every command, those without a board too.
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

void BoardOptions::add_board(Command& app) {
  add_choice(app);
  app.add_option("--yes", &yes, "Do not ask before the first shot").group(board_group);
  app.add_json(json).group(board_group);
}

void BoardOptions::add_job_speed(Command& app) {
  app.add_option(
         "--job-speed", &job_speed,
         "Speed of the job, 1 to 140; accelerations by its square, never above the machine's own")
      .check(number_in({1u, link::highest_job_speed}))
      .value_name("PERCENT")
      .show_default()
      .group(board_group);
}

void BoardOptions::add_part(Command& app) {
  app.add_option("--from", &from,
                 "Continue at this point or line: the first one not fired, with pauses counted as "
                 "points; of a program the line of the file, after an approach with the laser off")
      .check(number_from(0, true))
      .value_name("N")
      .group(board_group);
  app.add_option("--fired", &fired,
                 "Flashes of the point of --from that were fired before, 0 to 255")
      .check(number_in({0u, max_shots}))
      .value_name("N")
      .group(board_group);
}

void BoardOptions::add_resume(Command& app) {
  app.add_option("--resume", &resume,
                 "Continue the last run of this job, however it ended, where the machine or the "
                 "journal says; points that may have been fired are listed and left out")
      .group(board_group);
  app.add_option("--progress", &progress,
                 "Journal of the job on a real board; without it INPUT.progress")
      .check(file_name())
      .value_name("FILE")
      .group(board_group);
}

void BoardOptions::add_job(Command& app) {
  add_part(app);
  add_job_speed(app);
  app.add_option("--dry", &dry, "Move, never fire; of a program M3, M4 and S are left out")
      .group(board_group);
  app.add_option("--discard", &discard,
                 "Give up an unfinished job that the machine holds, and the last run of this job")
      .group(board_group);
  app.add_option("--auto-resume", &auto_resume,
                 "Continue after a hold or reset byte that this program did not send: for serial "
                 "lines whose noise may be such a byte; not needed on USB, which has check sums")
      .group(board_group);
  app.add_option("--hold-at", &hold_at,
                 "Hold for a second once so many points or lines are fired, counted from the "
                 "beginning of the job: to see the machine brake")
      .check(number_in({1u, std::numeric_limits<std::uint32_t>::max()}))
      .value_name("N")
      .group(board_group);
  app.add_option("--report", &report,
                 "Write report.html, report.json, shots.csv, shots.ply and cloud.png there")
      .check(file_name())
      .value_name("DIR")
      .group(board_group);
  app.add_option("--statistics", &statistics, "Add a line (CSV) about the job to this file")
      .check(file_name())
      .value_name("FILE")
      .group(board_group);
  app.add_option("--vcd", &vcd, "Trace of all pins of a simulated board, for GTKWave")
      .check(file_name())
      .value_name("FILE")
      .group(board_group);
  app.add_option("--shots", &shots, "What the laser of a simulated board fired, as CSV")
      .check(file_name())
      .value_name("FILE")
      .group(board_group);
  app.add_option("--timing", &timing, "Timing of the chip, cycle by cycle, and where they go")
      .check(file_name())
      .value_name("FILE")
      .group(board_group);
  plot.add(app, board_group);
  faults.add(app);
  drives.add(app);
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
  if (is_simulated()) refuse("a simulated board forgets its job", "begin anew, or give --from");
  if (dry) refuse("a dry run has no progress to continue", "leave out --resume or --dry");
  if (from != 0 || fired != 0)
    refuse("determines itself where to continue", "leave out --from and --fired");
}

void BoardOptions::check(const std::string& input, const std::string& save) const {
  check_board_name(board);
  std::vector<Output> all = outputs();
  all.push_back({"--save", save});
  check_distinct(all, input);
  if (!vcd.empty()) check_target(vcd);
  if (!shots.empty()) check_target(shots);
  if (!report.empty()) check_report_folder(report);
  if (!statistics.empty()) {
    check_target(statistics);
    report::check_statistics(statistics);
  }
  if (!timing.empty()) {
    if (board != chip_board)
      throw Error(Exit::bad_input, "--timing", "only the chip has cycles to count",
                  "leave it out, or use --board chip");
    check_target(timing);
  }
  if (usb != "serial" && board != chip_board)
    throw Error(Exit::bad_input, "--usb " + usb, "is about the simulated chip",
                "leave it out; a real board's pulse stream is --board usb");
  plot.check();
  if (plot.any() && board != virtual_board)
    throw Error(Exit::bad_input, "--plot", "only the virtual board tells what its ticks are",
                "leave it out, or use --board virtual");
  check_image(board, image);
  check_resume();
  line_table();
  if (is_simulated()) return;
  const auto only_simulated = [](const std::string& option) {
    throw Error(Exit::bad_input, option, "works on simulated boards only",
                "leave it out, or use --board virtual");
  };
  if (!vcd.empty()) only_simulated("--vcd");
  if (!shots.empty()) only_simulated("--shots");
  if (faults.any()) only_simulated("--jitter, --wander, --dropouts, --runts");
  if (drives.any()) only_simulated("--drive-lag");
  if (!dry && !yes && ::isatty(STDIN_FILENO) != 1)
    throw Error(Exit::bad_input, "--board " + board, "nobody is there to permit the first shot",
                "run it in a terminal, or give --yes or --dry");
}

}  // namespace lamplock::cli
