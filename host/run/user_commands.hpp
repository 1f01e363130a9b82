// User commands of a program: M100 to M199 run programs of a folder that the user has named.
//
// In:  a folder, the lines of a program. Out: the commands of its lines, or an Error; their runs
//      while the machine is at rest. Who: `check`, `send`.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/link/line_sender.hpp"
#include "host/link/program_lines.hpp"
#include "host/program/user_command.hpp"
#include "host/run/child_process.hpp"
#include "host/run/frontend.hpp"
#include "host/run/program_refusal.hpp"

namespace lamplock::run {

/// Commands by the index of their line.
using CommandLines = std::map<std::size_t, program_run::UserCommand>;

/// Without a folder there are none. Throws Error(bad_input) at FILE:LINE for a command that the
/// folder does not have or that is not executable, and for a folder that does not exist.
/// `skips_expressions`: lines with values that are not known yet are left out.
CommandLines user_commands_of(const std::vector<link::ProgramLine>& lines, const std::string& file,
                              const std::string& folder, bool skips_expressions);

/// Runs the commands of a program. Errors name their line: FILE:LINE.
class UserCommands : public link::HostLines {
 public:
  /// `lines`, `program` and `progress` must outlive it.
  UserCommands(const CommandLines& lines, const ProgramText& program, std::string folder,
               Progress& progress)
      : lines_(lines), program_(program), folder_(std::move(folder)), progress_(progress) {}

  bool has(std::size_t index) const override { return lines_.contains(index); }
  bool run(std::size_t index) override;
  void stop() override { process_.reset(); }

 private:
  std::string place(std::size_t index) const;

  const CommandLines& lines_;
  const ProgramText& program_;
  std::string folder_;
  Progress& progress_;
  std::unique_ptr<ChildProcess> process_;
};

}  // namespace lamplock::run
