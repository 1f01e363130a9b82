#include "host/serve/method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace lamplock::serve {
namespace {

using Json = nlohmann::json;

constexpr double max_feed = 1'000'000, max_items = 4e9, max_time = 1e15;
constexpr double max_record_name = 100, max_thickness_mm = 1000;
constexpr double max_file_name = 100, max_line_text = 250, max_secret_text = 64;
/// A step is completed when its client has gone: it is short.
constexpr double max_step_mm = 10;
constexpr double max_place_mm = 100'000, max_listed_objects = 32;

constexpr std::array login_parameters{
    Parameter{"token", Type::text, true, 1, max_secret_text, nullptr,
              "from the address that `serve` prints"},
    Parameter{"client", Type::text, true, 16, max_secret_text, nullptr,
              "random text that the client keeps: it is recognised by it after a new connection"},
    Parameter{"name", Type::text, false, 0, 40, nullptr, "what others see"}};
constexpr std::array pair_parameters{
    Parameter{"code", Type::text, true, 6, 6, nullptr, "printed by `serve --pair`"}};
constexpr std::array feed_parameters{
    Parameter{"change", Type::text, true, 0, 0, "more|less|full", "by 10 %, or to 100 %"}};
constexpr Parameter file_name{"name", Type::text, true, 1, max_file_name, nullptr, "file"};
constexpr std::array file_parameters{file_name};
constexpr Parameter material{"material",
                             Type::text,
                             false,
                             1,
                             max_record_name,
                             nullptr,
                             "name in the material library; only for programs that read process "
                             "parameters (`#<_material_feed>`)"},
    laser{"laser",
          Type::text,
          false,
          1,
          max_record_name,
          nullptr,
          "laser of the setting; default: the only laser that has a setting"},
    operation{"operation", Type::text, false, 0, 0, "cut|score|engrave", "default: cut"},
    thickness{"thickness",
              Type::number,
              false,
              0.001,
              max_thickness_mm,
              nullptr,
              "thickness in mm; default: the thickness of the material"};
constexpr std::array program_parameters{file_name, material, laser, operation, thickness};
constexpr std::array start_parameters{
    file_name,
    material,
    laser,
    operation,
    thickness,
    Parameter{"dry", Type::flag, false, 0, 0, nullptr, "moves with the laser off"},
    Parameter{"resume", Type::flag, false, 0, 0, nullptr,
              "continues the last run of a job; no point is fired twice"},
    Parameter{"from", Type::whole, false, 0, max_items, nullptr,
              "point, or line of a program, to begin at"},
    Parameter{"revision", Type::text, false, 1, max_line_text, nullptr,
              "of `job.check`: the job is refused if its file has changed since"}};
constexpr std::array zero_parameters{Parameter{"axes", Type::text, true, 0, 0, "X|Y|Z|XY|XYZ",
                                               "axes whose work position becomes 0"}};
constexpr std::array send_parameters{
    Parameter{"line", Type::text, true, 1, max_line_text, nullptr, "G-code or a `$` command"}};
constexpr std::array lines_parameters{
    Parameter{"after", Type::whole, false, 0, max_time, nullptr, "number of the last line known"}};
constexpr Parameter seen_time{
    "seen",
    Type::whole,
    true,
    0,
    max_time,
    nullptr,
    "`time` of the last notification: an old request does not move the machine"};
constexpr std::array run_parameters{
    Parameter{"direction", Type::numbers, true, -1, 1, nullptr,
              "-1, 0 or 1 for each axis, X first"},
    Parameter{"feed", Type::number, true, 1, max_feed, nullptr, "mm/min"}, seen_time};
constexpr std::array step_parameters{
    Parameter{"axis", Type::whole, true, 0, 3, nullptr, "0 is X"},
    Parameter{"mm", Type::number, true, -max_step_mm, max_step_mm, nullptr, "distance"},
    Parameter{"feed", Type::number, true, 1, max_feed, nullptr, "mm/min"}};
constexpr std::array go_parameters{
    Parameter{"x", Type::number, false, -max_place_mm, max_place_mm, nullptr, "machine, mm"},
    Parameter{"y", Type::number, false, -max_place_mm, max_place_mm, nullptr, "machine, mm"},
    Parameter{"z", Type::number, false, -max_place_mm, max_place_mm, nullptr, "machine, mm"},
    Parameter{"feed", Type::number, true, 1, max_feed, nullptr, "mm/min"}, seen_time};
constexpr std::array renew_parameters{seen_time};
constexpr Parameter macro_name{"name", Type::text, true, 1, 40, nullptr, "macro"};
constexpr std::array macro_parameters{macro_name};
constexpr std::array set_macro_parameters{macro_name,
                                          Parameter{"lines", Type::text, true, 1, 4000, nullptr,
                                                    "1 to 50 lines, separated by line feeds"}};
constexpr std::array camera_parameters{
    Parameter{"points", Type::objects, true, 4, 4, nullptr,
              "four objects: `u`, `v` (place in the picture, 0 to 1 from the left and the top) and "
              "`x`, `y` (of the machine, mm)"}};
constexpr std::array set_parameters{
    Parameter{"changes", Type::object, true, 0, 0, nullptr, "values by name of the setting"}};

constexpr Parameter cloud_number{
    "cloud", Type::whole, true, 0, max_time, nullptr, "its number, from `cloud.open`"};
constexpr std::array cloud_parameters{
    cloud_number, Parameter{"from", Type::whole, true, 0, max_items, nullptr, "first point"}};
constexpr std::array near_parameters{
    cloud_number,
    Parameter{"at", Type::place, true, -max_place_mm, max_place_mm, nullptr,
              "a place on the line of sight, mm"},
    Parameter{"along", Type::place, true, -1, 1, nullptr, "its direction"},
    Parameter{"mm", Type::number, true, 0, max_place_mm, nullptr, "distance from the line"}};

constexpr std::array scene_parameters{
    Parameter{"name", Type::text, true, 1, max_file_name, nullptr, "description to write, .toml"},
    Parameter{"from", Type::text, false, 1, max_file_name, nullptr,
              "description or model whose other parameters are kept; default: the same"},
    Parameter{"objects", Type::objects, true, 1, max_listed_objects, nullptr,
              "all objects: `object` (its number in `from`, from 0) or `file`; `mirror`, `scale`, "
              "`turn`, `move`, `size`"},
    Parameter{"block", Type::place, false, 0.001, max_place_mm, nullptr, "sides of the block, mm"}};

constexpr std::span<const Parameter> none;
constexpr std::array table{
    Method{"login", Right::all, login_parameters, "Must be the first message of a WebSocket.",
           "`version`, `board`, `simulated`, `paired`"},
    Method{"pair", Right::all, pair_parameters,
           "Gives this client the right `firing` on a real board. Five wrong codes end it.",
           "nothing"},
    Method{"status", Right::all, none, "The whole status.", "`board`, `job`, `control`"},
    Method{"subscribe", Right::all, none,
           "From now on notifications `status` bring what differs, and `console` the new lines.",
           "the whole status"},
    Method{"control.take", Right::all, none,
           "Takes control, also from another client, which is notified.", "nothing"},
    Method{"control.release", Right::control, none, "Gives control up.", "nothing"},
    Method{"machine.stop", Right::all, none,
           "Stops whatever runs: laser off, then the machine brakes. Never asks.", "nothing"},
    Method{"machine.hold", Right::all, none, "Holds the machine.", "nothing"},
    Method{"machine.resume", Right::firing, none, "Resumes after a hold.", "nothing"},
    Method{"machine.feed", Right::control, feed_parameters,
           "Changes the feed override of a program or the speed of a job.", "nothing"},
    Method{"machine.home", Right::control, none, "Homes the machine (`$H`).", "nothing"},
    Method{"machine.zero", Right::control, zero_parameters,
           "Makes this place the zero of the work coordinates (`G10 L20 P0`).", "nothing"},
    Method{"machine.unlock", Right::control, none, "Ends an alarm (`$X`).", "nothing"},
    Method{"machine.area", Right::all, none,
           "The work space of the machine: the travel of the board by its settings.",
           "its two corners, mm"},
    Method{"job.list", Right::all, none, "Files that were sent to the server.",
           "list of `name`, `bytes`, `kind` (job, program, model, description)"},
    Method{"job.check", Right::all, program_parameters,
           "Runs a program, or reads a job, without the machine.",
           "`kind`, `revision` (of the file), `seconds`, `problems`, `bounds` (mm; degrees of A if "
           "`rotary` is true), `picture` (SVG), `points` or `lines`; of a "
           "program with process parameters `material`: values of the chosen setting (`title`, "
           "`feed`, "
           "`power`, `passes`, `air`, `kerf`, `frequency`, `thickness`), or null"},
    Method{"job.start", Right::firing, start_parameters,
           "Runs a job or a program. A dry run needs no pairing.", "nothing"},
    Method{"job.make", Right::control, file_parameters,
           "Makes a job of a description or a model: the same name with `.llj`.",
           "`name` of the job, `points`, `notices`"},
    Method{"job.delete", Right::control, file_parameters, "Removes a file.", "nothing"},
    Method{
        "path.open", Right::all, program_parameters,
        "Sends the path of a program or of rows as a binary message, before the result.",
        "`places`, `bounds`, `area` (of the machine); the message has two zeros of 32 bits, then "
        "for each place x, y, z (16 bits, 0 to 65535 in the bounds) and twice its share of the "
        "lines (0 to 32767), 1 more for a rapid"},
    Method{"cloud.open", Right::all, file_parameters,
           "Reads the points of a job, to draw them; rows have none.",
           "`cloud` (its number), `points`, `shown`, `bounds`, `area` (of the machine)"},
    Method{"cloud.points", Right::all, cloud_parameters,
           "Sends a binary message with up to 65 536 of the shown points, before the result.",
           "`count` of points in the message"},
    Method{"cloud.near", Right::all, near_parameters,
           "The exact points near a line of sight, at most 400, nearest first.",
           "list of `number`, `place` (mm)"},
    Method{
        "scene.open", Right::all, file_parameters,
        "Reads a description or a model, to place its objects. Each has a cloud for "
        "`cloud.points`: a sketch of it before its placement.",
        "`objects` (`file`, `size`, `kept`, `mirror`, `scale`, `turn`, `move`, `cloud`, `shown`, "
        "`bounds`), `block` or null, `area`, `middle`"},
    Method{"scene.write", Right::control, scene_parameters,
           "Writes a description with these objects, after it was read back.", "nothing"},
    Method{"console.send", Right::firing, send_parameters,
           "Sends a line; while a program waits for a tool, after the answer to the line before. "
           "The answer comes with the lines of the console.",
           "nothing"},
    Method{"console.lines", Right::all, lines_parameters, "The last lines of the console.",
           "list of `number`, `text`"},
    Method{"macro.list", Right::all, none, "Named lines that the server keeps for the console.",
           "object: lines by name"},
    Method{"macro.set", Right::firing, set_macro_parameters, "Adds or replaces a macro.",
           "nothing"},
    Method{"macro.remove", Right::control, macro_parameters, "Removes a macro.", "nothing"},
    Method{"macro.run", Right::firing, macro_parameters,
           "Sends all lines of a macro, one after the other; in a tool change only a macro of one "
           "line.",
           "nothing"},
    Method{"history.list", Right::all, none, "The last 100 jobs and programs, newest first.",
           "list of `file`, `board`, `begin`, `end` (UTC), `result`, `message`, `dry`, `done` of "
           "`total`, `item`, `wasted_beats` (of points, or null), `report` (the page at "
           "/reports/NAME, or "
           "null)"},
    Method{"material.list", Right::all, none, "The settings of the material library.",
           "list of `material`, `laser`, `operation`, `thickness` (mm or null), `feed` (mm/min), "
           "`power` (W), `passes`, `kerf` (mm or null), `note`"},
    Method{"camera.get", Right::all, none,
           "Whether the server has a camera; its newest picture is at `GET /camera`.",
           "`camera` (true or false), `points` of its calibration, or null"},
    Method{"camera.calibrate", Right::control, camera_parameters,
           "Stores the calibration: four points, no three of them on one line.", "nothing"},
    Method{
        "jog.run", Right::control, run_parameters,
        "Moves at a feed for 200 ms; a client repeats it while a key is held. After a stop of "
        "another client it is refused until `jog.stop`, or until no request has come for 200 ms.",
        "nothing"},
    Method{"jog.step", Right::control, step_parameters,
           "Moves one step; in a tool change of a program too.", "nothing"},
    Method{"jog.go", Right::control, go_parameters,
           "Begins to move along a straight line to a place, from rest, for 200 ms; axes that are "
           "not given stay. A place outside of the travel of a board with soft limits is refused.",
           "nothing"},
    Method{"jog.renew", Right::control, renew_parameters,
           "Continues the motion of `jog.go` for 200 ms; a client repeats it until `board.jogs` is "
           "false. After a stop it does nothing.",
           "nothing"},
    Method{"jog.stop", Right::all, none, "Ends a jog.", "nothing"},
    Method{"settings.get", Right::all, none, "The settings of the board, at rest.",
           "list of `number`, `name`, `unit`, `min`, `max`, `whole`, `default`, `value`, `about`"},
    Method{"settings.set", Right::firing, set_parameters,
           "Changes settings, all or none, and reads them back.", "the changed settings"}};

constexpr std::array type_names{"text",          "number",          "whole number",
                                "true or false", "list of numbers", "list of three numbers",
                                "object",        "list of objects"};
const char* type_name(Type type) { return type_names[static_cast<std::size_t>(type)]; }

bool is_in(const Json& value, const Parameter& parameter) {
  const double number = value.get<double>();
  return number >= parameter.min && number <= parameter.max;
}

bool is_choice(const std::string& text, std::string_view choices) {
  for (std::size_t begin = 0;;) {
    const std::size_t end = std::min(choices.find('|', begin), choices.size());
    if (choices.substr(begin, end - begin) == text) return true;
    if (end == choices.size()) return false;
    begin = end + 1;
  }
}

bool is_right_text(const std::string& text, const Parameter& parameter) {
  if (parameter.choices != nullptr) return is_choice(text, parameter.choices);
  return static_cast<double>(text.size()) >= parameter.min &&
         static_cast<double>(text.size()) <= parameter.max;
}

bool is_right(const Json& value, const Parameter& parameter) {
  constexpr std::size_t max_axes = 4, max_members = 200;
  switch (parameter.type) {
    case Type::text:
      return value.is_string() && is_right_text(value.get<std::string>(), parameter);
    case Type::number:
      return value.is_number() && is_in(value, parameter);
    case Type::whole:
      return value.is_number_integer() && is_in(value, parameter);
    case Type::flag:
      return value.is_boolean();
    case Type::numbers:
      return value.is_array() && !value.empty() && value.size() <= max_axes &&
             std::all_of(value.begin(), value.end(), [&](const Json& each) {
               return each.is_number_integer() && is_in(each, parameter);
             });
    case Type::place:
      return value.is_array() && value.size() == 3 &&
             std::all_of(value.begin(), value.end(), [&](const Json& each) {
               return each.is_number() && is_in(each, parameter);
             });
    case Type::object:
      return value.is_object() && !value.empty() && value.size() <= max_members;
    case Type::objects:
      return value.is_array() && !value.empty() &&
             static_cast<double>(value.size()) <= parameter.max &&
             std::all_of(value.begin(), value.end(),
                         [](const Json& each) { return each.is_object(); });
  }
  return false;
}

std::string wanted(const Parameter& parameter) {
  if (parameter.choices != nullptr) return parameter.choices;
  std::string type = type_name(parameter.type);
  const bool is_text = parameter.type == Type::text;
  if (is_text && parameter.max == parameter.min && parameter.max > 0)
    return fmt::format("{} of {:.10g} bytes", type, parameter.max);
  if (parameter.max <= parameter.min) return type;
  return fmt::format("{} of {:.10g} to {:.10g}{}", type, parameter.min, parameter.max,
                     is_text ? " bytes" : "");
}

const char* right_name(Right right) {
  constexpr std::array names{"all", "control", "firing"};
  return names[static_cast<std::size_t>(right)];
}

}  // namespace

std::span<const Method> methods() { return table; }

const Method* find_method(std::string_view name) {
  const auto* found = std::find_if(table.begin(), table.end(),
                                   [name](const Method& method) { return method.name == name; });
  return found == table.end() ? nullptr : found;
}

std::string refusal_of(const Method& method, const Json& parameters) {
  if (!parameters.is_object()) return "params: must be an object";
  for (const auto& [name, value] : parameters.items()) {
    const auto is_it = [&n = name](const Parameter& each) { return n == each.name; };
    if (std::none_of(method.parameters.begin(), method.parameters.end(), is_it))
      return fmt::format("params: {} has no such parameter", method.name);
  }
  for (const Parameter& parameter : method.parameters) {
    const auto found = parameters.find(parameter.name);
    if (found == parameters.end()) {
      if (parameter.is_required) return fmt::format("{}: is missing", parameter.name);
    } else if (!is_right(*found, parameter)) {
      return fmt::format("{}: must be {}", parameter.name, wanted(parameter));
    }
  }
  return "";
}

std::string methods_table() {
  std::string text = "| method | right | what it does | result |\n|---|---|---|---|\n";
  for (const Method& method : table)
    text += fmt::format("| `{}` | {} | {} | {} |\n", method.name, right_name(method.right),
                        method.about, method.result);
  text += "\n| method | parameter | value | meaning |\n|---|---|---|---|\n";
  for (const Method& method : table)
    for (const Parameter& parameter : method.parameters) {
      std::string value = wanted(parameter);
      if (parameter.choices != nullptr)
        for (std::size_t at = 0; (at = value.find('|', at)) != std::string::npos; at += 4)
          value.replace(at, 1, " or ");
      text += fmt::format("| `{}` | `{}`{} | {} | {} |\n", method.name, parameter.name,
                          parameter.is_required ? "" : " (optional)", value, parameter.about);
    }
  return text;
}

}  // namespace lamplock::serve
