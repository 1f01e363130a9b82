#include "host/run/diagnose.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/program/servo_picture.hpp"
#include "host/run/sent_file.hpp"

namespace lamplock::run {
namespace {

using program_run::NamedServoRun;
using program_run::ServoErrors;

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
  require_program(options.input);
  return {{std::filesystem::path(options.input).filename().string(), read_file(options.input)}};
}

void check_picture(const std::string& picture) {
  if (picture.empty()) return;
  require_extension(picture, ".svg", "pictures of errors are written as SVG");
  check_target(picture);
}

}  // namespace

std::vector<ServoErrors> diagnose(const DiagnoseOptions& options, Frontend& frontend) {
  check_picture(options.picture);
  const double pulses_per_mm = options.machine.pulses_per_mm();
  std::vector<NamedServoRun> runs;
  std::vector<ServoErrors> rows;
  for (const Trajectory& trajectory : trajectories(options)) {
    const std::string& name = options.input.empty() ? trajectory.name : options.input;
    runs.push_back(
        {trajectory.name, program_run::run_on_servos(trajectory.text, options.machine, name)});
    rows.push_back(program_run::servo_errors(runs.back().run, pulses_per_mm, trajectory.name));
  }
  frontend.say("errors are programmed less measured, mm; a pulse is {:.4f} mm, a count {:.4f} mm",
               1 / pulses_per_mm,
               options.machine.drive.mm_per_rev / options.machine.drive.counts_per_rev);
  const double taken_for = runs.front().run.steps_per_mm;
  if (std::abs(taken_for / pulses_per_mm - 1) > 1e-9)
    frontend.say(
        "the setting $100 has three decimals: {:.3f} for {:.5f} pulses/mm, {:.4f} mm in 100 mm",
        taken_for, pulses_per_mm, 100 * (taken_for / pulses_per_mm - 1));
  frontend.text(program_run::servo_table(rows));
  if (!options.picture.empty()) {
    write_whole(options.picture, program_run::servo_svg(runs, 1 / pulses_per_mm));
    frontend.say("picture   {}", options.picture);
  }
  return rows;
}

}  // namespace lamplock::run
