#include "host/cli/board_options.hpp"

#include <limits>

#include "host/cli/validators.hpp"
#include "host/units.hpp"
#include "shared/units.hpp"
#include "shared/wire/job_header.hpp"

namespace lamplock::cli {
namespace {

using settings::Id;

constexpr unsigned max_shots = 255;  ///< at one point, of the pulse stream
constexpr double full_percent = 100;
constexpr double max_wander_percent = 50;  ///< of the simulated lamp (sim/world/lamp.cpp)
constexpr unsigned max_baud = 4'000'000;   ///< of what the kernel knows (termbits.h)
constexpr const char* board_group = "Board";
constexpr const char* lamp_group = "Lamp of a simulated board";
constexpr const char* drives_group = "Drives of a simulated board";

/// --plot and --plot-beats.
void add_plot(Command& app, run::PlotOptions& options, const char* group) {
  app.add_option("--plot", &options.file,
                 "Write a picture (SVG) of position, speed and acceleration over the beats of the "
                 "lamp; board virtual only")
      .value_name("FILE")
      .file(FileUse::write)
      .group(group);
  app.add_option("--plot-beats", &options.beats,
                 "Beats that --plot shows, counted from the first shot; default: the first 200")
      .count({2, 2})
      .value_name("FROM,TO")
      .group(group);
}

}  // namespace

void add_lamp_faults(Command& app, run::LampFaults& faults) {
  app.add_option("--jitter", &faults.jitter_us,
                 "Maximum deviation of each flash from its nominal time, at most an eighth of the "
                 "lamp period")
      .check(number_from(0, true))
      .value_name("US")
      .group(lamp_group);
  app.add_option("--wander", &faults.wander_percent,
                 "Slow variation of the lamp period, peak to peak, as a sine of 10 s")
      .check(number_in({0.0, max_wander_percent}))
      .value_name("PERCENT")
      .group(lamp_group);
  app.add_option("--dropouts", &faults.dropouts_percent, "Percentage of flashes that are missing")
      .check(number_in({0.0, full_percent}))
      .value_name("PERCENT")
      .group(lamp_group);
  app.add_option("--runts", &faults.runts_percent,
                 "Percentage of flashes with an added noise pulse")
      .check(number_in({0.0, full_percent}))
      .value_name("PERCENT")
      .group(lamp_group);
  app.add_option("--seed", &faults.seed, "Seed of the random faults")
      .check(number_from(0, true))
      .value_name("N")
      .show_default()
      .group(lamp_group);
}

void add_drives(Command& app, run::SimulatedDrives& drives) {
  app.add_option("--drive-lag", &drives.lag_us,
                 "Delay from a step to the motion of the axis, X first")
      .count({0, max_axes})
      .check(number_in({0.0, settings::row(Id::drive_lag_x).max_milli / milli_per_unit}))
      .value_name("US,US,...")
      .group(drives_group);
}

void add_spot(Command& app, run::SimulatedSpot& spot) {
  app.add_option(
         "--spot", &spot.numbers,
         "Simulate a spot that SENSOR measures: full power heats it by K in the end, with the "
         "time constant S; the sensor has V volts when cold and one more for each K_V")
      .check(number_in({-1e6, 1e6, true}))
      .count({run::SimulatedSpot::count, run::SimulatedSpot::count})
      .value_name("K,S,K_V,V")
      .group(drives_group);
}

void add_board_choice(Command& app, run::BoardOptions& options) {
  app.add_option("--board", &options.board,
                 "virtual: fast simulation; chip: cycle-accurate simulation of the flash image; "
                 "auto: the connected board; usb or usb:SERIAL: a board over its USB pulse stream; "
                 "otherwise a serial port or HOST:PORT")
      .value_name("virtual|chip|auto|usb|PORT")
      .show_default()
      .group(board_group)
      .common();
  app.add_option("--image", &options.image,
                 "Flash image for the chip; default: the image of this build")
      .value_name("FILE")
      .file(FileUse::read)
      .group(board_group);
  app.add_option("--usb", &options.usb,
                 "USB interface of the simulated chip: serial port or pulse stream")
      .check(one_of({"serial", "stream"}))
      .value_name("serial|stream")
      .show_default()
      .group(board_group);
  app.add_option("--baud", &options.baud,
                 "Baud rate of a serial port; a board with USB of its own ignores it")
      .check(number_in({1u, max_baud}))
      .value_name("BAUD")
      .show_default()
      .group(board_group);
  app.add_option(
         "--lines", &options.lines,
         "File (TOML) that assigns e-stop, door and interlock to GPIO lines of this computer; they "
         "are monitored while a real board runs; default: [lines] of the machine profile")
      .environment(run::lines_variable)
      .value_name("FILE")
      .file(FileUse::read)
      .group(board_group);
}

void add_board(Command& app, run::BoardOptions& options, bool& json) {
  add_board_choice(app, options);
  app.add_option("--yes", &options.yes, "Do not ask before the first shot")
      .group(board_group)
      .common();
  app.add_json(json).group(board_group);
}

void add_job_speed(Command& app, run::BoardOptions& options) {
  app.add_option("--job-speed", &options.job_speed,
                 "Job speed in percent; accelerations change with its square; the "
                 "machine's own limits still apply")
      .check(number_in({1u, wire::max_job_speed}))
      .value_name("PERCENT")
      .show_default()
      .group(board_group)
      .common();
}

void add_part(Command& app, run::BoardOptions& options) {
  const Option& from =
      app.add_option("--from", &options.from,
                     "Continue at this point or line, the first one that was not fired; pauses "
                     "count as points; programs: line of the file, reached with the laser off")
          .check(number_from(0, true))
          .value_name("N")
          .group(board_group)
          .common();
  app.add_option("--fired", &options.fired,
                 "Number of flashes already fired at the point of --from")
      .check(number_in({0u, max_shots}))
      .value_name("N")
      .needs(from)
      .group(board_group);
}

void add_resume(Command& app, run::BoardOptions& options) {
  app.add_option(
         "--resume", &options.resume,
         "Continue the last run of this job after any end, at the point that the machine or the "
         "progress journal reports; points that may have been fired are listed and skipped")
      .group(board_group)
      .common();
  app.add_option("--progress", &options.progress,
                 "Progress journal of the job on a real board; default: INPUT.progress")
      .value_name("FILE")
      .file(FileUse::write, ".progress")
      .group(board_group);
}

void add_job_run(Command& app, run::BoardOptions& options) {
  add_part(app, options);
  add_job_speed(app, options);
  app.add_option("--dry", &options.dry,
                 "Move without firing; M3, M4 and S of a program are not sent")
      .group(board_group)
      .common();
  app.add_option("--discard", &options.discard,
                 "Discard the unfinished job that the machine holds, and the progress of the last "
                 "run of this job")
      .group(board_group);
  app.add_option(
         "--auto-resume", &options.auto_resume,
         "Resume after a hold or reset byte that this program did not send, also if another "
         "program "
         "sent it; for serial cables where noise may produce such a byte; not needed on USB")
      .group(board_group);
  app.add_option("--hold-at", &options.hold_at,
                 "Hold for 1 s when this number of points or lines of the job is done, to test "
                 "braking; counted from the beginning of the job")
      .check(number_in({1u, std::numeric_limits<std::uint32_t>::max()}))
      .value_name("N")
      .group(board_group);
  app.add_option(
         "--report", &options.report,
         "Write report.html, report.json, shots.csv, shots.ply and cloud.png to this folder")
      .value_name("DIR")
      .file(FileUse::write_report)
      .group(board_group)
      .common();
  app.add_option("--statistics", &options.statistics,
                 "Append a line about the job to this CSV file")
      .value_name("FILE")
      .file(FileUse::write, ".csv")
      .group(board_group);
  app.add_option("--vcd", &options.vcd,
                 "Write a trace of all pins of a simulated board (VCD, for GTKWave)")
      .value_name("FILE")
      .file(FileUse::write, ".vcd")
      .group(board_group);
  app.add_option("--shots", &options.shots, "Write the laser shots of a simulated board (CSV)")
      .value_name("FILE")
      .file(FileUse::write, ".csv")
      .group(board_group);
  app.add_option("--timing", &options.timing,
                 "Write how many cycles each function of the firmware takes; board chip only")
      .value_name("FILE")
      .file(FileUse::write, ".txt")
      .group(board_group);
  add_plot(app, options.plot, board_group);
  add_lamp_faults(app, options.faults);
  add_drives(app, options.drives);
  add_spot(app, options.spot);
}

}  // namespace lamplock::cli
