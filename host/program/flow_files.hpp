// The files of subroutines that a program calls.
//
// In:  the program; a label that is called. Out: the unit that has its sub: the unit of the call,
//      the program, or a file LABEL.ngc of the program's folder, read once.
// Who: program_flow.cpp.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "host/program/flow_unit.hpp"
#include "host/program/program_error.hpp"

namespace lamplock::program_run {

class FlowFiles {
 public:
  /// `program` must outlive it.
  explicit FlowFiles(const FlowUnit& program) : program_(program) {}

  /// Throws ProgramError: at `where`, the place of the call, if there is no such sub; about the
  /// file if it does not have the sub, or an error of its own.
  const FlowUnit* with_sub(const std::string& label, const FlowUnit& caller,
                           const ProgramPlace& where);

 private:
  const FlowUnit& program_;
  std::map<std::string, std::unique_ptr<FlowUnit>> files_;
};

}  // namespace lamplock::program_run
