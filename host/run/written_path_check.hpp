// Compares the moves that the interpreter makes of a cutting program with those of its plan, one
// by one: places, arcs, heights, feeds, powers.
//
// In:  the run of a program, the moves that its lines were written for. Out: an Error about the
//      post-processor. Who: checked_run().
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "host/cutting/post.hpp"
#include "host/program/program_run.hpp"

namespace lamplock::run {

/// A program that was run, and what it was written for.
struct WrittenProgram {
  std::string_view text;
  const std::vector<cutting::WrittenMove>& moves;
  const cutting::Post& post;
  double surface_mm = 0;        ///< Z above which a tool does not cut
  double arc_tolerance_mm = 0;  ///< of the chords that the interpreter makes of arcs
  bool has_dark_rapids = true;  ///< laser mode
};

/// How far the ends of moves may be from the plan: the rounding of positions.
double place_tolerance_mm(const cutting::Post& post);
/// The same of the way between them.
double way_tolerance_mm(const cutting::Post& post, double arc_tolerance_mm);

/// True if one of these lines has the value outside of comments.
bool writes_value(const cutting::Post& post, const std::vector<cutting::PostEvent>& events,
                  cutting::PostValue value);

/// A line of a text, from 1.
std::string_view line_of(std::string_view text, std::size_t number);

/// Throws Error(bad_input) with `where`, the post-processor, and the line: for a move of the plan
/// that ends elsewhere, takes another way, or has another feed or power, and for other moves with
/// light or in the workpiece. Feed and power are compared if the lines of the post-processor write
/// them. Takes a time proportional to the moves.
void require_written_path(const program_run::ProgramRun& run, const WrittenProgram& program,
                          const std::string& where);

}  // namespace lamplock::run
