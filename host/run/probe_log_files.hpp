// Writes the probe logs of a program while it runs, in a folder that the user has named.
//
// In:  a program with its questions (host/program/probe_log.hpp), texts of the board. Out: a file
//      for each log, a line for each contact as soon as the board reports it. What cannot be
//      written does not stop the machine; it is reported at the end.
// Who: run_program(), for `send --probe-logs`.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/link/line_sender.hpp"
#include "host/program/probe_log.hpp"
#include "host/run/event_stream.hpp"
#include "host/run/lost_files.hpp"

namespace lamplock::run {

class ProbeLogFiles {
 public:
  /// Throws Error(bad_input) before anything moves: the folder does not exist, a log cannot be
  /// written, is not a regular file, or is the program itself.
  static void check(const std::string& folder, const std::vector<std::string>& names,
                    const std::string& program);

  /// Of a program that has questions. Both must outlive it.
  ProbeLogFiles(const std::vector<link::ProgramLine>& lines,
                const std::vector<program_run::LoggedProbe>& probes, std::string folder,
                const settings::Values& values, const program_run::BoardState& state)
      : lines_(lines),
        probes_(probes),
        folder_(std::move(folder)),
        answers_(lines, probes, values, state) {}

  /// Takes a text of the board. False if it is not about a log.
  bool take(const std::string& text, const link::LineSender& sender);
  /// Empties the files of logs that the program has opened.
  void poll(const link::LineSender& sender);
  /// Writes the rest; adds what is lost.
  void finish(LostFiles& lost);

 private:
  void open_to(std::size_t line);
  EventStream* file_of(const std::string& name);

  const std::vector<link::ProgramLine>& lines_;
  const std::vector<program_run::LoggedProbe>& probes_;
  std::string folder_;
  program_run::ProbeAnswers answers_;
  std::size_t opened_ = 0;  ///< lines whose logs are open
  std::map<std::string, std::unique_ptr<EventStream>> files_;
  std::map<std::string, std::string> failed_;  ///< why a file could not be opened
};

}  // namespace lamplock::run
