#include "host/gpio/board_lines.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "host/error.hpp"
#include "host/gpio/blocked_signals.hpp"

namespace lamplock::gpio {
namespace {

/// A pin of the board that is pulled low; released with the object.
class Pulled {
 public:
  Pulled(Lines& lines, const LineRequest& wanted)
      : place_(wanted.place), output_(lines.output(wanted, true)) {}
  ~Pulled() { output_->set(false); }
  Pulled(const Pulled&) = delete;
  Pulled& operator=(const Pulled&) = delete;

  /// Throws Error(no_device) if the line was lost: the pulse at the board is unknown then.
  void release() {
    if (!output_->set(false))
      throw Error(Exit::no_device, place_, "the line was lost during a reset",
                  "plug its chip in again and repeat the command");
  }

 private:
  std::string place_;
  std::unique_ptr<Output> output_;
};

const LineRequest& wired(const std::optional<LineRequest>& line, const char* role,
                         const char* pin) {
  if (line) return *line;
  throw Error(Exit::bad_input, "--lines", fmt::format("names no line for the board's {} pin", pin),
              fmt::format("wire one and add [{}] to the file", role));
}

void pulse_run(Lines& lines, const LineTable& table, const Sleep& sleep) {
  Pulled run(lines, wired(table.run, "run", "RUN"));
  sleep(reset_pulse);
  run.release();
}

}  // namespace

void reset_board(Lines& lines, const LineTable& table, const Sleep& sleep) {
  const LaterSignals signals_wait;
  pulse_run(lines, table, sleep);
}

void expect_loader_lines(const LineTable& table) {
  wired(table.run, "run", "RUN");
  wired(table.bootsel, "bootsel", "BOOTSEL");
}

void enter_loader(Lines& lines, const LineTable& table, const Sleep& sleep) {
  expect_loader_lines(table);  // before the first pin is pulled
  const LaterSignals signals_wait;
  Pulled bootsel(lines, wired(table.bootsel, "bootsel", "BOOTSEL"));
  pulse_run(lines, table, sleep);
  sleep(boot_select_hold);
  bootsel.release();
}

void real_sleep(std::chrono::milliseconds time) { std::this_thread::sleep_for(time); }

}  // namespace lamplock::gpio
