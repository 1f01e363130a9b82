// The program of a cut, run by the interpreter and the planner of the firmware, and compared with
// its plan: a post-processor whose lines scale, move or bend the path is found before the machine
// runs it.
//
// In:  a program, its plan. Out: the run, or an Error about the post-processor. Who: make_cut().
#pragma once

#include <optional>
#include <string>

#include "host/cutting/cut_plan.hpp"
#include "host/cutting/post.hpp"
#include "host/geometry/bounds.hpp"
#include "host/program/program_run.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::run {

/// A program and where it is to run.
struct PlannedProgram {
  const std::string& text;
  const cutting::ProgramLines& lines;
  const cutting::CutPlan& plan;
  const std::vector<cutting::Operation>& operations;
  const cutting::Post& post;
  const cutting::ProgramFrame& frame;
  geometry::Bounds box{};  ///< of the plan, mm; of a knife larger than the contours by its offset
  bool is_dark = false;    ///< a dry run or a frame
};

/// Throws Error(bad_input) with `where`, the post-processor, if the interpreter refuses a line, if
/// a move is not that of the plan (written_path_check.hpp), if the program changes the coordinate
/// system, and if a laser may have light in a dark program. With compensation by the controller the
/// moves are compared in a program without it, and of each compensated contour box and length.
program_run::ProgramRun checked_run(const PlannedProgram& program, const settings::Values& values,
                                    const std::string& where);

}  // namespace lamplock::run
