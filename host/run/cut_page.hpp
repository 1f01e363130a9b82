// The page of a cutting job (cutting/plan_page.hpp) from its plan and the run of its program.
//
// In:  what make_cut() has made. Out: the page as text. Who: make_cut().
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host/cutting/plan_page.hpp"
#include "host/program/program_run.hpp"
#include "host/run/cut.hpp"

namespace lamplock::run {

/// The program of a plan and what is known of its run.
struct CutProgram {
  std::vector<std::size_t> first_lines{};        ///< of each cut
  std::optional<program_run::ProgramRun> run{};  ///< none if it is not for a board of lamplock
  bool is_lathe = false;                         ///< the plan is in Z and the radius X
};

/// What the page shows of the plan: its title, picture and names of cuts are filled already.
cutting::PlanPage cut_page(cutting::PlanPage page, const CutProgram& program,
                           const CutResult& result);

}  // namespace lamplock::run
