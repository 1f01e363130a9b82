// `lamplock diagnose`: how well servo drives follow a program, by their encoders.
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/options.hpp"
#include "host/cli/staged_file.hpp"
#include "host/file.hpp"
#include "host/program/servo_run.hpp"
#include "host/report/servo_errors.hpp"
#include "host/report/servo_picture.hpp"

namespace lamplock::cli {
namespace {

using program_run::ServoMachine;
using report::NamedServoRun;
using report::ServoErrors;

struct DiagnoseOptions {
  std::string input{}, picture{};
  ServoMachine machine{};
  double feed_mm_min = 600;
  bool json = false;
};

struct Trajectory {
  std::string name, text;
};

/// Those of the paper: a line, and an arc the short way round.
std::vector<Trajectory> two_trajectories(double feed_mm_min) {
  using program_run::PlanePoint;
  constexpr PlanePoint from{0, 0}, line_end{100, 150}, arc_end{100, 120};
  constexpr double radius = 150;
  const char* code =
      program_run::arc_code(from, arc_end, program_run::centre_of(from, arc_end, radius));
  const std::string head = fmt::format("G21 G90 G94 F{:g}\n", feed_mm_min);
  return {{fmt::format("line to ({:g},{:g})", line_end[0], line_end[1]),
           fmt::format("{}G1 X{:g} Y{:g}\n", head, line_end[0], line_end[1])},
          {fmt::format("arc to ({:g},{:g}) R{:g}", arc_end[0], arc_end[1], radius),
           fmt::format("{}{} X{:g} Y{:g} R{:g}\n", head, code, arc_end[0], arc_end[1], radius)}};
}

std::vector<Trajectory> trajectories(const DiagnoseOptions& options) {
  if (options.input.empty()) return two_trajectories(options.feed_mm_min);
  return {{std::filesystem::path(options.input).filename().string(), read_file(options.input)}};
}

Json json_of(const ServoErrors& errors) {
  Json axes = Json::array();
  for (std::size_t a = 0; a < errors.axis.size(); ++a) {
    const report::ServoAxisErrors& axis = errors.axis[a];
    axes.push_back({{"axis", std::string(1, "XY"[a])},
                    {"max_positive_mm", axis.most_mm},
                    {"max_negative_mm", axis.least_mm},
                    {"rms_mm", axis.rms_mm},
                    {"most_pulses", axis.most_pulses},
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

void check_picture(const std::string& picture) {
  if (picture.empty()) return;
  if (lower_extension(picture) != ".svg")
    throw Error(Exit::bad_input, picture, "pictures of errors are written as SVG",
                "name it something.svg");
  check_target(picture);
}

Exit diagnose(const DiagnoseOptions& options) {
  Console console(options.json);
  check_picture(options.picture);
  const double pulses_per_mm = options.machine.pulses_per_mm();
  std::vector<NamedServoRun> runs;
  std::vector<ServoErrors> rows;
  for (const Trajectory& trajectory : trajectories(options)) {
    const std::string& name = options.input.empty() ? trajectory.name : options.input;
    runs.push_back(
        {trajectory.name, program_run::run_on_servos(trajectory.text, options.machine, name)});
    rows.push_back(report::servo_errors(runs.back().run, pulses_per_mm, trajectory.name));
  }
  console.say("errors are programmed less measured, mm; a pulse is {:.4f} mm, a count {:.4f} mm",
              1 / pulses_per_mm,
              options.machine.drive.mm_per_rev / options.machine.drive.counts_per_rev);
  const double taken_for = runs.front().run.steps_per_mm;
  if (std::abs(taken_for / pulses_per_mm - 1) > 1e-9)
    console.say(
        "the setting $100 has three decimals: {:.3f} for {:.5f} pulses/mm, {:.4f} mm in 100 mm",
        taken_for, pulses_per_mm, 100 * (taken_for / pulses_per_mm - 1));
  console.text(report::servo_table(rows));
  if (!options.picture.empty()) {
    write_whole(options.picture, [&](const std::filesystem::path& path) {
      write_file(path, report::servo_svg(runs, 1 / pulses_per_mm));
    });
    console.say("picture   {}", options.picture);
  }
  console.document(document(options, rows));
  return Exit::done;
}

void add_drives(Command& app, ServoMachine& machine) {
  const auto number = [&app](const char* name, double& value, const char* text, const char* unit) {
    app.add_option(name, &value, text)
        .check(number_from(0, false))
        .value_name(unit)
        .show_default()
        .group("Drives");
  };
  number("--pulses", machine.drive.steps_per_rev, "Pulses of a revolution", "N");
  number("--mm-per-rev", machine.drive.mm_per_rev, "What a revolution moves", "MM");
  number("--encoder", machine.drive.counts_per_rev, "Counts of the encoder, a revolution", "N");
  number("--time-constant", machine.drive.time_constant_ms, "Of the position loop", "MS");
  number("--damping", machine.drive.damping, "Of a loop of second order", "D");
  app.add_option("--order", &machine.drive.order, "Of the position loop")
      .check(number_in({1, 2}))
      .value_name("1|2")
      .show_default()
      .group("Drives");
  number("--accel", machine.accel_mm_s2, "Acceleration of the machine", "MM/S2");
}

}  // namespace

void add_diagnose(Command& program) {
  Command& app = program.add_command(
      "diagnose", "Run a program on simulated servo drives: what their encoders say of it");
  app.footer(
      "Without a program it runs the two trajectories of a Polish paper on the programmed\n"
      "synchronisation of two AC servo drives, whose machine is the default.\n"
      "Example:\n  lamplock diagnose part.ngc --time-constant 3 --picture errors.svg");
  const auto options = std::make_shared<DiagnoseOptions>();
  app.add_option("PROGRAM", &options->input, "G-code; begins at zero").value_name("FILE");
  app.add_option("--feed", &options->feed_mm_min, "Of the two trajectories")
      .check(number_from(0, false))
      .value_name("MM/MIN")
      .show_default();
  add_drives(app, options->machine);
  app.add_option("--picture", &options->picture, "Picture (SVG) of paths and errors")
      .check(file_name())
      .value_name("FILE");
  app.add_json(options->json);
  app.action([options] { return diagnose(*options); });
}

}  // namespace lamplock::cli
