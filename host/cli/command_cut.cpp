// `lamplock cut`: a drawing becomes a program that cuts it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/board_options.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/documents.hpp"
#include "host/cli/parameter_options.hpp"
#include "host/cli/program_document.hpp"
#include "host/cli/validators.hpp"
#include "host/duration_text.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/description_file.hpp"
#include "host/number_text.hpp"
#include "host/run/cut.hpp"
#include "host/run/cut_drawing.hpp"
#include "host/run/report_folder.hpp"
#include "host/run/run_program.hpp"
#include "host/version.hpp"

namespace lamplock::cli {
namespace {

struct CutOptions {
  run::CutRequest request;
  std::string input;
  bool list = false, json = false;
  run::BoardOptions board;
  std::string report;                   ///< folder; empty: none
  std::vector<const Option*> choices;   ///< that a description has keys for
  std::vector<const Option*> of_board;  ///< that need --board

  CutOptions() {
    request.description.operations.resize(1);
    board.board.clear();
  }
};

/// What the options say, or the description that is given instead of a drawing.
run::CutRequest request_of(const CutOptions& options) {
  run::CutRequest request = options.request;
  request.description.drawing.file = options.input;
  if (!glass::is_description(options.input)) return request;
  for (const Option* option : options.choices)
    if (option->is_given())
      throw Error(Exit::bad_input, option->name(), "has its place in the description",
                  "leave it out and change " + options.input);
  request.description = run::read_cut_description(options.input);
  return request;
}

Json shape_json(const run::CutShape& shape) {
  return {{"layer", shape.layer},
          {"colour", shape.colour},
          {"kind", shape.kind},
          {"direction", shape.direction},
          {"length_mm", shape.length_mm},
          {"area_mm2", shape.area_mm2},
          {"bounds", bounds_json(shape.box)},
          {"operation", shape.operation},
          {"operation_kind", shape.operation_kind}};
}

Json cut_document(const CutOptions& options, const run::CutResult& result) {
  Json shapes = Json::array();
  for (const run::CutShape& shape : result.shapes) shapes.push_back(shape_json(shape));
  Json json = {{"input", options.input}, {"shapes", shapes}, {"warnings", result.warnings}};
  if (result.cuts == 0) return json;
  json["cuts"] = result.cuts;
  json["cut_mm"] = result.cut_mm;
  json["rapid_mm"] = result.rapid_mm;
  json["bounds"] = bounds_json(result.box);
  if (!options.request.output.empty())
    json["output"] = {{"file", options.request.output}, {"bytes", result.program.size()}};
  if (result.seconds) json["seconds"] = *result.seconds;
  return json;
}

/// How the machine has run the program, beside the plan.
void write_report(const CutOptions& options, const Json& document, const run::CutResult& result,
                  run::ProgramOutcome& outcome, run::ReportFolder& folder) {
  Json numbers = {{"version", version()},
                  {"board", options.board.board},
                  {"dry", options.request.is_dry},
                  {"frame", options.request.is_frame}};
  numbers.update(document);
  cutting::PlanPage page = result.report.page;
  const double seconds = std::chrono::duration<double>(outcome.result.elapsed).count();
  page.numbers.emplace_back("Board", options.board.board);
  page.numbers.emplace_back("End of the run", run::end_name(outcome));
  page.numbers.emplace_back("Time of the run", duration_text(seconds));
  page.numbers.emplace_back("Lines run",
                            fmt::format("{} of {}", outcome.result.executed, outcome.lines));
  folder.write_program(numbers.dump(2) + "\n", cutting::plan_page(page, result.report.operations),
                       outcome.lost);
}

void show_list(const run::CutResult& result, Console& console) {
  constexpr const char* row = "{:>5}  {:<16} {:<8} {:<8} {:<4} {:>11} {:>12}  {}";
  console.line(fmt::format(row, "shape", "layer", "colour", "kind", "turn", "length mm", "area mm2",
                           "operation"));
  for (std::size_t i = 0; i < result.shapes.size(); ++i) {
    const run::CutShape& shape = result.shapes[i];
    const std::string operation =
        shape.operation.empty() ? "none" : shape.operation_kind + ", " + shape.operation;
    console.line(fmt::format(row, i + 1, shape.layer.empty() ? "-" : shape.layer,
                             shape.colour.empty() ? "-" : shape.colour, shape.kind,
                             shape.direction.empty() ? "-" : shape.direction,
                             fmt::format("{:.3f}", shape.length_mm),
                             fmt::format("{:.3f}", shape.area_mm2), operation));
  }
}

Exit cut_drawing(const CutOptions& options) {
  Console console(options.json);
  run::CutRequest request = request_of(options);
  request.is_for_board = !options.board.board.empty();
  const bool makes = !request.output.empty() || !request.picture.empty() || !request.page.empty() ||
                     !request.save.empty() || request.is_for_board;
  if (!makes && !options.list) {
    check_is_file(request.description.drawing.file);
    run::require_drawing_name(request.description.drawing.file);
    throw Error(Exit::bad_input, "lamplock cut", "no output file is given",
                "give -o FILE.ngc, --picture FILE.svg, --page FILE.html, --board NAME or --list");
  }
  for (const Option* option : options.of_board)
    if (option->is_given() && !request.is_for_board)
      throw Error(Exit::bad_input, option->name(), "has no effect without a board",
                  "give --board NAME, or leave it out");
  const auto refuse_in_list = [makes](bool is_given, const char* option) {
    if (is_given && !makes)
      throw Error(Exit::bad_input, option, "has no effect on --list",
                  "give -o FILE.ngc or another output, or leave it out");
  };
  refuse_in_list(request.is_dry, "--dry");
  refuse_in_list(request.is_frame, "--frame");
  refuse_in_list(request.first != 1, "--from");
  // Before files are written.
  if (request.is_for_board)
    run::check_program_options(
        options.board, {options.input, request.output, request.picture, request.page, request.save},
        console);
  std::optional<run::ReportFolder> folder;
  request.has_report = !options.report.empty();
  if (request.has_report) {
    run::check_report_folder(options.report);
    folder.emplace(options.report);
  }
  const run::CutResult result =
      makes ? run::make_cut(request, console) : run::list_shapes(request.description, console);
  if (options.list) show_list(result, console);
  const bool has_document = options.json || request.has_report;
  Json document = has_document ? cut_document(options, result) : Json::object();
  if (!request.is_for_board) {
    console.document(document);
    return Exit::done;
  }
  run::ProgramOptions asked;
  asked.parts = {"cut", result.first_lines, result.cut_numbers};
  asked.machine.machine = request.description.machine.profile;
  run::ProgramOutcome outcome = run::run_program_text(
      request.description.drawing.file, result.program, options.board, asked, console);
  document["run"] = program_json(outcome);
  if (folder) write_report(options, document, result, outcome, *folder);
  console.document(document);
  return run::judge_program(outcome, options.board.board, console);
}

void add_choices(Command& app, CutOptions& options, std::vector<glass::Parameter> parameters,
                 const std::string& group) {
  // Those that most drawings need; the others refine them.
  constexpr std::array common{"--units", "--machine",   "--power",   "--feed",
                              "--kerf",  "--passes",    "--lead-in", "--tabs",
                              "--layer", "--operation", "--material"};
  // An operation that is alone needs no switch.
  std::erase_if(parameters, [](const glass::Parameter& p) { return p.option == "--off"; });
  for (Option* option : add_parameters(app, parameters, group)) {
    if (std::find(common.begin(), common.end(), option->name()) != common.end()) option->common();
    options.choices.push_back(option);
  }
}

void add_files(Command& app, CutOptions& options) {
  app.add_option("-o,--output", &options.request.output, "G-code program to write")
      .value_name("FILE.ngc")
      .file(FileUse::write)
      .common();
  app.add_option("--list", &options.list,
                 "Print the contours with layer, colour, length, area, direction, operation")
      .common();
  app.add_option("--picture", &options.request.picture,
                 "Write a picture (SVG) of what is cut: order, kerf, leads, tabs, rapids")
      .value_name("FILE.svg")
      .file(FileUse::write)
      .common();
  app.add_option("--page", &options.request.page,
                 "Write a page (HTML) that plays the plan over time and lists the time of each cut")
      .value_name("FILE.html")
      .file(FileUse::write)
      .common();
  app.add_option("--save", &options.request.save,
                 "Save the options of this command as a description, to run it again")
      .value_name("FILE.toml")
      .file(FileUse::write);
  app.add_option("--library", &options.request.library,
                 "Material library; default: that of lamplock material")
      .value_name("FILE")
      .file(FileUse::read);
}

}  // namespace

void add_cut(Command& program) {
  Command& app = program.add_command(
      "cut", "Cut a drawing with a continuous laser: make a G-code program of its contours");
  app.footer(
      "A description (TOML) has an operation for each layer or colour; --save writes one.\n"
      "Example:\n"
      "  lamplock cut parts.dxf --list\n"
      "  lamplock cut parts.dxf --power 80 --feed 600 --kerf 0.15 --lead-in line -o parts.ngc\n"
      "  lamplock cut parts.dxf --material plywood -o parts.ngc\n"
      "  lamplock cut parts.dxf --material plywood --board auto --frame\n"
      "  lamplock cut parts.dxf --material plywood --board auto");
  const auto options = std::make_shared<CutOptions>();
  run::CutDescription& description = options->request.description;
  app.add_option("DRAWING", &options->input, "Drawing (dxf, svg) or description of a job (toml)")
      .required()
      .value_name("FILE")
      .file(FileUse::read);
  add_files(app, *options);
  app.add_option("--from", &options->request.first,
                 "Begin with this cut, by its number in the picture, after a stop")
      .value_name("N")
      .check(number_in({1, 1e9, true}))
      .show_default();
  app.add_option("--dry", &options->request.is_dry,
                 "Make the program without light and air, to see its motion");
  app.add_option("--frame", &options->request.is_frame,
                 "Make a program that runs around the cuts instead, without light");
  std::vector<glass::Parameter> drawing = run::parameters(description.drawing);
  drawing.erase(drawing.begin());  // the file is DRAWING
  add_choices(app, *options, std::move(drawing), "Drawing");
  add_choices(app, *options, run::parameters(description.operations.front()), "Operation");
  add_choices(app, *options, run::parameters(description.machine), "Machine");
  add_board(app, options->board, options->json);
  app.add_option("--report", &options->report,
                 "Write report.html and report.json of the run to this folder: the page of --page, "
                 "the time and the end of the run")
      .value_name("DIR")
      .file(FileUse::write_report)
      .group("Board");
  constexpr std::array of_board{"--image", "--usb", "--baud", "--yes", "--report"};
  for (const Option& option : app.options())
    if (std::find(of_board.begin(), of_board.end(), option.name()) != of_board.end())
      options->of_board.push_back(&option);
  app.action([options] { return cut_drawing(*options); });
}

}  // namespace lamplock::cli
