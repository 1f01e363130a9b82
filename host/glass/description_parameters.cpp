// The parameters of each section of a description (declared in description.hpp).
#include <limits>

#include "host/error.hpp"
#include "host/glass/description.hpp"
#include "host/glass/lens.hpp"
#include "host/glass/material.hpp"
#include "host/glass/profile_parameter.hpp"
#include "host/glass/transformation.hpp"
#include "host/glass/unused_parameters.hpp"
#include "host/units.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/records.hpp"

namespace lamplock::glass {
namespace {

using settings::Id;
using Names = std::vector<std::string>;

constexpr double max_int = std::numeric_limits<int>::max();
constexpr double max_flashes = std::numeric_limits<std::uint8_t>::max();  ///< of a target
constexpr double max_beats = std::numeric_limits<std::uint16_t>::max();   ///< of a target
constexpr double max_energy = std::numeric_limits<std::uint16_t>::max();  ///< of a target
constexpr double lightest_grey = 255, max_layers = 10'000, max_shells = 255;
constexpr double steepest_deg = 89.9;

/// Only the remainder by the length of a curve has an effect, and the product with the number of
/// layers must stay exact.
constexpr double max_twist_mm = 1000;

/// The range of a setting, in a unit that is `own_units` of its own units.
Range range_of(Id id, double own_units) {
  const settings::Row& row = settings::row(id);
  return {row.min_milli / milli_per_unit / own_units, row.max_milli / milli_per_unit / own_units,
          true};
}

/// Empty, or the error in the words of a transformation.
std::string transformation_refusal(const std::string& words) {
  try {
    check_transformation(words, "");
    return "";
  } catch (const Error&) {
    return "'" + words +
           "' has not the form of a transformation: move X Y Z, rotate AXIS DEG, scale F (not 0), "
           "mirror AXIS, centre, fit";
  }
}

/// Ways that make layers.
Names layered() { return {"slice", way_of_drawings, way_of_bitmaps}; }
/// All methods of meshes.
Names methods() { return {default_method, "slice", "faces", "rays", "solid"}; }
/// All but point lists, whose points are not changed.
Names shaped() {
  Names names = methods();
  names.insert(names.end(), {way_of_drawings, way_of_bitmaps});
  return names;
}
/// Ways that put points on surfaces or curves.
Names skins() {
  Names names = shaped();
  std::erase(names, "solid");
  return names;
}
Names toned() { return {default_method, way_of_bitmaps}; }
Names orders(const Names& names) {
  Names ways;
  ways.reserve(names.size());
  for (const std::string& name : names) ways.push_back(way_of_order(name));
  return ways;
}

/// A parameter that only these ways use.
Parameter of(Names ways, Parameter parameter) {
  parameter.used_by = std::move(ways);
  return parameter;
}
/// A parameter without effect while another one has its default.
Parameter with(const char* key, Parameter parameter) {
  parameter.needs = key;
  return parameter;
}

void append(std::vector<Parameter>& list, std::vector<Parameter> more) {
  for (Parameter& parameter : more) list.push_back(std::move(parameter));
}

std::vector<Parameter> model_parameters(Object& o) {
  return {
      {"file",
       "INPUT",
       &o.file,
       "Mesh, drawing, bitmap or point list",
       "FILE",
       {},
       {},
       nullptr,
       true},
      of(shaped(), {"size", "--size", &o.size_mm,
                    "Length of the longest side; default: size in the file for meshes and "
                    "drawings, 50 mm for bitmaps",
                    "MM", positive}),
      of(methods(), {"up",
                     "--up",
                     &o.up,
                     "Meshes: axis of the file that points up (often y in OBJ; GLB always y)",
                     "",
                     {},
                     {"y", "z"}}),
      {"transform",
       "--transform",
       &o.transform,
       "Transformations, applied in order: \"move X Y Z\", \"rotate AXIS DEG\" about x, y, z or an "
       "axis of three numbers, \"scale F\", \"mirror AXIS\", \"centre\", \"fit\"",
       "WORDS",
       {},
       {},
       transformation_refusal},
  };
}

std::vector<Parameter> method_parameters(Object& o) {
  return {
      of(methods(),
         {"method",
          "--method",
          &o.method,
          "Meshes: blue-noise (random and even, the default), slice (contours of layers), faces "
          "(filled triangles), rays (parallel rays), solid (the inside)",
          "",
          {},
          methods()}),
      of(shaped(), {"spacing", "--spacing", &o.spacing_mm,
                    "Distance between neighbouring points; default: spacing of the lens, 0.1 mm "
                    "without a lens",
                    "MM", positive}),
      of(layered(),
         {"layer", "--layer", &o.layer_mm,
          "Method slice, drawings, bitmaps: distance between layers; default: the spacing", "MM",
          positive}),
      of(shaped(),
         {"weld", "--weld", &o.weld_mm,
          "Merge points closer than this; default: for method rays 0.9 x spacing; for slices, "
          "drawings and bitmaps the same inside each layer; other methods need no merging",
          "MM", not_negative}),
      of(shaped(),
         {"seed", "--point-seed", &o.seed, "Seed of the random points", "N", {0, max_int, true}}),
  };
}

std::vector<Parameter> mesh_parameters(Object& o) {
  return {
      of({"slice"}, {"axis",
                     "--axis",
                     &o.axis,
                     "Method slice: axis normal to the planes",
                     "",
                     {},
                     {"x", "y", "z"}}),
      of({"slice", "rays"},
         {"turn", "--turn", &o.turn_deg,
          "Methods slice and rays: rotation of the planes or rays about x, then y, then z",
          "DEG,DEG,DEG"}),
      of({"slice"},
         {"first", "--first", &o.first_mm,
          "Method slice: height of the first plane above the lowest point; default: half a layer",
          "MM", not_negative}),
      of({"slice"},
         {"last", "--last", &o.last_mm,
          "Method slice: minimum distance from the last plane to the highest point; default: 0",
          "MM", not_negative}),
      of({"slice", way_of_drawings},
         {"twist",
          "--twist",
          &o.twist_mm,
          "Method slice, drawings: offset of the start point along each "
          "closed curve, added in each layer",
          "MM",
          {-max_twist_mm, max_twist_mm}}),
      of({"slice", way_of_drawings}, {"end_points", "--end-points", &o.end_points,
                                      "Method slice, drawings: place a point at both ends of open "
                                      "contours and curves; default: drawings only"}),
      of({"rays"}, {"direction",
                    "--direction",
                    &o.direction,
                    "Method rays: direction of the rays",
                    "",
                    {},
                    {"x", "y", "z"}}),
      of({"faces"},
         {"smallest", "--smallest", &o.min_mm,
          "Method faces: skip triangles whose sides are all shorter than this; 0 skips none", "MM",
          not_negative}),
      of({"solid"},
         {"light_depth", "--light-depth", &o.light_depth_mm,
          "Method solid: thickness of the solid above a point at which the density falls to "
          "1/e; 0: constant density",
          "MM", not_negative}),
      with("light_depth",
           of({"solid"}, {"light_lowest",
                          "--light-lowest",
                          &o.light_lowest,
                          "Method solid: minimum density, as a share of the density at the surface",
                          "SHARE",
                          {0, 1, false}})),
  };
}

std::vector<Parameter> picture_parameters(Object& o) {
  return {
      of({way_of_bitmaps}, {"threshold",
                            "--threshold",
                            &o.threshold,
                            "Bitmaps: grey values below this become points",
                            "GREY",
                            {0, lightest_grey, true}}),
      of(toned(),
         {"invert", "--invert", &o.invert,
          "Bitmaps: light parts become points, not dark ones; meshes with --tone: more points in "
          "dark parts"}),
      of({way_of_drawings, way_of_bitmaps},
         {"layers",
          "--layers",
          &o.layers,
          "Bitmaps, drawings: number of layers, one above the other",
          "N",
          {1, max_layers, true}}),
      of({way_of_bitmaps}, {"plane",
                            "--plane",
                            &o.plane,
                            "Bitmaps: plane of the picture",
                            "",
                            {},
                            {"xy", "xz", "yz"}}),
      of(toned(), {"tone", "--tone", &o.tone,
                   "Vary the density by the grey value of a bitmap, or by the colour or texture of "
                   "a mesh (blue noise)"}),
      with("tone",
           of(toned(), {"gamma", "--gamma", &o.gamma,
                        "With --tone: exponent from brightness to density", "N", positive})),
      with("tone", of(toned(), {"tone_lowest", "--tone-lowest", &o.tone_lowest,
                                "With --tone: density of the darkest parts", "SHARE", share})),
      with("tone", of(toned(), {"tone_highest", "--tone-highest", &o.tone_highest,
                                "With --tone: density of the brightest parts", "SHARE", share})),
  };
}

std::vector<Parameter> depth_parameters(Object& o) {
  return {
      of(skins(),
         {"shells",
          "--shells",
          &o.shells,
          "Distribute neighbouring points over this number of parallel surfaces (shells), to "
          "avoid cracks; 1: off",
          "N",
          {1, max_shells, true}}),
      with("shells",
           of(skins(), {"shell", "--shell", &o.shell_mm,
                        "Distance between shells; default: the spacing", "MM", positive})),
      of(shaped(), {"face_density", "--face-density", &o.face_density,
                    "Fraction of points kept near the face where the beam enters; less than "
                    "1 balances the weaker look of deep points",
                    "SHARE", share}),
      of(shaped(), {"depth_density", "--depth-density", &o.depth_density,
                    "Fraction of points kept at the bottom of the block", "SHARE", share}),
  };
}

}  // namespace

Parameter profile_parameter(std::string& file) {
  return {"profile", "--machine", &file, "Machine profile (TOML); default: built-in settings",
          "FILE",    {},          {},    nullptr,
          true};
}

std::vector<Parameter> parameters(MachineChoice& m) {
  return {
      profile_parameter(m.profile),
      {"mode",
       "--mode",
       &m.mode,
       "free: fire while moving, each axis moves freely between points; path: fire while moving on "
       "straight lines; start-stop: stop at every point",
       "",
       {},
       {"free", "path", "start-stop"}},
      {"lamp", "--lamp", &m.lamp_hz, "Lamp frequency", "HZ", range_of(Id::lamp_frequency, 1)},
      {"lamp_mode",
       "--lamp-mode",
       &m.lamp_mode,
       "slave: follow a free-running lamp; master: trigger the lamp; none: the board generates the "
       "beat itself, without a lamp",
       "",
       {},
       {"slave", "master", "none"}},
      {"accel", "--accel", &m.accel_m_s2, "Maximum acceleration of each axis in m/s2", "M_S2",
       range_of(Id::acceleration_x, mm_s2_per_m_s2)},
      {"speed", "--speed", &m.speed_m_s, "Maximum speed of each axis in m/s", "M_S",
       range_of(Id::max_rate_x, mm_min_per_m_s)},
  };
}

std::vector<Parameter> parameters(GlassChoice& g) {
  return {
      {"material",
       "--material",
       &g.material,
       "Material of the glass, defines its refractive index; default: none, no refraction",
       "",
       {},
       material_names()},
      {"index",
       "--index",
       &g.index,
       "Refractive index, used instead of a material",
       "N",
       {1, max_index, true}},
      {"block", "--block", &g.block_mm,
       "Size of the block; objects must lie inside it; default: no block, objects must lie in the "
       "work space",
       "MM,MM,MM", positive},
      with("block", {"at", "--block-at", &g.block_at_mm,
                     "Centre of the block; default: centre of the work space", "MM,MM,MM"}),
      with("block", {"margin", "--margin", &g.margin_mm,
                     "Minimum distance of points from the faces of the block, usually 3 to 5 mm",
                     "MM", not_negative}),
      {"lens",
       "--lens",
       &g.lens,
       "Lens of focal length 43 or 70 mm; sets the default spacing to 0.09 or 0.13 mm",
       "",
       {},
       lens_names()},
  };
}

std::vector<Parameter> parameters(Object& object) {
  std::vector<Parameter> list = model_parameters(object);
  append(list, method_parameters(object));
  append(list, mesh_parameters(object));
  append(list, picture_parameters(object));
  append(list, depth_parameters(object));
  return list;
}

std::vector<Parameter> parameters(OrderChoice& o) {
  return {
      {"by",
       "--order",
       &o.name,
       "best: fewest beats; layers: lowest layer first, a short path in each; serpentine: back and "
       "forth in each layer; nearest: nearest point of the layer; cone: point with the lowest cost "
       "of distance and height; given: order of the file; default: given for point lists, "
       "otherwise best",
       "",
       {},
       {"best", "layers", "serpentine", "nearest", "cone", "given"}},
      of(orders({"best", "layers", "serpentine", "nearest", "cone"}),
         {"half_angle",
          "--half-angle",
          &o.half_angle_deg,
          "Half angle of the cone below a point; points inside the cone are fired before that "
          "point; 0: no such rule",
          "DEG",
          {0, steepest_deg, true}}),
      of(orders({"cone"}),
         {"cone_up", "--cone-up", &o.cone_up,
          "Cone order: 1 mm upward counts as this many mm sideways when the next point is chosen",
          "MM_MM", not_negative}),
      of(orders({"cone"}),
         {"cone_down", "--cone-down", &o.cone_down,
          "Cone order: 1 mm downward counts as this many mm less sideways when the next point is "
          "chosen",
          "MM_MM", not_negative}),
      of(orders({"layers", "serpentine", "nearest"}),
         {"layer", "--order-layer", &o.layer_mm,
          "Layer thickness used to sort the points; default: layer distance of the points, 0.1 mm "
          "for point lists",
          "MM", positive}),
  };
}

std::vector<Parameter> parameters(PauseChoice& p) {
  return {
      {"every",
       "--pause-every",
       &p.every_points,
       "Pause after this number of points to let the glass cool; 0: no pauses",
       "N",
       {0, max_int, true}},
      with("every", {"beats",
                     "--pause-beats",
                     &p.beats,
                     "Duration of a pause",
                     "BEATS",
                     {1, max_beats, true}}),
  };
}

std::vector<Parameter> parameters(OutputChoice& o) {
  return {
      {"flashes",
       "--flashes",
       &o.flashes,
       "Number of flashes at each point",
       "N",
       {1, max_flashes, true}},
      {"channel", "--channel", &o.channel, "Beam channel", "N", {0, wire::max_channel, true}},
      {"energy",
       "--energy",
       &o.energy,
       "Energy or attenuator value; 0: keep the machine's current value",
       "N",
       {0, max_energy, true}},
  };
}

}  // namespace lamplock::glass
