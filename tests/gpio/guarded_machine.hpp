// A virtual board under a host that watches lines of its computer, as `engrave` and `send` do.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "host/cli/guarding.hpp"
#include "tests/board/rig.hpp"
#include "tests/gpio/model_lines.hpp"
#include "tests/gpio/typed_input.hpp"

namespace lamplock::test {

/// E-stop and door, closed to ground when all is well, and an interlock.
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
      : rig(profile), transport_(rig.board), guarding(make_lines(), guard_lines(), transport_) {
    // Simulated time stands still while what the board says is not read: its banner is read here.
    rig.run(ps_per_ms);
    std::array<std::uint8_t, 512> banner{};
    while (rig.board.read(banner) != 0) {
    }
    pins->on_output = [this](const std::string& place, bool level) {
      if (place == "I" && !level) interlock_fell = rig.board.now();
    };
  }

  /// Runs a job. `round`: called in the middle of each round, right behind the look at the lines,
  /// as late as something can happen for the next one.
  link::JobResult run(const job::Job& job, const std::function<void(link::JobSender&)>& round,
                      std::size_t from = 0) {
    link::SenderOptions options;
    options.session = 0x5EED;
    options.first_index = from;
    cli::Progress progress("test", job.size());
    link::JobSender sender(transport_, job, options);
    cli::Steering steering(sender, progress, cli::Clocking::wall);
    guarding.begin(gpio::Work::laser);
    while (sender.step()) {
      steering.look();
      guarding.look(steering, job.is_rows() ? cli::AtDoor::ends : cli::AtDoor::holds);
      round(sender);
    }
    guarding.end();
    return sender.result();
  }

  /// Runs a program.
  link::LineResult run(const std::string& program,
                       const std::function<void(link::LineSender&)>& round) {
    link::LinePort port(transport_);
    cli::Progress progress("test", 1);
    link::LineSender sender(port, link::program_lines(program, "test"));
    cli::LineSteering steering(sender, progress, cli::Clocking::wall, std::nullopt);
    guarding.begin(gpio::Work::laser);
    while (sender.step()) {
      steering.look();
      guarding.look(steering);
      round(sender);
    }
    guarding.end();
    return sender.result();
  }

  std::shared_ptr<ModelPins> pins = std::make_shared<ModelPins>();
  Rig rig;
  TypedInput keyboard{};
  sim::Picoseconds interlock_fell = 0;  ///< the last time

 private:
  std::unique_ptr<gpio::Lines> make_lines() { return std::make_unique<ModelLines>(pins); }

  link::SimulatedTransport transport_;

 public:
  cli::Guarding guarding;
};

}  // namespace lamplock::test
