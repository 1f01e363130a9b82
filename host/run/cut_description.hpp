// The description of a cutting job: a drawing, the machine, and what is done along the curves of
// each layer or colour, in one TOML file. Every key is an option of the command line too; there
// the description has one operation.
//
//   [drawing]      file, unit, place, tolerance
//   [machine]      profile, post-processor, height of the sheet
//   [[operation]]  cut, score, engrave or ignore: which curves, power, feed, ...
//
// In:  a file, or the options of a command line. Out: a description; text that reads back as the
//      same. Who: the use case of cutting.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/cutting/operation.hpp"
#include "host/cutting/tool_path.hpp"
#include "host/glass/parameters.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::run {

/// Passes of one cut, far above those of any material here: more are taken for a slip in a unit.
inline constexpr double max_cut_passes = 1000;

struct DrawingChoice {
  std::string file{};
  std::optional<std::string> units{};
  double tolerance_mm = 0.01;    ///< as cutting::JoinOptions
  std::string text = "outline";  ///< what becomes of text: outline, stroke, none
  std::string font = "sans";     ///< file, or name of a font of the computer
  std::optional<double> x_mm{}, y_mm{};
};

struct CutMachineChoice {
  std::string profile{};  ///< file; empty: the default machine
  std::string post = "grbl";
  double surface_mm = 0;
  std::string order = "improved";  ///< search for the order (cutting::OrderSearch)
  int population = 100;            ///< of the genetic one
  /// Of tools (cutting::Tooling); none: its default.
  std::optional<double> clearance_mm{}, ramp_deg{}, knife_offset_mm{};
};

/// One operation as its user writes it. The values that have no default here are those of a
/// material.
struct OperationChoice {
  std::optional<std::string> name{};
  std::vector<std::string> layers{}, colours{};  ///< empty: all
  std::string kind = "cut";
  bool is_off = false;

  std::optional<std::string> material{}, laser{};  ///< of the material library
  std::optional<double> thickness_mm{};
  std::optional<double> power_percent{}, feed_mm_min{}, kerf_mm{};
  std::optional<int> passes{};
  std::optional<double> infeed_mm{}, final_depth_mm{};
  bool has_air = false;
  double pierce_s = 0, on_late_s = 0, off_early_s = 0;

  std::string compensation = "auto", direction = "auto";
  std::string lead_in = "none", lead_out = "none";
  double lead_in_mm = 2, lead_out_mm = 2, lead_in_deg = 90, lead_out_deg = 90;
  double overcut_mm = 0;
  int tabs = 0;
  double tab_mm = 0.5, tab_power = 0, tab_corner_mm = 1;

  double hatch_mm = 0.1, hatch_deg = 0;
  std::optional<double> overscan_mm{};
};

struct CutDescription {
  DrawingChoice drawing{};
  CutMachineChoice machine{};
  std::vector<OperationChoice> operations{};
};

/// The parameters of each section, with references into the section, which must outlive them.
std::vector<glass::Parameter> parameters(DrawingChoice& drawing);  ///< `file` first
std::vector<glass::Parameter> parameters(CutMachineChoice& machine);
std::vector<glass::Parameter> parameters(OperationChoice& operation);

/// Names of files in it are relative to its folder. Throws Error(bad_input) at file and line:
/// syntax, unknown sections and keys, wrong kinds of values, values out of range, no drawing, no
/// operation.
CutDescription read_cut_description(const std::filesystem::path& file);

/// The text of a description for a file in `folder`, without default values.
std::string to_text(const CutDescription& description, const std::filesystem::path& folder);

/// The name of an operation in messages: its own, or its number from 1.
std::string operation_name(const OperationChoice& choice, std::size_t number);

/// What the shapes of an operation depend on: kind, compensation and direction.
cutting::Operation bare_operation(const OperationChoice& choice, const std::string& name);

/// The values for the plan, on a sheet whose surface has this height. Throws Error(bad_input) for
/// an operation without power or feed, with more than the machine has, for depths that do not
/// belong together, and for what a machine of this type or this kind of operation does not have.
cutting::Operation operation_of(const OperationChoice& choice, const std::string& name,
                                double surface_mm, cutting::MachineType machine,
                                const settings::Values& values);

/// Throws Error(bad_input) for values that a machine of this type does not have, and for a knife
/// without an offset.
cutting::Tooling tooling_of(const CutMachineChoice& choice, cutting::MachineType machine);

}  // namespace lamplock::run
