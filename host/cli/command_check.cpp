// `lamplock check`: what a program of G-code does, without a machine.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/process_options.hpp"
#include "host/cli/validators.hpp"
#include "host/duration_text.hpp"
#include "host/run/check_program.hpp"
#include "host/run/program_refusal.hpp"
#include "shared/units.hpp"
#include "shared/work_space.hpp"

namespace lamplock::cli {
namespace {

using program_run::Problem;
using run::CheckedProgram;

struct CheckOptions : run::CheckOptions {
  bool json = false;
  run::ProcessChoice material;
};

std::string problem_text(const std::string& file, const Problem& p) {
  std::string text = fmt::format("{}:{}", file, p.line);
  if (p.column != 0) text += fmt::format(":{}", p.column);
  text += (p.error == 0 ? ": " : fmt::format(": error:{} ", p.error)) + p.text;
  return p.remedy.empty() ? text : text + "; " + p.remedy;
}

/// As a text has it, with three decimals; a value that rounds to 0 has no sign.
double shown_mm(double mm) { return std::round(mm * 1e3) / 1e3 + 0.0; }

void say_result(Console& console, const CheckedProgram& run) {
  console.say("time      {}", duration_text(run.seconds()));
  console.say("moves     {} from {} lines", run.moves, run.lines);
  console.say("feed      {:.3f} mm", run.feed_mm);
  console.say("rapid     {:.3f} mm", run.rapid_mm);
  for (int a = 0; a < run.axes; ++a)
    console.say("{}         {:.3f} to {:.3f} {}", axis_letters[index(a)],
                shown_mm(run.bounds.low[index(a)]), shown_mm(run.bounds.high[index(a)]),
                run.rotary && a == rotary_axis ? "degrees" : "mm");
  if (run.locked != 0) console.say("shots     {} on the beat", run.beats.shots);
  if (!run.ignored.empty())
    console.say("ignored   {}: no effect on this machine", fmt::join(run.ignored, ", "));
  if (!run.probe_logs.empty())
    console.say("logs      {}: written by lamplock send --probe-logs FOLDER",
                fmt::join(run.probe_logs, ", "));
  if (run.pauses != 0) console.say("pauses    {}, not included in the time", run.pauses);
}

Json document(const CheckOptions& options, const CheckedProgram& run) {
  Json low = Json::array(), high = Json::array(), problems = Json::array();
  for (int a = 0; a < run.axes; ++a) {
    low.push_back(run.bounds.low[index(a)]);
    high.push_back(run.bounds.high[index(a)]);
  }
  for (const Problem& p : run.problems)
    problems.push_back({{"line", p.line},
                        {"column", p.column},
                        {"error", p.error},
                        {"text", p.text},
                        {"remedy", p.remedy}});
  return {{"input", options.input},
          {"lines", run.lines},
          {"moves", run.moves},
          {"time_s", run.seconds()},
          {"feed_mm", run.feed_mm},
          {"rapid_mm", run.rapid_mm},
          {"low_mm", low},
          {"high_mm", high},
          {"rotary", run.rotary},
          {"pauses", run.pauses},
          {"shots", run.beats.shots},
          {"ended", run.ended},
          {"ignored", run.ignored},
          {"probe_logs", run.probe_logs},
          {"problems", problems}};
}

/// An error in an O-word or a value ends the check; scripts get it as the only problem.
CheckedProgram run_of(const CheckOptions& options, Console& console) {
  try {
    return run::check_program(options);
  } catch (const Error& error) {
    const auto problem = run::problem_of(error, options.input);
    if (!problem) throw;
    CheckedProgram run;
    run.problems.push_back(*problem);
    console.document(document(options, run));
    throw;
  }
}

Exit check(CheckOptions options) {
  Console console(options.json);
  options.process = run::process_values(options.material);
  if (options.process) console.say("material  {}", run::text_of(*options.process));
  const CheckedProgram run = run_of(options, console);
  for (const std::string& note : run.notes) console.notice(note);
  for (const Problem& p : run.problems) console.line(problem_text(options.input, p));
  say_result(console, run);
  if (!options.picture.empty()) console.say("picture   {}", options.picture);
  console.document(document(options, run));
  if (run.problems.empty()) return Exit::done;
  const bool more = run.problems.size() >= options.max_problems;
  throw Error(Exit::bad_input, options.input,
              fmt::format("{} {} wrong{}", run.problems.size(),
                          run.problems.size() == 1 ? "line is" : "lines are",
                          more ? ", and the check stopped there (--max-problems)" : ""),
              "correct the lines listed above");
}

}  // namespace

void add_check(Command& program) {
  Command& app = program.add_command(
      "check", "Check a G-code program: report errors, time and bounds, and draw its path");
  app.footer(
      "The interpreter and the planner of the firmware run the program, so the machine takes the\n"
      "time that is reported.\n"
      "The lengths (feed, rapid) are those that the machine travels: along the chords into which\n"
      "it divides arcs and splines ($12, arc_tolerance), a little less than the curves.\n"
      "Example:\n"
      "  lamplock check part.ngc --machine machine.toml --picture part.svg\n"
      "  lamplock check part.ngc --tools tools.ngc\n"
      "  lamplock check part.ngc --material plywood --thickness 5");
  const auto options = std::make_shared<CheckOptions>();
  app.add_option("PROGRAM", &options->input, "G-code program")
      .required()
      .value_name("FILE")
      .file(FileUse::read);
  add_machine(app, options->machine);
  app.add_option("--tools", &options->tools,
                 "Tool table of the machine for G43 H, G41 D and T: lines G10 L1 P Z R, or the "
                 "answer of the board to $#; default: no tools")
      .value_name("FILE")
      .file(FileUse::read)
      .group("Machine");
  add_process(app, options->material);
  add_user_commands(app, options->user_commands);
  app.add_option("--picture", &options->picture,
                 "Write a picture (SVG) of the path, coloured by laser power")
      .value_name("FILE")
      .file(FileUse::write);
  app.add_option("--max-problems", &options->max_problems, "Stop after this number of wrong lines")
      .check(number_in({1, 1'000'000}))
      .value_name("N")
      .show_default();
  app.add_json(options->json);
  app.action([options] { return check(*options); });
}

}  // namespace lamplock::cli
