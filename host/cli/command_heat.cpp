// `lamplock heat`: temperatures of a material below a laser.
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/machine_options.hpp"
#include "host/cli/validators.hpp"
#include "host/error.hpp"
#include "host/run/heat.hpp"

namespace lamplock::cli {
namespace {

constexpr const char* material_group = "Material and its surface";
constexpr const char* source_group = "Source of heat";
/// Options of one task alone.
constexpr const char* depth_group = "In depth, without a program";
constexpr const char* program_group = "Along a program";
constexpr const char* hold_group = "Pairs of speed and power";
constexpr const char* tune_group = "Controller";

struct HeatCommand : run::HeatOptions {
  bool tunes = false, no_check = false, json = false;
  double overshoot_percent = 2.8, band_percent = 5;
};

/// What is computed, and the group of its own options.
struct Task {
  std::string_view group;
  const char* name;  ///< "is only for ..."
};
constexpr Task in_depth{depth_group, "temperatures in depth"}, along{program_group, "programs"},
    holding{hold_group, "--hold"}, tuning{tune_group, "--tune"};

Json losses_json(const thermal::Losses& losses) {
  return {{"convection", losses.convection},
          {"radiation", losses.radiation},
          {"evaporation", losses.evaporation}};
}

Json balance_json(const thermal::EnergyBalance& balance) {
  return {{"absorbed_j", balance.absorbed_j},
          {"stored_j", balance.stored_j},
          {"lost_j", losses_json(balance.lost_j)},
          {"relative_error", balance.relative_error()}};
}

Json optional_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json depth_json(const run::DepthHeat& heat) {
  Json surface = Json::array();
  for (const auto& field : heat.result.temperatures_k) surface.push_back(field.front());
  return {{"material", heat.heat.material},
          {"depths_mm", heat.result.depths_mm},
          {"times_s", heat.result.times_s},
          {"surface_k", surface},
          {"profile_k", heat.result.temperatures_k.back()},
          {"max_k", heat.result.max_surface_k()},
          {"refinement", optional_json(heat.refinement)},
          {"balance", balance_json(heat.result.balance)}};
}

Json held_json(const run::HeldHeat& held) {
  Json pairs = Json::array();
  for (const thermal::HeldPair& pair : held.pairs)
    pairs.push_back({{"feed_mm_min", pair.speed_mm_s * 60},
                     {"power_w", pair.power_w},
                     {"temperature_k", pair.at.max_k},
                     {"is_steady", pair.at.is_steady},
                     {"losses_w", losses_json(pair.at.losses_w)},
                     {"absorbed_w", pair.at.absorbed_w},
                     {"balance_error", pair.at.balance.relative_error()}});
  return {{"material", held.heat.material},
          {"hold_k", held.hold_k},
          {"pairs", pairs},
          {"refinement", optional_json(held.refinement)}};
}

Json response_json(const thermal::LoopResponse& response) {
  return {{"settling_s", std::isfinite(response.settling_s) ? Json(response.settling_s) : Json()},
          {"overshoot", response.overshoot}};
}

Json tuned_json(const run::TunedHeat& tuned) {
  return {{"gain_k", tuned.plant.gain_k},
          {"time_constant_s", tuned.plant.time_constant_s},
          {"zeta", tuned.loop.zeta},
          {"omega_rad_s", tuned.loop.omega_rad_s},
          {"kp", tuned.loop.kp},
          {"ki_per_s", tuned.loop.ki_per_s},
          {"set_point_step", response_json(tuned.set_point)},
          {"absorption_step", response_json(tuned.absorption)},
          {"absorption_step_on_board", response_json(tuned.on_board)},
          {"board_lines", tuned.board_lines}};
}

Json program_json(const run::ProgramHeat& heat) {
  Json lines = Json::array(), overheated = Json::array();
  for (const thermal::LineHeat& line : heat.lines)
    lines.push_back({{"line", line.line},
                     {"max_k", line.hottest.max_k},
                     {"at_mm", {line.hottest.x, line.hottest.y}},
                     {"power_w", line.power_w},
                     {"feed_mm_min", line.speed_mm_s * 60}});
  for (const thermal::Overheated& one : heat.overheated)
    overheated.push_back({{"line", one.heat.line},
                          {"max_k", one.heat.hottest.max_k},
                          {"power_w", one.heat.power_w * one.power_factor},
                          {"feed_mm_min", optional_json(one.feed_mm_min())}});
  return {{"material", heat.heat.material},
          {"time_s", heat.result.seconds},
          {"limit_k", heat.limit_k},
          {"lines", lines},
          {"overheated", overheated},
          {"max_with_proposal_k", optional_json(heat.max_with_proposal_k)},
          {"refinement", optional_json(heat.refinement)},
          {"balance", balance_json(heat.result.balance)}};
}

Task task_of(const HeatCommand& options) {
  const bool has_program = !options.program.empty(), holds = !options.hold.empty();
  if (has_program + holds + options.tunes > 1)
    throw Error(Exit::bad_input, "heat", "several tasks are given",
                "give a program, --hold or --tune");
  if (has_program) return along;
  if (holds) return holding;
  return options.tunes ? tuning : in_depth;
}

[[noreturn]] void refuse(const Option& option, const char* use) {
  throw Error(Exit::bad_input, option.name(), fmt::format("is only for {}", use), "leave it out");
}

void require_feed_used(const Option& feed, const HeatCommand& options, const Task& task) {
  if (options.flux_w_m2) refuse(feed, "a beam, not for a flux");
  if (task.group == program_group) refuse(feed, "tasks without a program");
  if (!options.feeds_mm_min.empty()) refuse(feed, "runs without --feeds");
}

/// Refuses options that this task does not use.
void require_used(const Command& app, const HeatCommand& options, const Task& task) {
  for (const Option& option : app.options()) {
    if (!option.is_given()) continue;
    for (const Task& other : {in_depth, along, holding, tuning})
      if (option.group() == other.group && other.group != task.group) refuse(option, other.name);
    if (option.name() == "--machine" && task.group != program_group) refuse(option, along.name);
    if (option.name() == "--flux" && task.group != depth_group) refuse(option, in_depth.name);
    const bool is_of_model = option.group() == material_group || option.group() == source_group;
    if (options.gain_k && is_of_model) refuse(option, "a process without --gain");
    if (option.name() == "--feed") require_feed_used(option, options, task);
  }
}

Exit heat(const Command& app, HeatCommand options) {
  Console console(options.json);
  options.has_check = !options.no_check;
  options.goal.overshoot = options.overshoot_percent / 100;
  options.goal.band = options.band_percent / 100;
  const Task task = task_of(options);
  require_used(app, options, task);
  Json document;
  if (task.group == program_group)
    document = program_json(run::heat_of_program(options, console));
  else if (task.group == hold_group)
    document = held_json(run::held_heat(options, console));
  else if (task.group == tune_group)
    document = tuned_json(run::tuned_heat(options, console));
  else
    document = depth_json(run::heat_in_depth(options, console));
  if (options.json) console.document(document);
  return Exit::done;
}

// No laser, machine or process is beyond these.
constexpr glass::Range feed_range{0, 1e6, false}, gain_range{0, 1e6, false},
    time_range{0, 1e6, false}, percent_range{0.01, 99, true}, volts_range{0, 3.3, false};

void add_number(Command& app, const char* name, Target target, const char* text, const char* unit,
                const char* group, bool shows_default = false,
                const glass::Range& range = glass::positive) {
  Option& option =
      app.add_option(name, target, text).check(number_in(range)).value_name(unit).group(group);
  if (shows_default) option.show_default();
}

void add_material(Command& app, HeatCommand& options) {
  app.add_option("--material", &options.material, "Name of the material")
      .value_name("NAME")
      .group(material_group)
      .common();
  app.add_option("--library", &options.library,
                 "Material library; default: that of lamplock material")
      .value_name("FILE")
      .group(material_group)
      .file(FileUse::read);
  app.add_option("--materials", &options.materials,
                 "Take the material from this file of records (TOML), not from the library")
      .value_name("FILE.toml")
      .group(material_group)
      .file(FileUse::read);
  add_number(app, "--thickness", &options.thickness_mm,
             "Thickness of the workpiece; default: so thick that its rear side stays cold", "MM",
             material_group);
  app.add_option("--losses", &options.losses,
                 "Losses of the surface: known (those whose constants the material has), none, or "
                 "some of convection,radiation,evaporation")
      .value_name("NAMES")
      .group(material_group)
      .show_default();
  add_number(app, "--ambient", &options.ambient_k, "Ambient temperature", "K", material_group,
             true);
  add_number(app, "--convection", &options.convection_w_m2k, "Heat transfer to the air", "W_M2K",
             material_group, true);
}

void add_source(Command& app, HeatCommand& options) {
  app.add_option("--laser", &options.laser, "Laser of the library: its power and beam")
      .value_name("NAME")
      .group(source_group)
      .common();
  add_number(app, "--power", &options.power_w, "Power of the beam; of a program: at full S", "W",
             source_group);
  add_number(app, "--beam", &options.beam_mm, "Diameter of a round beam at 1/e", "MM",
             source_group);
  add_number(app, "--feed", &options.feed_mm_min,
             "Feed; without a program and --hold the beam rests by default", "MM_MIN", source_group,
             false, feed_range);
  add_number(app, "--flux", &options.flux_w_m2, "Flux into the surface in place of a beam", "W_M2",
             source_group);
}

void add_tasks(Command& app, HeatCommand& options) {
  add_number(app, "--time", &options.time_s, "Simulated time from the start of heating", "S",
             depth_group, true);
  add_number(app, "--step", &options.step_s, "Time step", "S", depth_group, true);
  app.add_option("--nodes", &options.nodes, "Nodes in depth")
      .check(number_in({3, 100'000, true}))
      .value_name("N")
      .show_default()
      .group(depth_group);
  add_number(app, "--limit", &options.limit_k,
             "Warn of lines above it; default: 1.15 times the usual rise", "K", program_group);
  add_machine(app, options.machine);
  app.add_option("--hold", &options.hold, "Print the power that holds this temperature, per feed")
      .value_name("450K")
      .group(hold_group)
      .common();
  app.add_option("--feeds", &options.feeds_mm_min, "Feeds; default: 60,120,300,600,1200")
      .check(number_in(feed_range))
      .count({1, 100})
      .value_name("MM_MIN,...")
      .group(hold_group);
  app.add_option("--tune", &options.tunes, "Print Kp and Ki of the loop that holds the temperature")
      .group(tune_group)
      .common();
  add_number(app, "--settling", &options.goal.settling_s, "Settling time that the loop is to have",
             "S", tune_group, true, time_range);
  add_number(app, "--overshoot", &options.overshoot_percent, "Overshoot that the loop may have",
             "PERCENT", tune_group, true, percent_range);
  add_number(app, "--band", &options.band_percent, "Settled within this part of the step",
             "PERCENT", tune_group, true, percent_range);
  add_number(app, "--gain", &options.gain_k,
             "Rise by a doubled power, instead of that of the model", "K", tune_group, false,
             gain_range);
  add_number(app, "--time-constant", &options.time_constant_s, "Time constant of the process", "S",
             tune_group, false, time_range);
  app.add_option("--sensor-scale", &options.sensor_k_per_v,
                 "Rise of the temperature per volt of the sensor, for the board ($1067)")
      .value_name("K_V")
      .check(number_in({-10'000, 10'000}))
      .group(tune_group);
  add_number(app, "--sensor-volts", &options.sensor_volts,
             "Voltage of the sensor at the temperature to be held ($1062)", "V", tune_group, false,
             volts_range);
}

}  // namespace

void add_heat(Command& program) {
  Command& app = program.add_command(
      "heat", "Compute the temperature of a material below a laser, by finite volumes");
  app.footer(
      "Without a program: temperature in depth. docs/thermal.md has the theory.\n"
      "Example:\n"
      "  lamplock heat --material pmma-black --flux 10000 --picture depth.svg\n"
      "  lamplock heat part.ngc --material pmma-black --laser diode-3w --picture part.svg\n"
      "  lamplock heat --hold 450K --material pmma-black --laser diode-3w --feeds 120,600\n"
      "  lamplock heat --tune --material pmma-black --power 0.05 --beam 0.5 --feed 600");
  const auto options = std::make_shared<HeatCommand>();
  app.add_option("PROGRAM", &options->program, "G-code program, or description of a cut (toml)")
      .value_name("FILE")
      .file(FileUse::read);
  add_material(app, *options);
  add_source(app, *options);
  app.add_option("--csv", &options->csv, "Write temperature and heating rate per node and time")
      .value_name("FILE")
      .file(FileUse::write, ".csv")
      .common();
  app.add_option("--picture", &options->picture, "Write a picture (SVG)")
      .value_name("FILE.svg")
      .file(FileUse::write)
      .common();
  app.add_option("--no-check", &options->no_check,
                 "Omit the check of convergence by half the mesh and step");
  add_tasks(app, *options);
  app.add_json(options->json);
  app.action([options, &app] { return heat(app, *options); });
}

}  // namespace lamplock::cli
