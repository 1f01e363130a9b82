// Very many random chains through the planner: 25 000 in an everyday run, 100 000 in the full
// one.
//
// Each is checked for speed and acceleration of every axis, work space, exact end points, exact
// beats, and at every commitment for a brake to rest inside all limits: the phases analytically, a
// hundredth of the chains tick by tick.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>

#include "tests/motion/plan_checks.hpp"
#include "tests/scale.hpp"

namespace lamplock::motion {
namespace {

using test::Chain;
using test::ChainPlan;
using test::Fault;

/// Number of shares that can run in parallel.
constexpr int shares = 4;
constexpr int chains = 50'000;
/// One chain in this many is checked tick by tick, up to a number of ticks.
constexpr int tick_by_tick_every = 100;
constexpr long max_ticks = 2'000'000;

/// The first fault of chain `number`, in either mode.
Fault fault_of(std::uint64_t number, Planner& planner) {
  std::mt19937_64 random(number * 0x9e3779b97f4a7c15u + 4700);
  // Mostly short chains; one in eight needs several windows.
  const std::size_t points = random() % 8 == 0 ? 40 + random() % 80 : 3 + random() % 22;
  Chain chain = test::random_chain(random, points);
  // Seven of eight are free: resting at every point is the simpler case.
  chain.mode = random() % 8 == 0 ? wire::JoinMode::start_stop : wire::JoinMode::free;
  ChainPlan plan;
  Fault fault = test::chain_fault(chain, planner, plan);
  if (!fault && number % tick_by_tick_every == 0)
    fault = test::ticks_fault(chain.limits, plan.segments, max_ticks);
  return fault;
}

class ManyChains : public testing::TestWithParam<int> {};

TEST_P(ManyChains, KeepEveryLimitAndCanAlwaysStop) {
  const auto planner = std::make_unique<Planner>();
  const auto count = static_cast<std::uint64_t>(test::scaled(chains));
  for (auto number = static_cast<std::uint64_t>(GetParam()); number < count; number += shares) {
    const Fault fault = fault_of(number, *planner);
    ASSERT_EQ(fault, Fault{}) << "chain " << number;
  }
}

INSTANTIATE_TEST_SUITE_P(Share, ManyChains, testing::Range(0, shares));

}  // namespace
}  // namespace lamplock::motion
