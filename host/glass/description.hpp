// The description of a job: all parameters of the job in one TOML file, so that the job can be
// reproduced exactly (examples/block.toml has comments).
//
//   [machine]   the profile and changes of it for this job         [order]   the order of points
//   [glass]     block, material, lens                              [pause]   pauses against heat
//   [[object]]  one file each: its method, position and size       [output]  flashes, energy
//
// Every key is a parameter (parameters.hpp) and an option of the command line too; on the command
// line the description has one object.
//
// In:  a file (description_file.hpp), or the options of a command line. Out: a Description.
// Who: `points`, `engrave`, `job`, `frame`, `estimate`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/glass/block.hpp"
#include "host/glass/parameters.hpp"

namespace lamplock::glass {

/// The machine, and changes for this job.
struct MachineChoice {
  std::string profile{};  ///< file; empty: the default machine
  std::optional<double> lamp_hz{}, accel_m_s2{}, speed_m_s{};
  std::optional<std::string> lamp_mode{};
  std::string mode = "free";
};

/// The glass.
struct GlassChoice {
  std::optional<std::string> material{}, lens{};
  std::optional<double> index{};
  std::optional<Triple> block_mm{}, block_at_mm{};
  double margin_mm = default_margin_mm;
};

/// One file and the parameters that make points of it. Lengths in mm, angles in degrees.
struct Object {
  std::string file{};
  std::string up = "z";
  std::optional<double> size_mm{};
  std::vector<std::string> transform{};

  std::optional<std::string> method{};
  std::optional<double> spacing_mm{}, layer_mm{}, weld_mm{};
  int seed = 1;

  std::string axis = "z";  ///< of slices
  std::optional<Triple> turn_deg{};
  std::optional<double> first_mm{}, last_mm{};
  double twist_mm = 0;
  std::optional<bool> end_points{};
  std::string direction = "z";  ///< of rays
  double min_mm = 0;            ///< side of a filled face
  double light_depth_mm = 0, light_lowest = 0.05;

  int threshold = 128, layers = 1;
  std::string plane = "xy";
  bool invert = false;
  bool tone = false;
  double gamma = 1.8, tone_lowest = 0, tone_highest = 1;

  int shells = 1;
  std::optional<double> shell_mm{};
  double face_density = 1, depth_density = 1;
};

/// The firing order of points.
struct OrderChoice {
  std::optional<std::string> name{};
  double half_angle_deg = 20;  ///< of the cone of the beam; as host/order/cone.hpp
  std::optional<double> layer_mm{};
  /// K+ and K- of the cone rule, as host/order/order.hpp.
  double cone_up = 0.577, cone_down = 0.577;
};

/// Pauses against heat.
struct PauseChoice {
  int every_points = 0;  ///< 0: none
  int beats = 500;
};

/// The shots at each point.
struct OutputChoice {
  int flashes = 1, channel = 0, energy = 0;
};

struct Description {
  MachineChoice machine{};
  GlassChoice glass{};
  std::vector<Object> objects{};
  OrderChoice order{};
  PauseChoice pause{};
  OutputChoice output{};
};

/// The parameters of each section, with references into the section, which must outlive them.
std::vector<Parameter> parameters(MachineChoice& machine);
std::vector<Parameter> parameters(GlassChoice& glass);
std::vector<Parameter> parameters(Object& object);  ///< `file` first
std::vector<Parameter> parameters(OrderChoice& order);
std::vector<Parameter> parameters(PauseChoice& pause);
std::vector<Parameter> parameters(OutputChoice& output);

}  // namespace lamplock::glass
