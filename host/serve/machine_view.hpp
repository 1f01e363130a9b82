// What the clients of the server see of the machine: plain values, copied under a lock.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lamplock::material {
struct JobRecord;
}

namespace lamplock::serve {

struct BoardView {
  bool is_connected = false;
  std::string problem;  ///< why it is not connected
  std::string state;    ///< of the last report: "Idle", "Run", "Hold:0"
  std::vector<double> machine_mm, work_mm;
  std::vector<int> overrides;  ///< feed, rapid, power, per cent
  bool jogs = false;           ///< a jog may move the machine
  friend bool operator==(const BoardView&, const BoardView&) = default;
};

struct JobView {
  bool is_running = false;
  std::string name;
  bool is_dry = false;
  std::string title;  ///< "sending", "engraving"
  std::size_t done = 0, total = 0;
  std::optional<double> left_s{};
  std::string word;   ///< "held", "door open"; empty while the machine works
  std::string speed;  ///< empty at the speed of the job
  std::string end;    ///< of the last job: "done", "stopped", "failed"; empty before
  std::string message;
  friend bool operator==(const JobView&, const JobView&) = default;
};

/// A job that has ended, for the history.
struct EndedJob {
  JobView view;
  std::string item = "line";  ///< what `view` counts
  std::chrono::system_clock::time_point begin{}, end{};
  std::optional<std::int64_t> wasted_beats{};  ///< of points: lamp flashes without a shot
  /// Makes the page of its report; takes seconds, and may throw Error. Null: it has none.
  std::function<std::string(const material::JobRecord&)> report{};
};

struct MachineView {
  BoardView board;
  JobView job;
};

/// A line of the console; the numbers are consecutive.
struct ConsoleLine {
  std::uint64_t number = 0;
  std::string text;
};

}  // namespace lamplock::serve
