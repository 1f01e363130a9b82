// The files of a cutting job: program, picture, page, description. All are written or none.
//
// In:  names in the request, what make_cut() has made. Out: files, or an Error and nothing.
// Who: make_cut().
#pragma once

#include <string>
#include <vector>

#include "host/cutting/cut_plan.hpp"
#include "host/run/cut.hpp"
#include "host/run/cut_page.hpp"

namespace lamplock::run {

/// Proves before the work that the files can be written. Throws Error(bad_input), also for names
/// of another kind, for two outputs of one name, and for a description beside options that it does
/// not have: a dry run, a frame, a first cut.
void check_cut_outputs(const CutRequest& request);

struct CutMade {
  const cutting::CutPlan& plan;
  const std::vector<cutting::Shape>& shapes;
  const std::vector<cutting::Operation>& operations;
  const std::string& title;
  const std::vector<std::string>& names;  ///< of each shape
  const CutProgram& program;
  const CutResult& result;
};

/// The page for a report of a run.
CutReport report_of(const CutMade& made);

/// Throws Error(bad_input) if a file cannot be written.
void write_cut_files(const CutRequest& request, const CutMade& made, Frontend& frontend);

}  // namespace lamplock::run
