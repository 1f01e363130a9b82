#include "host/run/cut_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "host/cutting/cut_path.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/section_file.hpp"
#include "host/raster/row_motion.hpp"
#include "host/suggestion.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using cutting::MachineType;
using settings::Id;

/// The place of a name in a list of names; the parameters accept no others.
template <class Enum, std::size_t count>
Enum named(const std::string& name, const std::array<const char*, count>& names) {
  const auto found = std::find(names.begin(), names.end(), name);
  return static_cast<Enum>(found - names.begin());
}

cutting::Lead lead_of(const std::string& shape, double size_mm, double angle_deg) {
  using cutting::LeadShape;
  cutting::Lead lead;
  lead.shape = named<LeadShape>(shape, std::array{"none", "line", "arc"});
  lead.length_mm = lead.radius_mm = size_mm;
  lead.angle_deg = angle_deg;
  return lead;
}

double needed(const std::optional<double>& value, const std::string& name, const char* what,
              const char* unit) {
  if (value) return *value;
  throw Error(Exit::bad_input, name, fmt::format("has no {}", what),
              fmt::format("give its {} in {}, or a material", what, unit));
}

double feed_of(const OperationChoice& choice, const std::string& name,
               const settings::Values& values) {
  const double feed = needed(choice.feed_mm_min, name, "feed", "mm/min");
  if (feed < cutting::min_feed_mm_min)  // of a material; the parameters have the same limit
    throw Error(Exit::bad_input, name, fmt::format("a feed of {:g} mm/min is too slow", feed),
                fmt::format("give at least {:g} mm/min", cutting::min_feed_mm_min));
  const double limit =
      std::min(in_units(values, Id::max_rate_x, 0), in_units(values, Id::max_rate_x, 1));
  if (feed <= limit) return feed;
  throw Error(Exit::bad_input, name,
              fmt::format("a feed of {:g} mm/min is more than X and Y of the machine have", feed),
              fmt::format("give at most {:g} mm/min, or the profile of another machine", limit));
}

/// Z of each pass; none without depths.
std::vector<double> heights_of(const OperationChoice& choice, const std::string& name,
                               double surface_mm, MachineType machine) {
  const bool is_laser = machine == MachineType::laser;
  if (!is_laser && machine != MachineType::lathe && !choice.final_depth_mm)
    throw Error(Exit::bad_input, name, "has no depth", "give the final depth in mm");
  if (!choice.infeed_mm && !choice.final_depth_mm) return {};
  if (!choice.final_depth_mm || (is_laser && !choice.infeed_mm))
    throw Error(Exit::bad_input, name,
                choice.infeed_mm ? "has an infeed without a final depth"
                                 : "has a final depth without an infeed",
                "give both, or the number of passes");
  if (choice.passes)
    throw Error(Exit::bad_input, name, "has passes and also an infeed, which gives their number",
                "leave out one of them");
  const double depth_mm = *choice.final_depth_mm, infeed_mm = choice.infeed_mm.value_or(depth_mm);
  // A laser is in focus where the pass before it has ended, a tool reaches the depth.
  std::vector<double> z_mm = is_laser ? cutting::focus_passes(depth_mm, infeed_mm)
                                      : cutting::tool_passes(depth_mm, infeed_mm);
  if (static_cast<double>(z_mm.size()) > max_cut_passes)
    throw Error(Exit::bad_input, name, fmt::format("has {} passes", z_mm.size()),
                "give a greater infeed");
  for (double& z : z_mm) z += surface_mm;
  return z_mm;
}

/// The gap in a line of an engraving that takes as long at the feed as by a rapid. At the feed
/// speed f it takes gap / f. By a rapid of speed r and acceleration a: the run-up and run-out of
/// the engraving, f / a each, and (gap - both of them) / r + r / a.
double max_gap_mm(const settings::Values& values, double feed_mm_min, double overscan_mm) {
  constexpr double s_per_min = 60;
  const auto of_slower = [&](Id id) {
    return std::min(in_units(values, id, 0), in_units(values, id, 1));
  };
  const double feed = feed_mm_min / s_per_min, rapid = of_slower(Id::max_rate_x) / s_per_min;
  const double acceleration = of_slower(Id::acceleration_x);
  if (rapid <= feed) return std::numeric_limits<double>::infinity();
  const double stops_s = 2 * feed / acceleration + rapid / acceleration - 2 * overscan_mm / rapid;
  return std::max(2 * overscan_mm, stops_s / (1 / feed - 1 / rapid));
}

/// Refuses what a machine of this type cannot do.
void require_fit(const OperationChoice& choice, const std::string& name, MachineType machine) {
  const auto refuse_unless = [&](bool fits, const char* what) {
    if (fits) return;
    throw Error(Exit::bad_input, name,
                fmt::format("a {} has no {}",
                            cutting::machine_type_names[static_cast<std::size_t>(machine)], what),
                "leave it out, or give the post-processor of another machine");
  };
  const bool is_laser = machine == MachineType::laser, is_mill = machine == MachineType::mill;
  refuse_unless(is_laser || choice.kind != "engrave", "engraving with lines");
  refuse_unless(is_laser || choice.pierce_s == 0, "pierce time");
  refuse_unless(is_laser || (choice.on_late_s == 0 && choice.off_early_s == 0),
                "times of laser on and off");
  refuse_unless(is_laser || choice.compensation != "controller", "compensation by the controller");
  refuse_unless(is_laser || !choice.material, "settings in the material library");
  refuse_unless(is_laser || !choice.passes, "passes without a depth");
  const bool has_leads = choice.lead_in != "none" || choice.lead_out != "none";
  refuse_unless(is_laser || is_mill || !has_leads, "leads");
  refuse_unless(is_laser || is_mill || choice.tabs == 0, "tabs");
  if (is_mill && choice.tabs > 0 && choice.kerf_mm.value_or(0) == 0)
    throw Error(Exit::bad_input, name,
                "tabs of a mill need the diameter of the tool, which is not known",
                "give the diameter as kerf in mm");
  refuse_unless(machine != MachineType::lathe || choice.overcut_mm == 0, "overcut");
  refuse_unless(machine != MachineType::knife || choice.kerf_mm.value_or(0) == 0, "kerf");
  refuse_unless(machine != MachineType::knife || !choice.power_percent, "power");
  refuse_unless(machine != MachineType::knife || !choice.has_air, "air");
}

/// Refuses values that an operation of this kind does not use.
void require_kind(const OperationChoice& choice, const std::string& name) {
  const OperationChoice untouched;
  const bool is_cut = choice.kind == "cut", is_engraving = choice.kind == "engrave";
  const auto refuse_unless = [&](bool fits, const char* what) {
    if (fits) return;
    throw Error(Exit::bad_input, name,
                fmt::format("{} has no {}",
                            is_cut         ? "a cut"
                            : is_engraving ? "an engraving"
                                           : "a score",
                            what),
                "leave it out, or choose another kind of operation");
  };
  const bool has_side = choice.compensation != "auto" && choice.compensation != "none";
  refuse_unless(is_cut || (choice.lead_in == "none" && choice.lead_out == "none"), "leads");
  refuse_unless(is_cut || choice.overcut_mm == 0, "overcut");
  refuse_unless(is_cut || choice.tabs == 0, "tabs");
  refuse_unless(!is_engraving || !has_side, "compensation");
  refuse_unless(!is_engraving || choice.direction == "auto", "direction");
  refuse_unless(!is_engraving || choice.pierce_s == 0, "pierce time");
  refuse_unless(!is_engraving || (choice.on_late_s == 0 && choice.off_early_s == 0),
                "times of laser on and off");
  const bool has_kerf = choice.kerf_mm.value_or(0) > 0;
  refuse_unless(!is_engraving || !has_kerf, "kerf");
  refuse_unless(is_cut || has_side || !has_kerf,
                "kerf without compensation left, right, inside or outside");
  const bool has_hatch =
      choice.hatch_mm != untouched.hatch_mm || choice.hatch_deg != untouched.hatch_deg;
  refuse_unless(is_engraving || !has_hatch, "hatch");
  refuse_unless(is_engraving || !choice.overscan_mm, "overscan");
}

/// Refuses values of leads and tabs that the operation does not have: a user who forgets the lead
/// would pierce on the part.
void require_effect(const OperationChoice& choice, const std::string& name) {
  const OperationChoice untouched;
  const auto refuse_if = [&](bool is_idle, const char* what, const char* remedy) {
    if (is_idle) throw Error(Exit::bad_input, name, fmt::format("{} has no effect", what), remedy);
  };
  refuse_if(choice.lead_in == "none" && (choice.lead_in_mm != untouched.lead_in_mm ||
                                         choice.lead_in_deg != untouched.lead_in_deg),
            "a size or angle of the lead-in without a lead-in", "give lead-in line or arc");
  refuse_if(choice.lead_out == "none" && (choice.lead_out_mm != untouched.lead_out_mm ||
                                          choice.lead_out_deg != untouched.lead_out_deg),
            "a size or angle of the lead-out without a lead-out", "give lead-out line or arc");
  refuse_if(choice.tabs == 0 &&
                (choice.tab_mm != untouched.tab_mm || choice.tab_power != untouched.tab_power ||
                 choice.tab_corner_mm != untouched.tab_corner_mm),
            "a width, power or corner distance of tabs without tabs", "give their number");
}

void read_operations(const toml::node& node, CutDescription& description,
                     const std::filesystem::path& file) {
  const toml::array* list = node.as_array();
  if (list == nullptr || !list->is_array_of_tables())
    refuse(toml_location(file, node.source()), "'operation' must be a list of tables",
           "write [[operation]]");
  for (const toml::node& one : *list) {
    OperationChoice& choice = description.operations.emplace_back();
    glass::read_section(*one.as_table(), "[[operation]]", parameters(choice), file);
  }
}

/// Post-processors and fonts have names, or are files.
bool is_file_of(const std::string& name) {
  const std::string ending = lower_extension(name);
  return ending == ".toml" || ending == ".ttf" || ending == ".otf" || ending == ".ttc";
}

/// Files that a description names are relative to its folder.
void from_folder(std::string& name, const std::filesystem::path& folder) {
  if (is_file_of(name)) name = (folder / name).lexically_normal().string();
}
void make_absolute(std::string& name) {
  if (is_file_of(name)) name = std::filesystem::absolute(name).string();
}

template <class Section>
std::string section_of_cut(std::string_view heading, Section section,
                           const std::filesystem::path& folder, bool is_always) {
  Section untouched;
  const std::string lines =
      glass::section_lines(parameters(section), parameters(untouched), folder);
  return lines.empty() && !is_always ? "" : fmt::format("\n{}\n{}", heading, lines);
}

}  // namespace

CutDescription read_cut_description(const std::filesystem::path& file) {
  const toml::table table = read_toml(file);
  CutDescription description;
  for (const auto& [key, node] : table) {
    const std::string_view name = key.str();
    if (name == "operation") {
      read_operations(node, description, file);
    } else if (name == "drawing" && node.is_table()) {
      glass::read_section(*node.as_table(), "[drawing]", parameters(description.drawing), file);
    } else if (name == "machine" && node.is_table()) {
      glass::read_section(*node.as_table(), "[machine]", parameters(description.machine), file);
    } else {
      refuse(toml_location(file, key.source()), fmt::format("unknown section or key '{}'", name),
             did_you_mean(name, {"drawing", "machine", "operation"},
                          "use [drawing], [machine] and [[operation]]"));
    }
  }
  from_folder(description.machine.post, file.parent_path());
  from_folder(description.drawing.font, file.parent_path());
  if (description.drawing.file.empty())
    refuse(file, "it has no drawing", "write [drawing] and file = \"NAME\"");
  if (description.operations.empty())
    refuse(file, "it has no operation", "write [[operation]], power and feed");
  return description;
}

std::string to_text(const CutDescription& description, const std::filesystem::path& folder) {
  std::string text = "# What is cut from which drawing, and how: lamplock cut THIS -o FILE.ngc\n";
  DrawingChoice drawing = description.drawing;
  make_absolute(drawing.font);
  text += section_of_cut("[drawing]", drawing, folder, false);
  CutMachineChoice machine = description.machine;
  make_absolute(machine.post);
  text += section_of_cut("[machine]", machine, folder, false);
  for (const OperationChoice& operation : description.operations)
    text += section_of_cut("[[operation]]", operation, folder, true);
  return text;
}

std::string operation_name(const OperationChoice& choice, std::size_t number) {
  return choice.name && !choice.name->empty() ? *choice.name
                                              : fmt::format("operation {}", number + 1);
}

cutting::Operation bare_operation(const OperationChoice& choice, const std::string& name) {
  using namespace cutting;
  Operation operation;
  operation.name = name;
  operation.kind =
      named<OperationKind>(choice.kind, std::array{"cut", "score", "engrave", "ignore"});
  if (choice.is_off) operation.kind = OperationKind::ignore;
  operation.compensation = named<Compensation>(
      choice.compensation,
      std::array{"auto", "none", "left", "right", "inside", "outside", "controller"});
  operation.direction =
      named<Direction>(choice.direction, std::array{"auto", "drawn", "reversed", "cw", "ccw"});
  return operation;
}

cutting::Operation operation_of(const OperationChoice& choice, const std::string& name,
                                double surface_mm, MachineType machine,
                                const settings::Values& values) {
  using namespace cutting;
  constexpr double percent = 0.01;
  Operation operation = bare_operation(choice, name);
  if (operation.kind == OperationKind::ignore) return operation;
  require_fit(choice, name, machine);
  require_kind(choice, name);
  require_effect(choice, name);
  // A drag knife has nothing to switch on.
  operation.power = machine == MachineType::knife
                        ? 1
                        : needed(choice.power_percent, name, "power", "percent") * percent;
  operation.feed_mm_min = feed_of(choice, name, values);
  operation.z_mm = heights_of(choice, name, surface_mm, machine);
  operation.passes = choice.passes.value_or(1);
  operation.has_air = choice.has_air;
  operation.kerf_mm = choice.kerf_mm.value_or(0);
  if (operation.kind == OperationKind::engrave) {
    operation.hatch_mm = choice.hatch_mm;
    operation.hatch_deg = choice.hatch_deg;
    operation.overscan_mm =
        choice.overscan_mm ? *choice.overscan_mm : raster::run_up_mm(values, operation.feed_mm_min);
    operation.max_gap_mm = max_gap_mm(values, operation.feed_mm_min, operation.overscan_mm);
    return operation;
  }
  const bool has_side = choice.compensation != "auto" && choice.compensation != "none";
  if (has_side && operation.kerf_mm == 0)
    throw Error(Exit::bad_input, name,
                fmt::format("compensation {} needs the width of the beam", choice.compensation),
                "give the kerf in mm");
  if (choice.compensation == "controller" &&
      (choice.lead_in != "none" || choice.lead_out != "none" || choice.tabs != 0 ||
       choice.overcut_mm != 0 || choice.on_late_s != 0 || choice.off_early_s != 0))
    throw Error(Exit::bad_input, name,
                "compensation controller has no leads, tabs, overcut and times of laser on and off",
                "leave them out, or use compensation auto");
  if (choice.pierce_s > 0 && choice.on_late_s > 0)
    throw Error(Exit::bad_input, name, "after a pierce time the laser is on from the begin",
                "leave out the pierce time, or on late");
  operation.pierce_s = choice.pierce_s;
  operation.on_late_s = choice.on_late_s;
  operation.off_early_s = choice.off_early_s;
  if (operation.kind == OperationKind::score) {
    if (!has_side) operation.compensation = Compensation::none;
    return operation;
  }
  operation.lead_in = lead_of(choice.lead_in, choice.lead_in_mm, choice.lead_in_deg);
  operation.lead_out = lead_of(choice.lead_out, choice.lead_out_mm, choice.lead_out_deg);
  operation.overcut_mm = choice.overcut_mm;
  operation.tabs = {choice.tabs, choice.tab_mm, choice.tab_power, choice.tab_corner_mm};
  return operation;
}

cutting::Tooling tooling_of(const CutMachineChoice& choice, MachineType machine) {
  const auto require_machine = [&](bool fits, const char* option, const char* which) {
    if (fits) return;
    throw Error(Exit::bad_input, option,
                fmt::format("is for {}, not for the post-processor", which),
                "leave it out, or give another post-processor");
  };
  require_machine(!choice.clearance_mm || machine != MachineType::laser, "clearance",
                  "mills, knives and lathes");
  require_machine(!choice.ramp_deg || machine == MachineType::mill, "ramp angle", "mills");
  require_machine(!choice.knife_offset_mm || machine == MachineType::knife, "knife offset",
                  "knives");
  require_machine(choice.surface_mm == 0 || machine != MachineType::lathe, "surface",
                  "lasers, mills and knives");
  if (choice.population != CutMachineChoice{}.population && choice.order != "genetic")
    throw Error(Exit::bad_input, "population", "is for the order genetic alone",
                "leave it out, or give the order genetic");
  if (machine == MachineType::knife && !choice.knife_offset_mm)
    throw Error(Exit::bad_input, "knife", "the distance of the blade from its axis is not known",
                "give the knife offset in mm; 0 for a knife that is turned by its machine");
  cutting::Tooling tooling;
  tooling.surface_mm = choice.surface_mm;
  tooling.clearance_mm = choice.clearance_mm.value_or(tooling.clearance_mm);
  tooling.ramp_deg = choice.ramp_deg.value_or(tooling.ramp_deg);
  tooling.knife_offset_mm = choice.knife_offset_mm.value_or(0);
  return tooling;
}

}  // namespace lamplock::run
