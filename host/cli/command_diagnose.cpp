// `lamplock diagnose`: how well servo drives follow a program, by their encoders.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/drive_options.hpp"
#include "host/cli/validators.hpp"
#include "host/run/diagnose.hpp"

namespace lamplock::cli {
namespace {

using program_run::ServoErrors;
using program_run::ServoMachine;

struct DiagnoseOptions : run::DiagnoseOptions {
  bool json = false;
};

Json json_of(const ServoErrors& errors) {
  Json axes = Json::array();
  for (std::size_t a = 0; a < errors.axis.size(); ++a) {
    const program_run::ServoAxisErrors& axis = errors.axis[a];
    axes.push_back({{"axis", std::string(1, "XY"[a])},
                    {"max_positive_mm", axis.max_mm},
                    {"max_negative_mm", axis.min_mm},
                    {"rms_mm", axis.rms_mm},
                    {"max_pulses", axis.max_pulses},
                    {"end_pulses", axis.end_pulses},
                    {"programmed_end_mm", axis.programmed_end_mm},
                    {"measured_end_mm", axis.measured_end_mm}});
  }
  return {{"name", errors.name},
          {"moving_s", errors.moving_s},
          {"samples", errors.samples},
          {"beside_path_mm", errors.beside_mm},
          {"axes", axes}};
}

Json document(const DiagnoseOptions& options, const std::vector<ServoErrors>& rows) {
  const ServoMachine& m = options.machine;
  Json runs = Json::array();
  for (const ServoErrors& row : rows) runs.push_back(json_of(row));
  return {{"machine",
           {{"pulses_per_rev", m.drive.steps_per_rev},
            {"mm_per_rev", m.drive.mm_per_rev},
            {"counts_per_rev", m.drive.counts_per_rev},
            {"order", m.drive.order},
            {"time_constant_ms", m.drive.time_constant_ms},
            {"damping", m.drive.damping},
            {"accel_mm_s2", m.accel_mm_s2}}},
          {"trajectories", runs}};
}

Exit diagnose(const DiagnoseOptions& options) {
  Console console(options.json);
  console.document(document(options, run::diagnose(options, console)));
  return Exit::done;
}

}  // namespace

void add_diagnose(Command& program) {
  Command& app = program.add_command(
      "diagnose",
      "Run a program on simulated servo drives and report the following error at the encoders");
  app.footer(
      "Without PROGRAM, diagnose runs the two trajectories of a Polish paper on the programmed\n"
      "synchronisation of two AC servo drives. The default drives are the drives of that paper.\n"
      "Example:\n"
      "  lamplock diagnose part.ngc --time-constant 3 --picture errors.svg");
  const auto options = std::make_shared<DiagnoseOptions>();
  const Option& file =
      app.add_option("PROGRAM", &options->input,
                     "G-code program; it starts at X0 Y0; default: two trajectories of a paper")
          .value_name("FILE")
          .file(FileUse::read);
  app.add_option("--feed", &options->feed_mm_min,
                 "Feed rate of the two trajectories, without PROGRAM")
      .excludes(file)
      .check(number_from(0, false))
      .value_name("MM_MIN")
      .show_default();
  add_servo_drives(app, options->machine, "that of X");
  app.add_option("--accel", &options->machine.accel_mm_s2, "Acceleration of the machine")
      .check(number_from(0, false))
      .value_name("MM_S2")
      .show_default()
      .group("Drives");
  app.add_option("--picture", &options->picture,
                 "Write a picture (SVG) of the programmed and the measured path, and of the errors "
                 "of each axis over time")
      .value_name("FILE")
      .file(FileUse::write);
  app.add_json(options->json);
  app.action([options] { return diagnose(*options); });
}

}  // namespace lamplock::cli
