#include "host/run/cut_description.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/cutting/cut_path.hpp"
#include "host/cutting/post_file.hpp"
#include "host/error.hpp"
#include "host/file.hpp"
#include "host/glass/section_file.hpp"
#include "host/model/colour.hpp"
#include "host/raster/row_motion.hpp"
#include "host/suggestion.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using glass::Parameter;
using glass::Range;
using settings::Id;

constexpr Range place_range{-100'000, 100'000, true};
constexpr double max_passes = 1000, max_cut_tabs = 1000, max_pierce_s = 60;

std::string colour_fault(const std::string& text) {
  return model::colour_named(text)
             ? ""
             : "'" + text + "' is no colour: give a name or #rrggbb, red or #ff0000";
}

std::vector<Parameter> choice_parameters(OperationChoice& o) {
  return {
      {"name", "--name", &o.name, "Name of the operation in the program and in messages", "TEXT"},
      {"layers", "--layer", &o.layers,
       "Only curves of this layer; give it again for another one; default: all layers", "NAME"},
      {"colours",
       "--colour",
       &o.colours,
       "Only curves of this colour, #rrggbb or a name; give it again for another one; default: all "
       "colours",
       "COLOUR",
       {},
       {},
       colour_fault},
      {"kind",
       "--operation",
       &o.kind,
       "cut: through the sheet, inner contours first; score: along the lines, before all cuts; "
       "engrave: fill closed contours with lines, before all others; ignore: nothing",
       "",
       {},
       {"cut", "score", "engrave", "ignore"}},
      {"off", "--off", &o.is_off, "Leave the operation out, with its curves"},
  };
}

std::vector<Parameter> material_parameters(OperationChoice& o) {
  return {
      {"power", "--power", &o.power_percent, "Laser power", "PERCENT", {0, 100, false}},
      {"feed", "--feed", &o.feed_mm_min, "Feed rate along the contours", "MM_MIN", glass::positive},
      {"kerf", "--kerf", &o.kerf_mm,
       "Width of the beam, by half of which contours are compensated; default: no compensation",
       "MM", glass::not_negative},
      {"passes",
       "--passes",
       &o.passes,
       "Passes of each contour at the present height; default: 1",
       "N",
       {1, max_passes, true}},
      {"infeed", "--infeed", &o.infeed_mm,
       "Depth of each pass: Z follows the bottom of the groove; needs the final depth", "MM",
       glass::positive},
      {"final_depth", "--final-depth", &o.final_depth_mm,
       "Depth to be reached, usually the thickness: passes = final depth / infeed", "MM",
       glass::positive},
      {"air", "--air", &o.has_air, "Switch on air (M8) for the operation"},
      {"pierce",
       "--pierce",
       &o.pierce_s,
       "Time with the laser on before each contour; lamplock boards need $936 for it",
       "S",
       {0, max_pierce_s, true}},
  };
}

std::vector<Parameter> path_parameters(OperationChoice& o) {
  constexpr Range angle{0, 270, false};
  const std::vector<std::string> shapes{"none", "line", "arc"};
  return {
      {"compensation",
       "--compensation",
       &o.compensation,
       "Side of the beam. auto: outside of parts, inside of holes; inside, outside: of closed "
       "contours; left, right: of the direction of the cut; none",
       "",
       {},
       {"auto", "none", "left", "right", "inside", "outside"}},
      {"direction",
       "--direction",
       &o.direction,
       "auto: parts counter-clockwise, holes clockwise; drawn; reversed; cw; ccw",
       "",
       {},
       {"auto", "drawn", "reversed", "cw", "ccw"}},
      {"lead_in",
       "--lead-in",
       &o.lead_in,
       "Way from the pierce point, in the waste, to closed contours",
       "",
       {},
       shapes},
      {"lead_in_mm", "--lead-in-mm", &o.lead_in_mm,
       "Length of the line or radius of the arc of the lead-in", "MM", glass::positive},
      {"lead_in_angle", "--lead-in-angle", &o.lead_in_deg,
       "Angle of the line to the contour, below 180, or angle that the arc turns", "DEG", angle},
      {"lead_out",
       "--lead-out",
       &o.lead_out,
       "Way from closed contours into the waste",
       "",
       {},
       shapes},
      {"lead_out_mm", "--lead-out-mm", &o.lead_out_mm,
       "Length of the line or radius of the arc of the lead-out", "MM", glass::positive},
      {"lead_out_angle", "--lead-out-angle", &o.lead_out_deg,
       "Angle of the line to the contour, below 180, or angle that the arc turns", "DEG", angle},
      {"overcut", "--overcut", &o.overcut_mm, "Closed contours are cut beyond their begin by this",
       "MM", glass::not_negative},
      {"tabs",
       "--tabs",
       &o.tabs,
       "Tabs of each closed contour, which hold the part",
       "N",
       {0, max_cut_tabs, true}},
      {"tab_width", "--tab-width", &o.tab_mm, "Width of a tab", "MM", glass::positive},
      {"tab_power", "--tab-power", &o.tab_power, "Power in tabs, in parts of that of the cut",
       "SHARE", glass::share},
      {"tab_corner", "--tab-corner", &o.tab_corner_mm, "Distance of tabs from corners", "MM",
       glass::not_negative},
  };
}

std::vector<Parameter> hatch_parameters(OperationChoice& o) {
  return {
      {"hatch", "--hatch", &o.hatch_mm, "Engravings: distance between the lines", "MM",
       glass::positive},
      {"hatch_angle",
       "--hatch-angle",
       &o.hatch_deg,
       "Engravings: angle of the lines, counter-clockwise from X",
       "DEG",
       {-360, 360, true}},
      {"overscan", "--overscan", &o.overscan_mm,
       "Engravings: dark way before and after each line; default: the way to reach the feed rate",
       "MM", glass::not_negative},
  };
}

void append_parameters(std::vector<Parameter>& list, std::vector<Parameter> more) {
  for (Parameter& parameter : more) list.push_back(std::move(parameter));
}

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
              fmt::format("give its {} in {}", what, unit));
}

double feed_of(const OperationChoice& choice, const std::string& name,
               const settings::Values& values) {
  const double feed = needed(choice.feed_mm_min, name, "feed", "mm/min");
  const double limit =
      std::min(in_units(values, Id::max_rate_x, 0), in_units(values, Id::max_rate_x, 1));
  if (feed <= limit) return feed;
  throw Error(Exit::bad_input, name,
              fmt::format("a feed of {:g} mm/min is more than X and Y of the machine have", feed),
              fmt::format("give at most {:g} mm/min, or the profile of another machine", limit));
}

/// Z of each pass; none without depths.
std::vector<double> heights_of(const OperationChoice& choice, const std::string& name,
                               double surface_mm) {
  if (!choice.infeed_mm && !choice.final_depth_mm) return {};
  if (!choice.infeed_mm || !choice.final_depth_mm)
    throw Error(Exit::bad_input, name,
                choice.infeed_mm ? "has an infeed without a final depth"
                                 : "has a final depth without an infeed",
                "give both, or the number of passes");
  if (choice.passes)
    throw Error(Exit::bad_input, name, "has passes and also an infeed, which gives their number",
                "leave out one of them");
  std::vector<double> z_mm = cutting::focus_passes(*choice.final_depth_mm, *choice.infeed_mm);
  if (static_cast<double>(z_mm.size()) > max_passes)
    throw Error(Exit::bad_input, name, fmt::format("has {} passes", z_mm.size()),
                "give a greater infeed");
  for (double& z : z_mm) z += surface_mm;
  return z_mm;
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

/// A name of the program otherwise.
bool is_post_file(const std::string& post) { return lower_extension(post) == ".toml"; }

template <class Section>
std::string section_of_cut(std::string_view heading, Section section,
                           const std::filesystem::path& folder, bool is_always) {
  Section untouched;
  const std::string lines =
      glass::section_lines(parameters(section), parameters(untouched), folder);
  return lines.empty() && !is_always ? "" : fmt::format("\n{}\n{}", heading, lines);
}

}  // namespace

std::vector<Parameter> parameters(DrawingChoice& d) {
  return {
      {"file", "DRAWING", &d.file, "Drawing (dxf, svg)", "FILE", {}, {}, nullptr, true},
      {"units",
       "--units",
       &d.units,
       "Unit of the numbers of a DXF; needed if the drawing names none",
       "",
       {},
       {"mm", "cm", "m", "inch", "foot"}},
      {"tolerance",
       "--tolerance",
       &d.tolerance_mm,
       "Ends of curves nearer than this are joined to contours",
       "MM",
       {0, 10, false}},
      {"x", "--x", &d.x_mm, "X of the left edge of what is drawn; default: as in the drawing", "MM",
       place_range},
      {"y", "--y", &d.y_mm, "Y of the lower edge of what is drawn; default: as in the drawing",
       "MM", place_range},
  };
}

std::vector<Parameter> parameters(CutMachineChoice& m) {
  return {
      {"profile",
       "--machine",
       &m.profile,
       "Machine profile (TOML); default: built-in settings",
       "FILE",
       {},
       {},
       nullptr,
       true},
      {"post", "--post", &m.post,
       "Post-processor: " + fmt::format("{}", fmt::join(cutting::post_names(), ", ")) +
           " or a file of templates (TOML)",
       "NAME"},
      {"surface", "--surface", &m.surface_mm,
       "Z at which the laser is in focus on the surface, for passes with depths", "MM",
       place_range},
  };
}

std::vector<Parameter> parameters(OperationChoice& operation) {
  std::vector<Parameter> list = choice_parameters(operation);
  append_parameters(list, material_parameters(operation));
  append_parameters(list, path_parameters(operation));
  append_parameters(list, hatch_parameters(operation));
  return list;
}

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
  std::string& post = description.machine.post;
  if (is_post_file(post)) post = (file.parent_path() / post).lexically_normal().string();
  if (description.drawing.file.empty())
    refuse(file, "it has no drawing", "write [drawing] and file = \"NAME\"");
  if (description.operations.empty())
    refuse(file, "it has no operation", "write [[operation]], power and feed");
  return description;
}

std::string to_text(const CutDescription& description, const std::filesystem::path& folder) {
  std::string text = "# What is cut from which drawing, and how: lamplock cut THIS -o FILE.ngc\n";
  text += section_of_cut("[drawing]", description.drawing, folder, false);
  CutMachineChoice machine = description.machine;
  if (is_post_file(machine.post)) machine.post = std::filesystem::absolute(machine.post).string();
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
      choice.compensation, std::array{"auto", "none", "left", "right", "inside", "outside"});
  operation.direction =
      named<Direction>(choice.direction, std::array{"auto", "drawn", "reversed", "cw", "ccw"});
  return operation;
}

cutting::Operation operation_of(const OperationChoice& choice, const std::string& name,
                                double surface_mm, const settings::Values& values) {
  using namespace cutting;
  constexpr double percent = 0.01;
  Operation operation = bare_operation(choice, name);
  if (operation.kind == OperationKind::ignore) return operation;
  operation.power = needed(choice.power_percent, name, "power", "percent") * percent;
  operation.feed_mm_min = feed_of(choice, name, values);
  operation.z_mm = heights_of(choice, name, surface_mm);
  operation.passes = choice.passes.value_or(1);
  operation.has_air = choice.has_air;
  operation.kerf_mm = choice.kerf_mm.value_or(0);
  if (operation.kind == OperationKind::engrave) {
    operation.hatch_mm = choice.hatch_mm;
    operation.hatch_deg = choice.hatch_deg;
    operation.overscan_mm =
        choice.overscan_mm ? *choice.overscan_mm : raster::run_up_mm(values, operation.feed_mm_min);
    return operation;
  }
  const bool has_side = choice.compensation != "auto" && choice.compensation != "none";
  if (has_side && operation.kerf_mm == 0)
    throw Error(Exit::bad_input, name,
                fmt::format("compensation {} needs the width of the beam", choice.compensation),
                "give the kerf in mm");
  operation.pierce_s = choice.pierce_s;
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

}  // namespace lamplock::run
