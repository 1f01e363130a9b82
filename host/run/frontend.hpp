// What a use case needs of the program that a user sits at: a terminal, or the page of a server.
//
// In:  texts, phases and progress of a use case; the user's interrupts, typed lines and answers.
// Out: interfaces only; host/cli/console.hpp implements them for a terminal.
// Who: every use case of host/run. No function here is called in a hot path.
#pragma once

#include <fmt/core.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lamplock::run {

/// What a user has to know of a running job beside its progress.
struct ProgressState {
  std::string word;             ///< "held", "door open", "stopping"; empty while the machine works
  std::string speed;            ///< "speed 150 %"; empty at the speed of the job
  std::string typed;            ///< keys that the user has typed, before Enter
  std::vector<double> place{};  ///< of the machine, as reported, mm; empty: not known
};

/// The progress of one thing, shown until the object is destroyed.
class Progress {
 public:
  virtual ~Progress() = default;
  virtual void update(std::size_t done) = 0;
  /// Replaces the time left that follows from the pace so far; nullopt: use the pace again.
  virtual void set_left(std::optional<double> seconds) = 0;
  /// While the machine does not work, its time is not part of the pace; another speed begins
  /// another pace.
  virtual void set_state(const ProgressState& state) = 0;
  /// Shows a line that stays.
  virtual void note(const std::string& line) = 0;
};

/// Requests of the user to end what runs, counted as long as the object exists.
class Interrupts {
 public:
  virtual ~Interrupts() = default;
  /// Requests since the start or the last forget(); a request that must not be taken for a pause
  /// (SIGTERM, a closed terminal) counts as two.
  virtual int count() const = 0;
  /// The user has resumed: the next request is the first again.
  virtual void forget() = 0;
};

/// Lines that the user types while something runs.
class LineInput {
 public:
  virtual ~LineInput() = default;
  /// All lines that have come, without their ends. Waits at most this time for the first one.
  virtual std::vector<std::string> lines(std::chrono::milliseconds wait) = 0;
  /// Reads what has come and keeps it for lines(): ended() is then right at once.
  virtual void read_ahead() = 0;
  /// No further line will come, as far as has been read.
  virtual bool ended() const = 0;
  /// A user types the lines; false for a file or a pipe, and in the background.
  virtual bool is_typed() const = 0;
  /// The user has no buttons: texts say which keys there are.
  virtual bool needs_keys_shown() const { return is_typed(); }
  /// The line that the user has begun to type, where the input does not show it by itself.
  virtual std::string begun() const = 0;
};

/// The user's side of one use case.
class Frontend {
 public:
  virtual ~Frontend() = default;

  template <class... Args>
  void say(fmt::format_string<Args...> format, Args&&... args) {
    line(fmt::format(format, std::forward<Args>(args)...));
  }
  /// Shows one line of the result.
  virtual void line(const std::string& text) = 0;
  /// Shows several lines, as they are.
  virtual void text(const std::string& text) = 0;
  /// Throws Error if a line of the result was lost: the address of a server must be seen before it
  /// waits for others.
  virtual void require_output() {}
  /// Shows a line that is not part of the result.
  virtual void notice(const std::string& text) = 0;
  /// Ends a phase that began at the end of the phase before: its name, its result, its time.
  virtual void phase(const std::string& name, const std::string& what) = 0;
  /// The next phase begins now.
  virtual void restart_clock() = 0;
  /// `title` names what makes progress; `first` of `total` were done before.
  virtual std::unique_ptr<Progress> progress(std::string title, std::size_t total,
                                             std::size_t first) = 0;

  virtual std::unique_ptr<Interrupts> interrupts() = 0;
  /// Lines beside a progress.
  virtual std::unique_ptr<LineInput> line_input() = 0;
  /// Lines of a dialogue, without a progress.
  virtual std::unique_ptr<LineInput> dialogue_input() = 0;
  /// A user can answer a question.
  virtual bool can_ask() const = 0;
  /// Asks a question that only the word "yes" affirms.
  virtual bool confirms(const std::string& question) = 0;
};

}  // namespace lamplock::run
