// The description of a job: everything that decides what is engraved where, and how, in one TOML
// file, so that a job can be repeated to the byte (examples/block.toml is a commented one).
//
//   [machine]   the profile and what is different for this job     [order]   in which order
//   [glass]     block, material, lens                              [pause]   against heat
//   [[object]]  one file each: its method, place and size          [output]  what is fired
//
// Every key is a parameter (parameters.hpp) and an option of the command line too; there the
// description has one object.
//
// In:  a file (description_file.hpp), or the options of a command line. Out: a Description.
// Who: `points`, `engrave`, `job`, `frame`, `estimate`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/glass/block.hpp"
#include "host/glass/parameters.hpp"
#include "host/order/order.hpp"

namespace lamplock::glass {

/// Which machine, and what is to be different for this job.
struct MachineChoice {
  std::string profile{};  ///< file; empty: the default machine
  std::optional<double> lamp_hz{}, accel_m_s2{}, speed_m_s{};
  std::optional<std::string> lamp_mode{};
  std::string mode = "free";
};

/// What is engraved into.
struct GlassChoice {
  std::optional<std::string> material{}, lens{};
  std::optional<double> index{};
  std::optional<Triple> block_mm{}, block_at_mm{};
  double margin_mm = default_margin_mm;
};

/// One file and how it becomes points. Lengths in mm, angles in degrees.
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
  double smallest_mm = 0;       ///< side of a filled face
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

/// In which order points are fired.
struct OrderChoice {
  std::optional<std::string> name{};
  double half_angle_deg = order::default_half_angle_deg;
  std::optional<double> layer_mm{};
  /// K+ and K- of the cone rule.
  double cone_up = order::OrderOptions{}.cone.up, cone_down = order::OrderOptions{}.cone.down;
};

/// Pauses against heat.
struct PauseChoice {
  int every_points = 0;  ///< 0: none
  int beats = 500;
};

/// What is fired at each point.
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

/// The parameters of each section, with places in what is given; that must outlive them.
std::vector<Parameter> parameters(MachineChoice& machine);
std::vector<Parameter> parameters(GlassChoice& glass);
std::vector<Parameter> parameters(Object& object);  ///< `file` first
std::vector<Parameter> parameters(OrderChoice& order);
std::vector<Parameter> parameters(PauseChoice& pause);
std::vector<Parameter> parameters(OutputChoice& output);

}  // namespace lamplock::glass
