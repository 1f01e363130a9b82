// parameters() of the sections of a cutting job: keys, options and help texts.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "host/cutting/cut_order.hpp"
#include "host/cutting/post_file.hpp"
#include "host/glass/profile_parameter.hpp"
#include "host/model/colour.hpp"
#include "host/run/cut_description.hpp"

namespace lamplock::run {
namespace {

using glass::Parameter;
using glass::Range;

constexpr Range place_range{-100'000, 100'000, true};
constexpr Range feed_range{cutting::min_feed_mm_min, std::numeric_limits<double>::infinity(), true};
constexpr Range hatch_range{cutting::min_hatch_mm, std::numeric_limits<double>::infinity(), true};
constexpr double max_cut_tabs = 1000, max_pierce_s = 60, max_dark_s = 1;

std::string colour_fault(const std::string& text) {
  return model::colour_named(text)
             ? ""
             : "'" + text + "' is not a colour: give a name or #rrggbb, red or #ff0000";
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
      {"material", "--material", &o.material,
       "Material of the library (lamplock material): its power, feed, passes, air and kerf are "
       "used "
       "where none are given",
       "NAME"},
      {"laser", "--laser", &o.laser,
       "Laser of the library; default: the only one with a setting for the operation", "NAME"},
      {"thickness", "--thickness", &o.thickness_mm,
       "Thickness of the material; default: that in the library", "MM", glass::positive},
      {"power", "--power", &o.power_percent, "Laser power", "PERCENT", {0, 100, false}},
      {"feed", "--feed", &o.feed_mm_min, "Feed rate along the contours", "MM_MIN", feed_range},
      {"kerf", "--kerf", &o.kerf_mm,
       "Width of the beam, by half of which contours are compensated; default: no compensation",
       "MM", glass::not_negative},
      {"passes",
       "--passes",
       &o.passes,
       "Passes of each contour at the present height; default: 1",
       "N",
       {1, max_cut_passes, true}},
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
      {"on_late",
       "--on-late",
       &o.on_late_s,
       "Time from the begin of each contour to laser on",
       "S",
       {0, max_dark_s, true}},
      {"off_early",
       "--off-early",
       &o.off_early_s,
       "Time from laser off to the end of each contour",
       "S",
       {0, max_dark_s, true}},
  };
}

std::vector<Parameter> side_parameters(OperationChoice& o) {
  return {
      {"compensation",
       "--compensation",
       &o.compensation,
       "Side of the beam. auto: outside of parts, inside of holes; inside, outside: of closed "
       "contours; left, right: of the direction of the cut; none; controller: as auto, by G41 and "
       "G42 "
       "of the machine",
       "",
       {},
       {"auto", "none", "left", "right", "inside", "outside", "controller"}},
      {"direction",
       "--direction",
       &o.direction,
       "auto: parts counter-clockwise, holes clockwise; drawn; reversed; cw; ccw",
       "",
       {},
       {"auto", "drawn", "reversed", "cw", "ccw"}},
  };
}

/// A way into a contour or out of it.
struct LeadChoice {
  std::string key, option, name, about;
  std::string& shape;
  double& size_mm;
  double& angle_deg;
};

std::vector<Parameter> lead_parameters(const LeadChoice& lead) {
  return {
      {lead.key, lead.option, &lead.shape, lead.about, "", {}, {"none", "line", "arc"}},
      {lead.key + "_mm", lead.option + "-mm", &lead.size_mm,
       "Length of the line or radius of the arc of the " + lead.name, "MM", glass::positive},
      {lead.key + "_angle",
       lead.option + "-angle",
       &lead.angle_deg,
       "Angle between the line and the contour, below 180, or angle that the arc turns",
       "DEG",
       {0, 270, false}},
  };
}

std::vector<Parameter> end_parameters(OperationChoice& o) {
  return {
      {"overcut", "--overcut", &o.overcut_mm,
       "Closed contours are cut past their start point by this distance", "MM",
       glass::not_negative},
      {"tabs",
       "--tabs",
       &o.tabs,
       "Tabs of each closed contour, which hold the part",
       "N",
       {0, max_cut_tabs, true}},
      {"tab_width", "--tab-width", &o.tab_mm,
       "Width of the material left in a tab; the beam is off over this and the kerf", "MM",
       glass::positive},
      {"tab_power", "--tab-power", &o.tab_power,
       "Power in tabs, or depth of a mill, in parts of that of the cut", "SHARE", glass::share},
      {"tab_corner", "--tab-corner", &o.tab_corner_mm, "Distance of tabs from corners", "MM",
       glass::not_negative},
  };
}

std::vector<Parameter> hatch_parameters(OperationChoice& o) {
  return {
      {"hatch", "--hatch", &o.hatch_mm, "Engravings: distance between the lines", "MM",
       hatch_range},
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
      {"text",
       "--text",
       &d.text,
       "outline: text becomes the outlines of its letters; stroke: lines along their middle; none: "
       "it "
       "is left out",
       "",
       {},
       {"outline", "stroke", "none"}},
      {"font", "--font", &d.font, "Font of the text: a file (ttf, otf) or a name, \"Arial:bold\"",
       "FONT"},
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
      glass::profile_parameter(m.profile),
      {"post", "--post", &m.post,
       "Post-processor: " + fmt::format("{}", fmt::join(cutting::post_names(), ", ")) +
           " or a file of templates (TOML)",
       "NAME"},
      {"surface", "--surface", &m.surface_mm,
       "Z at which the laser is in focus, or the tool touches, on the surface, for passes with "
       "depths",
       "MM", place_range},
      {"order",
       "--order",
       &m.order,
       "Search for the order with short rapid moves. improved: 2-opt and Or-opt, all orders of up "
       "to 8 contours; nearest: always the nearest contour; genetic: a genetic algorithm, slower",
       "",
       {},
       {cutting::order_search_names.begin(), cutting::order_search_names.end()}},
      {"population",
       "--population",
       &m.population,
       "Orders in each generation of --order genetic",
       "N",
       {2, 10'000, true}},
      {"clearance", "--clearance", &m.clearance_mm,
       "Mills, knives: height of rapids above the surface; lathes: distance from the contours; "
       "default: 5",
       "MM", glass::positive},
      {"ramp_angle",
       "--ramp-angle",
       &m.ramp_deg,
       "Mills: slope of the way into the sheet; default: 10",
       "DEG",
       {1, 89, true}},
      {"knife_offset",
       "--knife-offset",
       &m.knife_offset_mm,
       "Drag knives: distance of the tip of the blade from its swivel axis",
       "MM",
       {0, 50, true}},
  };
}

std::vector<Parameter> parameters(OperationChoice& operation) {
  std::vector<Parameter> list = choice_parameters(operation);
  append_parameters(list, material_parameters(operation));
  append_parameters(list, side_parameters(operation));
  append_parameters(
      list, lead_parameters({"lead_in", "--lead-in", "lead-in",
                             "Way from the pierce point, in the waste, to closed "
                             "contours",
                             operation.lead_in, operation.lead_in_mm, operation.lead_in_deg}));
  append_parameters(list,
                    lead_parameters({"lead_out", "--lead-out", "lead-out",
                                     "Way from closed contours into the waste", operation.lead_out,
                                     operation.lead_out_mm, operation.lead_out_deg}));
  append_parameters(list, end_parameters(operation));
  append_parameters(list, hatch_parameters(operation));
  return list;
}

}  // namespace lamplock::run
