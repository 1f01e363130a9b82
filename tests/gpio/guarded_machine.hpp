// A virtual board and a host that watches lines of its computer, as `engrave` and `send` do.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "host/cli/console.hpp"
#include "host/run/point_job_control.hpp"
#include "host/run/program_control.hpp"
#include "host/run/supervisor.hpp"
#include "tests/board/rig.hpp"
#include "tests/gpio/model_lines.hpp"
#include "tests/gpio/typed_input.hpp"

namespace lamplock::test {

/// E-stop and door, closed to ground in normal work, and an interlock.
inline gpio::LineTable guard_lines() {
  gpio::LineTable lines;
  lines.estop = gpio::LineRequest{.place = "E"};
  lines.door = gpio::LineRequest{.place = "D"};
  lines.interlock = gpio::LineRequest{.place = "I"};
  return lines;
}

/// Machine, lines and the host's loop over a job or a program.
class GuardedMachine {
 public:
  explicit GuardedMachine(const job::Profile& profile)
      : rig(profile), transport_(rig.board), supervisor(make_lines(), guard_lines(), transport_) {
    // Simulated time stops while the board's output is unread, so its banner is read here.
    rig.run(ps_per_ms);
    std::array<std::uint8_t, 512> banner{};
    while (rig.board.read(banner) != 0) {
    }
    pins->on_output = [this](const std::string& place, bool level) {
      if (place == "I" && !level) interlock_fell = rig.board.now();
    };
  }

  /// Runs a job. `round` is called in each round directly after the lines were read: the latest
  /// time at which an event takes effect in the next round.
  link::JobResult run(const job::Job& job, const std::function<void(link::JobSender&)>& round,
                      std::size_t from = 0) {
    link::SenderOptions options;
    options.session = 0x5EED;
    options.first_index = from;
    const auto progress = console_.progress("test", job.size(), 0);
    link::JobSender sender(transport_, job, options);
    run::PointJobControl control(sender, console_, *progress, run::Clocking::wall);
    supervisor.begin(gpio::LaserUse::laser);
    while (sender.step()) {
      control.poll();
      supervisor.poll(control, job.is_rows() ? run::AtDoor::ends : run::AtDoor::holds);
      round(sender);
    }
    supervisor.end();
    return sender.result();
  }

  link::LineResult run(const std::string& program,
                       const std::function<void(link::LineSender&)>& round) {
    link::LinePort port(transport_);
    const auto progress = console_.progress("test", 1, 0);
    link::LineSender sender(port, link::program_lines(program, "test"));
    run::ProgramTime time(std::nullopt, [](const auto&) { return std::optional<double>(); });
    run::ProgramControl control(sender, console_, *progress, run::Clocking::wall, time);
    supervisor.begin(gpio::LaserUse::laser);
    while (sender.step()) {
      control.poll();
      supervisor.poll(control, run::AtDoor::holds);
      round(sender);
    }
    supervisor.end();
    return sender.result();
  }

  std::shared_ptr<ModelPins> pins = std::make_shared<ModelPins>();
  Rig rig;
  TypedInput keyboard{};
  sim::Picoseconds interlock_fell = 0;  ///< latest time it was switched off

 private:
  std::unique_ptr<gpio::Lines> make_lines() { return std::make_unique<ModelLines>(pins); }

  link::SimulatedTransport transport_;
  cli::Console console_{false};

 public:
  run::Supervisor supervisor;
};

}  // namespace lamplock::test
