// The stream of executed blocks of a program, as JSON lines for another program.
//
// In:  the sender of a program, after each of its steps. Out: a line for each block that the board
//      has executed, and one for the end. Who: run_program(), for `send --events`.
//
// A block counts as executed as soon as the board reports that it executes a later one, that it is
// at rest with all lines answered, or answers a line that it executes at rest (G4, M0, M2...).
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "host/error.hpp"
#include "host/link/line_sender.hpp"
#include "host/program/block_outputs.hpp"
#include "host/run/event_stream.hpp"
#include "host/run/frontend.hpp"

namespace lamplock::run {

class ProgramEvents {
 public:
  /// Between reports of the board: how late a block is written.
  static constexpr std::chrono::milliseconds status_interval{50};

  /// `path`: of the stream, for messages; stream and lines, as they are sent, are kept by the
  /// caller; `state`: of the board before the program.
  ProgramEvents(EventStream& stream, std::string path, const std::vector<link::ProgramLine>& lines,
                const settings::Values& values, const program_run::BoardState* state);

  /// Writes the blocks that were executed since the last call; never throws. A loss is shown once.
  void poll(const link::LineSender& sender, Progress& progress);
  /// Writes the rest, and the end of this name.
  void end(const link::LineSender& sender, const std::string& name, Progress& progress);
  bool is_lost() const { return !stream_.loss().empty(); }

 private:
  void add_block(const link::LineSender& sender, std::size_t index);
  void show_loss(Progress& progress);

  std::string path_;
  const std::vector<link::ProgramLine>& lines_;
  EventStream& stream_;
  program_run::BlockOutputs outputs_;
  std::size_t written_ = 0;  ///< blocks
  std::size_t errors_ = 0;   ///< of the sender, of blocks that were written
  bool is_shown_ = false;    ///< the loss
};

/// Writes the end of a program of which nothing was sent: its only line.
void write_refusal(EventStream& stream, std::string_view message);

/// Makes such a stream of an error before with_events(); nothing without a path.
void replace_events(const std::string& path, const Error& error);

/// The stream of a program.
struct OpenedEvents {
  EventStream* stream = nullptr;  ///< null: none is wanted
  bool& is_sent;                  ///< to set when the program has ended, and its events
};

/// Opens the stream, if `path` is not empty, before anything can refuse the program, so that it
/// never has the end of an earlier one. An error of `run` before the first line is its end.
template <class Run>
auto with_events(const std::string& path, const Run& run) {
  bool is_sent = false;
  if (path.empty()) return run(OpenedEvents{nullptr, is_sent});
  EventStream::check(path);
  EventStream stream(path);
  try {
    return run(OpenedEvents{&stream, is_sent});
  } catch (const Error& error) {
    if (!is_sent) write_refusal(stream, error.message());
    throw;
  }
}

}  // namespace lamplock::run
