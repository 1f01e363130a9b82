// What can be said in each section of a description (declared in description.hpp).
#include <limits>

#include "host/error.hpp"
#include "host/glass/description.hpp"
#include "host/glass/lens.hpp"
#include "host/glass/material.hpp"
#include "host/glass/transformation.hpp"
#include "host/glass/unused.hpp"
#include "host/units.hpp"
#include "shared/settings_table.hpp"
#include "shared/wire/records.hpp"

namespace lamplock::glass {
namespace {

using settings::Id;
using Names = std::vector<std::string>;

constexpr double most_int = std::numeric_limits<int>::max();
constexpr double most_flashes = std::numeric_limits<std::uint8_t>::max();  ///< of a target
constexpr double most_beats = std::numeric_limits<std::uint16_t>::max();   ///< of a target
constexpr double most_energy = std::numeric_limits<std::uint16_t>::max();  ///< of a target
constexpr double lightest_grey = 255, most_layers = 10'000, most_shells = 255;
constexpr double steepest_deg = 89.9;

/// The range of a setting, in a unit of so many of its own.
Range range_of(Id id, double own_units) {
  const settings::Row& row = settings::row(id);
  return {row.min_milli / milli_per_unit / own_units, row.max_milli / milli_per_unit / own_units,
          true};
}

/// What is wrong with the words of a transformation.
std::string transformation_refusal(const std::string& words) {
  try {
    check_transformation(words, "");
    return "";
  } catch (const Error&) {
    return "'" + words +
           "' is none of: move X Y Z, rotate AXIS DEG, scale F, mirror AXIS, centre, fit";
  }
}

/// Ways that make layers.
Names layered() { return {"slice", way_of_drawings, way_of_bitmaps}; }
/// All methods of meshes.
Names methods() { return {default_method, "slice", "faces", "rays", "solid"}; }
/// All but lists, which stay as they are.
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

/// A parameter that only these use.
Parameter of(Names ways, Parameter parameter) {
  parameter.used_by = std::move(ways);
  return parameter;
}
/// A parameter that does nothing as long as nothing is said of another one.
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
      of(shaped(),
         {"size", "--size", &o.size_mm,
          "Longest side of the object; without it meshes and drawings are in mm and bitmaps 50 mm",
          "MM", positive}),
      of(methods(), {"up",
                     "--up",
                     &o.up,
                     "Meshes: axis of the file that points up (often y in OBJ)",
                     "",
                     {},
                     {"y", "z"}}),
      {"transform",
       "--transform",
       &o.transform,
       "Transformation in words, several in their order: \"move X Y Z\", \"rotate AXIS DEG\" about "
       "x, "
       "y, z or three numbers, \"scale F\", \"mirror AXIS\", \"centre\", \"fit\"",
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
          "Meshes: blue-noise (even at random, the default), slice (contours of layers), faces "
          "(filled triangles), rays (parallel rays), solid (the inside)",
          "",
          {},
          methods()}),
      of(shaped(),
         {"spacing", "--spacing", &o.spacing_mm,
          "Distance of neighbouring points; without it that of the lens, or 0.1", "MM", positive}),
      of(layered(),
         {"layer", "--layer", &o.layer_mm,
          "Distance of layers: slices, drawings, bitmaps; without it the spacing", "MM", positive}),
      of(shaped(),
         {"weld", "--weld", &o.weld_mm,
          "Points closer than this become one; without it 0.9 x spacing where a method does not "
          "itself keep the spacing",
          "MM", not_negative}),
      of(shaped(), {"seed",
                    "--point-seed",
                    &o.seed,
                    "Another seed, other points of what is random",
                    "N",
                    {0, most_int, true}}),
  };
}

std::vector<Parameter> mesh_parameters(Object& o) {
  return {
      of({"slice"},
         {"axis", "--axis", &o.axis, "Slices: axis that the planes face", "", {}, {"x", "y", "z"}}),
      of({"slice", "rays"},
         {"turn", "--turn", &o.turn_deg,
          "Slices, rays: the planes or rays turned about x, then y, then z", "DEG,DEG,DEG"}),
      of({"slice"}, {"first", "--first", &o.first_mm,
                     "Slices: first plane, from the lowest place on", "MM", not_negative}),
      of({"slice"}, {"last", "--last", &o.last_mm,
                     "Slices: no plane closer than this to the highest place", "MM", not_negative}),
      of({"slice", way_of_drawings},
         {"twist", "--twist", &o.twist_mm,
          "Slices, drawings: each layer starts so much further along", "MM"}),
      of({"slice", way_of_drawings},
         {"end_points", "--end-points", &o.end_points,
          "Open contours and curves get a point at each end; by default curves do"}),
      of({"rays"}, {"direction",
                    "--direction",
                    &o.direction,
                    "Rays: their direction",
                    "",
                    {},
                    {"x", "y", "z"}}),
      of({"faces"}, {"smallest", "--smallest", &o.smallest_mm,
                     "Faces: triangles without a side of this length are left out; 0: the spacing",
                     "MM", not_negative}),
      of({"solid"},
         {"light_depth", "--light-depth", &o.light_depth_mm,
          "Solid: each such thickness of points above thins a place to 1/e; 0: dense everywhere",
          "MM", not_negative}),
      with("light_depth", of({"solid"}, {"light_lowest",
                                         "--light-lowest",
                                         &o.light_lowest,
                                         "Solid: density is never less, 0..1",
                                         "SHARE",
                                         {0, 1, false}})),
  };
}

std::vector<Parameter> picture_parameters(Object& o) {
  return {
      of({way_of_bitmaps}, {"threshold",
                            "--threshold",
                            &o.threshold,
                            "Bitmaps: grey values below this are points, 0..255",
                            "GREY",
                            {0, lightest_grey, true}}),
      of(toned(), {"invert", "--invert", &o.invert,
                   "Light instead of dark becomes points; meshes: the reverse"}),
      of({way_of_drawings, way_of_bitmaps}, {"layers",
                                             "--layers",
                                             &o.layers,
                                             "Bitmaps, drawings: number of layers",
                                             "N",
                                             {1, most_layers, true}}),
      of({way_of_bitmaps}, {"plane",
                            "--plane",
                            &o.plane,
                            "Bitmaps: plane that the picture stands in",
                            "",
                            {},
                            {"xy", "xz", "yz"}}),
      of(toned(),
         {"tone", "--tone", &o.tone,
          "Density by grey value of a bitmap, or by colour or texture of a mesh (blue noise)"}),
      with("tone", of(toned(), {"gamma", "--gamma", &o.gamma,
                                "Tone: density is brightness to this power", "N", positive})),
      with("tone", of(toned(), {"tone_lowest", "--tone-lowest", &o.tone_lowest,
                                "Tone: density of the darkest, 0..1", "SHARE", share})),
      with("tone", of(toned(), {"tone_highest", "--tone-highest", &o.tone_highest,
                                "Tone: density of the brightest, 0..1", "SHARE", share})),
  };
}

std::vector<Parameter> depth_parameters(Object& o) {
  return {
      of(skins(),
         {"shells",
          "--shells",
          &o.shells,
          "Neighbours are spread over so many shells, one inside the other, against cracks; "
          "1: none",
          "N",
          {1, most_shells, true}}),
      with("shells", of(skins(), {"shell", "--shell", &o.shell_mm,
                                  "Distance of shells; without it the spacing", "MM", positive})),
      of(shaped(),
         {"face_density", "--face-density", &o.face_density,
          "Share of points kept next to the entry face, because deep ones look weaker, 0..1",
          "SHARE", share}),
      of(shaped(), {"depth_density", "--depth-density", &o.depth_density,
                    "Share of points kept at the bottom of the block, 0..1", "SHARE", share}),
  };
}

}  // namespace

std::vector<Parameter> parameters(MachineChoice& m) {
  return {
      {"profile",
       "--machine",
       &m.profile,
       "Machine profile (TOML); without it the default machine",
       "FILE",
       {},
       {},
       nullptr,
       true},
      {"mode",
       "--mode",
       &m.mode,
       "free: pass every point in motion; path: the same on straight lines; start-stop: rest at "
       "every point",
       "",
       {},
       {"free", "path", "start-stop"}},
      {"lamp", "--lamp", &m.lamp_hz, "Lamp frequency", "HZ", range_of(Id::lamp_frequency, 1)},
      {"lamp_mode",
       "--lamp-mode",
       &m.lamp_mode,
       "slave: the lamp runs freely, we follow; master: we trigger it; none: free beat",
       "",
       {},
       {"slave", "master", "none"}},
      {"accel", "--accel", &m.accel_m_s2, "Highest acceleration of every axis", "M_S2",
       range_of(Id::acceleration_x, mm_s2_per_m_s2)},
      {"speed", "--speed", &m.speed_m_s, "Highest speed of every axis", "M_S",
       range_of(Id::max_rate_x, mm_min_per_m_s)},
  };
}

std::vector<Parameter> parameters(GlassChoice& g) {
  return {
      {"material",
       "--material",
       &g.material,
       "What the glass is, for its refraction; without it coordinates are those of the stage",
       "",
       {},
       material_names()},
      {"index",
       "--index",
       &g.index,
       "Refractive index, instead of a material",
       "N",
       {1, highest_index, true}},
      {"block", "--block", &g.block_mm,
       "Size of the block; objects must lie inside it. Without it there is the work space alone",
       "MM,MM,MM", positive},
      with("block", {"at", "--block-at", &g.block_at_mm,
                     "Middle of the block; without it that of the work space", "MM,MM,MM"}),
      with("block", {"margin", "--margin", &g.margin_mm,
                     "Stays free inside the faces of the block, 3 to 5 mm", "MM", not_negative}),
      {"lens",
       "--lens",
       &g.lens,
       "Focal length 43 or 70 mm: spacing 0.09 or 0.13 mm unless --spacing says",
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
       "best: fewest beats; layers: lowest first, short way in each; serpentine: back and forth; "
       "nearest: nearest of the layer; cone: cheapest by way and height; given: as they come. "
       "Default: given "
       "for point lists, else best",
       "",
       {},
       {"best", "layers", "serpentine", "nearest", "cone", "given"}},
      of(orders({"best", "layers", "serpentine", "nearest", "cone"}),
         {"half_angle",
          "--half-angle",
          &o.half_angle_deg,
          "Half angle of the shadow under a point, in which none is fired later; 0: no shadow",
          "DEG",
          {0, steepest_deg, true}}),
      of(orders({"cone"}), {"cone_up", "--cone-up", &o.cone_up,
                            "Cone rule: cost of going up, a way sideways of so much", "MM_MM"}),
      of(orders({"cone"}),
         {"cone_down", "--cone-down", &o.cone_down, "Cone rule: gain of going down", "MM_MM"}),
      of(orders({"layers", "serpentine", "nearest"}),
         {"layer", "--order-layer", &o.layer_mm,
          "Thickness of a layer of the order; without it that of the points", "MM", positive}),
  };
}

std::vector<Parameter> parameters(PauseChoice& p) {
  return {
      {"every",
       "--pause-every",
       &p.every_points,
       "A pause against heat after so many points; 0: none",
       "N",
       {0, most_int, true}},
      with("every", {"beats",
                     "--pause-beats",
                     &p.beats,
                     "Length of a pause",
                     "BEATS",
                     {1, most_beats, true}}),
  };
}

std::vector<Parameter> parameters(OutputChoice& o) {
  return {
      {"flashes",
       "--flashes",
       &o.flashes,
       "Flashes at each point, one after the other",
       "N",
       {1, most_flashes, true}},
      {"channel", "--channel", &o.channel, "Beam channel", "N", {0, wire::highest_channel, true}},
      {"energy",
       "--energy",
       &o.energy,
       "Energy or attenuator value; 0: as the machine stands",
       "N",
       {0, most_energy, true}},
  };
}

}  // namespace lamplock::glass
