#include "host/run/cut_program_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "host/cutting/dark_program.hpp"
#include "host/error.hpp"
#include "host/run/written_path_check.hpp"
#include "host/units.hpp"

namespace lamplock::run {
namespace {

using cutting::MachineType;
using program_run::Piece;
using program_run::Pieces;
using program_run::ProgramRun;

constexpr std::size_t axis_x = 0, axis_y = 1, axis_z = 2;
constexpr std::array<const char*, 3> axis_names{"X", "Y", "Z"};

[[noreturn]] void refuse_path(const std::string& where, const std::string& what) {
  throw Error(Exit::bad_input, where, "the path of its program is not that of the plan: " + what,
              "correct its templates, with G21 G90 at the begin, or write checked = false for "
              "another controller");
}

/// The part of a range that a path runs through, mm.
struct AxisRange {
  double low = 0, high = 0;
};

/// Where the moves of cuts with a feed are.
struct CutPath {
  std::array<AxisRange, 3> ranges{};
  double length_mm = 0;  ///< in X and Y
};

CutPath path_of(const ProgramRun& run, const cutting::ProgramLines& lines) {
  CutPath path;
  bool is_empty = true;
  const auto add = [&](const auto& at) {
    for (std::size_t axis = 0; axis < path.ranges.size(); ++axis) {
      AxisRange& range = path.ranges[axis];
      range.low = is_empty ? at[axis] : std::min(range.low, at[axis]);
      range.high = is_empty ? at[axis] : std::max(range.high, at[axis]);
    }
    is_empty = false;
  };
  const Piece* before = nullptr;
  for (const Piece& piece : run.pieces) {
    const bool is_of_cut = piece.line >= lines.first.front() && piece.line < lines.end;
    if (is_of_cut && !piece.rapid) {
      // Where rapids are written as G1, the first one comes from somewhere else.
      if (before != nullptr && before->rapid) add(piece.from);
      add(piece.to);
      path.length_mm +=
          std::hypot(piece.to[axis_x] - piece.from[axis_x], piece.to[axis_y] - piece.from[axis_y]);
    }
    before = &piece;
  }
  return path;
}

/// Lengths of all passes of a laser.
struct PlannedLengths {
  double cuts_mm = 0, rapids_mm = 0;
  std::size_t moves = 0;
};

PlannedLengths lengths_of(const PlannedProgram& program) {
  PlannedLengths lengths;
  cutting::Vec at;
  for (const cutting::PlannedCut& cut : program.plan.cuts) {
    const cutting::Operation& operation = program.operations[cut.operation];
    const std::size_t passes =
        operation.z_mm.empty() ? static_cast<std::size_t>(operation.passes) : operation.z_mm.size();
    for (std::size_t pass = 0; pass < passes; ++pass) {
      for (const cutting::Stroke& stroke : cut.strokes) {
        lengths.rapids_mm += distance(at, stroke.front().edge.from);
        for (const cutting::CutMove& move : stroke) lengths.cuts_mm += length_of(move.edge);
        lengths.moves += stroke.size();
        at = stroke.back().edge.to;
      }
    }
  }
  return lengths;
}

bool has_controller(const PlannedProgram& program) {
  return std::ranges::any_of(program.plan.cuts,
                             [](const auto& cut) { return cut.controller.has_value(); });
}

/// How far the path may be from that of the plan.
double slack_of(const PlannedProgram& program, const settings::Values& values) {
  // Arcs whose radii differ by this part at their ends are written as arcs (post.cpp).
  constexpr double max_apart = 0.001, min_slack_mm = 0.01;
  const double size_mm =
      std::hypot(program.box.high.x - program.box.low.x, program.box.high.y - program.box.low.y,
                 program.box.high.z - program.box.low.z);
  double slack_mm = min_slack_mm + max_apart * size_mm + 2 * std::pow(10, -program.post.decimals) +
                    in_units(values, settings::Id::arc_tolerance);
  // The dark entry is as long as the beam is wide, and ends beside the contour.
  double max_kerf_mm = 0;
  if (has_controller(program))
    for (const cutting::Operation& one : program.operations)
      max_kerf_mm = std::max(max_kerf_mm, one.kerf_mm);
  slack_mm += 2 * max_kerf_mm;
  return slack_mm;
}

void require_ranges(const PlannedProgram& program, const CutPath& path, double slack_mm,
                    const std::string& where) {
  const geometry::Bounds& box = program.box;
  const std::array<AxisRange, 3> planned{
      {{box.low.x, box.high.x}, {box.low.y, box.high.y}, {box.low.z, box.high.z}}};
  const MachineType machine = program.post.machine;
  for (std::size_t axis = 0; axis < planned.size(); ++axis) {
    if (axis == axis_z && machine == MachineType::laser) continue;
    const AxisRange plan = planned[axis], run = path.ranges[axis];
    const bool is_inside = run.low >= plan.low - slack_mm && run.high <= plan.high + slack_mm;
    // The box has rapids, too: of a lathe in X, of the others in Z.
    const bool has_rapids = axis == (machine == MachineType::lathe ? axis_x : axis_z);
    const double margin_mm = slack_mm + 2 * program.frame.tooling.knife_offset_mm;
    const bool is_filled =
        has_rapids || (run.low <= plan.low + margin_mm && run.high >= plan.high - margin_mm);
    if (!is_inside || !is_filled)
      refuse_path(where, fmt::format("{} runs from {:.3f} to {:.3f} mm, the plan from {:.3f} to "
                                     "{:.3f} mm",
                                     axis_names[axis], run.low, run.high, plan.low, plan.high));
  }
}

/// The ramps of mills, the corners of knives and the entries of controllers are not counted.
void require_length(const PlannedProgram& program, const CutPath& path, const std::string& where) {
  if (program.post.machine != MachineType::laser || has_controller(program)) return;
  constexpr double max_part = 0.01, min_apart_mm = 0.1;
  const PlannedLengths planned = lengths_of(program);
  const double apart_mm =
      min_apart_mm + max_part * (planned.cuts_mm + planned.rapids_mm) +
      2 * std::pow(10, -program.post.decimals) * static_cast<double>(planned.moves);
  const auto is_near = [&](double length_mm) {
    return std::abs(path.length_mm - length_mm) <= apart_mm;
  };
  // Controllers without rapids have feeds instead.
  if (is_near(planned.cuts_mm) || is_near(planned.cuts_mm + planned.rapids_mm)) return;
  refuse_path(where,
              fmt::format("its moves with a feed have {:.3f} mm, those of the plan {:.3f} mm",
                          path.length_mm, planned.cuts_mm));
}

/// Where the lit moves of a contour are that the controller compensates.
struct LitPath {
  cutting::Box box;
  double length_mm = 0;
};

LitPath lit_path_of(const Pieces& pieces, std::size_t& next, std::size_t end_line) {
  LitPath path;
  for (; next < pieces.size() && pieces[next].line < end_line; ++next) {
    const Piece& piece = pieces[next];
    if (piece.s == 0 || piece.rapid) continue;
    const cutting::Vec from{piece.from[axis_x], piece.from[axis_y]},
        to{piece.to[axis_x], piece.to[axis_y]};
    path.box.add(from);
    path.box.add(to);
    path.length_mm += distance(from, to);
  }
  return path;
}

/// The lit moves of each contour run around its compensated path.
void require_compensated(const PlannedProgram& program, const ProgramRun& run, double way_mm,
                         const std::string& where) {
  std::size_t next = 0;
  lit_path_of(run.pieces, next, program.lines.first.front());
  for (std::size_t i = 0; i < program.plan.cuts.size(); ++i) {
    const cutting::PlannedCut& cut = program.plan.cuts[i];
    const bool is_last = i + 1 == program.plan.cuts.size();
    const LitPath lit =
        lit_path_of(run.pieces, next, is_last ? program.lines.end : program.lines.first[i + 1]);
    const cutting::Operation& operation = program.operations[cut.operation];
    if (!cut.controller || lit.length_mm == 0) continue;
    LitPath planned;
    std::size_t moves = 0;
    for (const cutting::Stroke& stroke : cut.strokes) {
      for (const cutting::CutMove& move : stroke) {
        planned.box.add(cutting::box_of(move.edge));
        planned.length_mm += length_of(move.edge);
        ++moves;
      }
    }
    const auto passes =
        static_cast<double>(operation.z_mm.empty() ? static_cast<std::size_t>(operation.passes)
                                                   : operation.z_mm.size());
    // Chords are shorter than their arcs, and the controller rounds each corner.
    constexpr double max_part = 0.001;
    const double apart_mm = std::abs(lit.length_mm / passes - planned.length_mm);
    const bool is_near =
        apart_mm <= way_mm * static_cast<double>(moves + 1) + max_part * planned.length_mm;
    const cutting::Box &a = lit.box, &b = planned.box;
    const double box_mm = std::max({std::abs(a.low.x - b.low.x), std::abs(a.low.y - b.low.y),
                                    std::abs(a.high.x - b.high.x), std::abs(a.high.y - b.high.y)});
    if (is_near && box_mm <= way_mm) continue;
    refuse_path(where, fmt::format("cut {} with compensation has {:.3f} mm of light, X {:.3f} to "
                                   "{:.3f} mm, the plan {:.3f} mm, X {:.3f} to {:.3f} mm",
                                   cut.number, lit.length_mm / passes, a.low.x, a.high.x,
                                   planned.length_mm, b.low.x, b.high.x));
  }
}

void require_written(const PlannedProgram& program, const ProgramRun& run,
                     const settings::Values& values, const std::string& where) {
  const double arc_tolerance_mm = in_units(values, settings::Id::arc_tolerance);
  const auto require = [&](const ProgramRun& done, std::string_view text,
                           const cutting::ProgramLines& lines) {
    require_written_path(done,
                         {text, lines.moves, program.post, program.frame.tooling.surface_mm,
                          arc_tolerance_mm, values.whole(settings::Id::laser_mode) != 0},
                         where);
  };
  if (!has_controller(program)) return require(run, program.text, program.lines);
  require_compensated(program, run, way_tolerance_mm(program.post, arc_tolerance_mm), where);
  cutting::ProgramFrame frame = program.frame;
  frame.is_uncompensated = true;
  cutting::ProgramLines lines;
  const std::string text =
      cutting::cut_program(program.plan, program.operations, program.post, frame, &lines);
  require(program_run::run_program(text, values, 1), text, lines);
}

void require_dark_run(const PlannedProgram& program, const ProgramRun& run,
                      const std::string& where) {
  if (!program.is_dark || program.post.machine != MachineType::laser || run.light_line == 0) return;
  cutting::refuse_light(where, run.light_line, line_of(program.text, run.light_line));
}

void require_first_system(const PlannedProgram& program, const ProgramRun& run,
                          const std::string& where) {
  if (run.system_line == 0) return;
  refuse_path(where, fmt::format("line {}, '{}', changes the coordinate system", run.system_line,
                                 line_of(program.text, run.system_line)));
}

}  // namespace

ProgramRun checked_run(const PlannedProgram& program, const settings::Values& values,
                       const std::string& where) {
  ProgramRun run = program_run::run_program(program.text, values, 1);
  if (!run.problems.empty()) {
    const program_run::Problem& problem = run.problems.front();
    throw Error(Exit::bad_input, where,
                fmt::format("the interpreter refuses line {} of the program: {}", problem.line,
                            problem.text),
                "correct the templates of the post-processor, or give the profile of the machine");
  }
  require_dark_run(program, run, where);
  require_first_system(program, run, where);
  const CutPath path = path_of(run, program.lines);
  require_ranges(program, path, slack_of(program, values), where);
  require_length(program, path, where);
  require_written(program, run, values, where);
  return run;
}

}  // namespace lamplock::run
