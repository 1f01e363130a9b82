// The sender of text at a virtual board, whose controller reports when the machine is at rest.
#pragma once

#include <gmock/gmock.h>

#include "tests/board/rig.hpp"
#include "tests/program_sender.hpp"

namespace lamplock::test {

class ProgramHost : public ProgramSender {
 public:
  enum class Banner { dropped, kept };
  explicit ProgramHost(Rig& rig, Banner banner = Banner::dropped, std::size_t window = 1024)
      : ProgramSender(rig.board, window), rig_(rig) {
    if (banner == Banner::kept) return;
    run(ps_per_ms);
    forget_lines();
  }

  /// Streams a program until all lines are answered and the machine is at rest. False if that took
  /// longer.
  bool stream(std::string_view text, double seconds = 100) {
    const Picoseconds end = rig_.now() + picoseconds(seconds);
    give(text);
    while (!answered() && rig_.now() < end) step(ps_per_ms / 2);
    return answered() && wait_for_rest(seconds);
  }
  /// Runs until the machine is at rest with nothing left to do; false if that took longer.
  bool wait_for_rest(double seconds = 100) {
    const Picoseconds end = rig_.now() + picoseconds(seconds);
    while (rig_.now() < end) {
      if (rig_.state() == MachineState::idle && rig_.board.controller().program().idle())
        return true;
      run_ms(0.5);
    }
    return false;
  }
  /// Position of the ticks handed out.
  StepPosition position() const {
    const stepper::MotionState at = rig_.board.controller().runner().generator().state();
    StepPosition steps{};
    for (std::size_t a = 0; a < steps.size(); ++a) steps[a] = at.axis[a].step();
    return steps;
  }

 private:
  Rig& rig_;
};

/// Sends the program given to a sender, with holds at random moments, each resumed at another feed
/// rate; returns the number of holds.
inline int send_with_holds(Rig& rig, ProgramSender& sender, std::mt19937_64& random) {
  constexpr std::uint8_t faster = 0x91, slower = 0x92;
  const Pick<Picoseconds> pick(random);
  const Picoseconds end = rig.now() + 60 * ps_per_s;
  int holds = 0;
  for (; !sender.answered() && rig.now() < end; ++holds) {
    sender.step(pick(60 * ps_per_ms));
    sender.send("!");
    sender.step(pick(300 * ps_per_ms));
    sender.send(random() % 2 == 0 ? faster : slower);
    sender.send("~");
  }
  EXPECT_TRUE(sender.run_until_idle(end));
  EXPECT_EQ(sender.errors(), 0u);
  rig.run(20 * ps_per_ms);
  return holds;
}

}  // namespace lamplock::test
