// The controller: formulas and closed loop on the model, by the figures of the source.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "host/error.hpp"
#include "host/thermal/control_tuning.hpp"

namespace lamplock::thermal::test {
namespace {

TEST(ControlTuning, OvershootAndSettlingOfTheSource) {
  const Plant plant{450, 0.2};
  const auto omega = [&](double band) {
    return tuned_loop(plant, {0.05, 0.028, band}).omega_rad_s;
  };
  EXPECT_NEAR(tuned_loop(plant, {}).zeta, 0.7512, 1e-4);
  EXPECT_NEAR(omega(0.05), 62.6, 0.1);
  EXPECT_NEAR(omega(0.02), 114.6, 0.1);
  EXPECT_NEAR(omega(0.01), 131.9, 0.2);
}

TEST(ControlTuning, ClosedLoopOnTheModel) {
  for (const Plant& plant : {Plant{450, 0.2}, Plant{30, 0.02}, Plant{1000, 3}}) {
    const LoopGoal goal;
    const LoopSettings loop = tuned_loop(plant, goal);
    const LoopResponse step = set_point_step(plant, loop, goal, 40);
    EXPECT_NEAR(step.settling_s, 0.05, 5e-4);
    EXPECT_NEAR(step.overshoot, 0.028, 5e-4);
    EXPECT_NEAR(step.deviations_k.back(), 40, 1e-3 * 40);
    const LoopResponse change = absorption_step(plant, loop, goal, 0.1);
    std::cout << "set point: " << step.settling_s << " s, overshoot " << step.overshoot
              << "; absorption +10 %: " << change.settling_s << " s, overshoot " << change.overshoot
              << "\n";
    EXPECT_LT(change.overshoot, 0.03);
    EXPECT_LT(change.settling_s, 0.07);
    EXPECT_NEAR(change.outputs.back(), 1 / 1.1, 1e-3);
    EXPECT_LT(std::abs(change.deviations_k.back()), 1e-3 * plant.gain_k);
  }
}

TEST(ControlTuning, OnABoardItIsAsMeasured) {
  // docs/thermal.md, 9: 0.055 to 0.059 s and 1.2 to 1.4 % on the flash image and the virtual board.
  const Plant plant{300, 0.05};
  const LoopGoal goal;
  const LoopResponse response =
      board_absorption_step(plant, tuned_loop(plant, goal), goal, 0.1, {});
  EXPECT_NEAR(response.settling_s, 0.055, 0.006);
  EXPECT_NEAR(response.overshoot, 0.014, 0.006);
  EXPECT_TRUE(is_calm(response));
}

TEST(ControlTuning, TheDelayOfTheBoardMakesFastLoopsOscillate) {
  const Plant fast{300, 0.005};
  const LoopGoal goal{0.01, 0.028, 0.05};
  EXPECT_FALSE(is_calm(board_absorption_step(fast, tuned_loop(fast, goal), goal, 0.1, {})));
  EXPECT_FALSE(shortest_on_board(fast, goal, 0.1, {}));
  const Plant slow{300, 0.05};
  const auto shortest = shortest_on_board(slow, goal, 0.1, {});
  ASSERT_TRUE(shortest);
  const LoopGoal longer{*shortest, 0.028, 0.05};
  EXPECT_TRUE(is_calm(board_absorption_step(slow, tuned_loop(slow, longer), longer, 0.1, {})));
}

TEST(ControlTuning, RefusesASlowGoal) {
  EXPECT_THROW((void)tuned_loop({450, 0.001}, {}), Error);
  EXPECT_THROW((void)tuned_loop({450, 0}, {}), Error);
  EXPECT_THROW((void)tuned_loop({450, 1}, {0.05, 1.5, 0.05}), Error);
}

}  // namespace
}  // namespace lamplock::thermal::test
