// Post-processors: how the moves of a plan are written as lines of a program.
//
// In:  the templates of one controller (post_file.hpp), a plan. Out: the text of a program.
// Who: the use case of cutting.
//
// A template is the text of a line with values in braces: "G1 X{x} Y{y}". A part in square brackets
// is left out if none of its values has changed since a line with them: "G1[ X{x}][ F{feed}]".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cutting/tool_path.hpp"
#include "host/cutting/written_move.hpp"

namespace lamplock::cutting {

/// When lines are written.
enum class PostEvent : std::uint8_t {
  begin,        ///< of the program
  comment,      ///< before each shape
  operation,    ///< before the first shape of an operation, and after another one
  rapid,        ///< to where a stroke begins, dark
  height,       ///< Z of a pass; of tools the clearance before a rapid
  sink,         ///< of tools: with feed to the height where a stroke begins, or a tab
  shape_begin,  ///< at the begin of a stroke
  pierce,       ///< a wait with the laser on
  power,        ///< before the first move with another power
  line,
  arc_cw,
  arc_ccw,
  shape_end,  ///< at the end of a stroke
  left,       ///< the controller leads the beam to the left of the contour
  right,
  uncompensated,  ///< no longer
  air_on,
  air_off,
  end  ///< of the program
};
inline constexpr std::array<const char*, 19> post_event_names{
    "begin",  "comment",       "operation", "rapid",   "height",  "sink",      "shape_begin",
    "pierce", "power",         "line",      "arc_cw",  "arc_ccw", "shape_end", "left",
    "right",  "uncompensated", "air_on",    "air_off", "end"};

/// Names of the values of templates.
enum class PostValue : std::uint8_t {
  x,
  y,
  z,
  i,
  j,
  diameter,  ///< twice y: X of a lathe
  feed,
  power,
  seconds,
  text,
  tool,
  operation,
  kerf  ///< diameter of the beam or tool
};
inline constexpr std::array<const char*, 13> post_value_names{
    "x",     "y",       "z",    "i",    "j",         "diameter", "feed",
    "power", "seconds", "text", "tool", "operation", "kerf"};

struct Post {
  std::string name, about;
  MachineType machine = MachineType::laser;
  int decimals = 4;  ///< of positions in mm
  /// The program is for a board of this project: its interpreter checks it.
  bool is_checked = true;
  std::array<std::vector<std::string>, post_event_names.size()> lines;

  const std::vector<std::string>& of(PostEvent event) const {
    return lines[static_cast<std::size_t>(event)];
  }
};

/// Empty, or what is wrong with a template.
std::string template_fault(const std::string& text);

struct ProgramFrame {
  std::string title;               ///< the first comment
  std::vector<std::string> names;  ///< of each shape, for comments
  double max_s = 1000;             ///< S word of the maximum power
  Tooling tooling{};
  /// Diameters are radii: a program for the interpreter that checks it, which has no diameters.
  bool has_radii = false;
  /// Without the lines `left`, `right`, `uncompensated`: the machine follows the drawn contours,
  /// which a check can compare with the plan.
  bool is_uncompensated = false;
};

/// Numbers of lines of a program, from 1.
struct ProgramLines {
  std::vector<std::size_t> first{};  ///< of each cut
  std::size_t end = 0;               ///< the first one after all cuts
  std::vector<WrittenMove> moves{};  ///< in the order of their lines
};

/// The program. Moves that the rounding of positions makes nothing are left out. `lines` gets the
/// numbers of its lines, if it is not null. Throws Error (bad_input) as lathe_path().
std::string cut_program(const CutPlan& plan, const std::vector<Operation>& operations,
                        const Post& post, const ProgramFrame& frame, ProgramLines* lines = nullptr);

}  // namespace lamplock::cutting
