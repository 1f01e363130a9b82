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
  geometry::Bounds box{};      ///< of the plan, mm
  double knife_offset_mm = 0;  ///< by which the box is larger than the contours
};

/// Throws Error(bad_input) with `where`, the post-processor, if the interpreter refuses a line, or
/// if the moves of the cuts with a feed leave the box of the plan, do not fill it, or have another
/// length. Not compared: rapids, lines before and after the cuts, Z of a laser.
program_run::ProgramRun checked_run(const PlannedProgram& program, const settings::Values& values,
                                    const std::string& where);

}  // namespace lamplock::run
