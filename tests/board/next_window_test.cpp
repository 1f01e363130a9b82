// The next window is never that of another place.
#include "firmware/machine/runners/next_window.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "tests/scale.hpp"

namespace lamplock::machine {
namespace {

/// A job in its queue and the search for its next window.
struct Looking {
  motion::PointQueue queue;
  lamp::BeamPath beam;
  RunOptions options;
  motion::PlanRequest request;
  NextWindow window{queue, beam, options, request};
};

wire::Target random_target(std::mt19937_64& random) {
  wire::Target target;
  target.shots = static_cast<std::uint8_t>(random() % 4 == 0 ? random() % 6 : 1);
  target.beats = static_cast<std::uint16_t>(random() % 5);
  return target;
}

/// The result equals that of a fresh search at the same place.
void expect_as_fresh(const Looking& it, const Departure& departure) {
  motion::PlanRequest request;
  NextWindow fresh(it.queue, it.beam, it.options, request);
  fresh.continue_at(it.window.place());
  fresh.fill_request(departure);
  ASSERT_EQ(it.window.ready(), fresh.ready());
  ASSERT_EQ(it.request.count, request.count);
  if (request.count == 0) return;
  ASSERT_EQ(it.request.rest_at_end, request.rest_at_end);
  ASSERT_EQ(it.request.known_end, request.known_end);
  for (std::uint32_t i = 0; i < request.count; ++i) {
    ASSERT_EQ(it.request.points[i], request.points[i]);
    ASSERT_EQ(it.request.rest[i], request.rest[i]);
    ASSERT_EQ(it.request.at_least[i], request.at_least[i]);
  }
}

/// However handing out continues: after shots (also during a brake, which returns points), after
/// moves handed out, after a return to missed points.
TEST(NextWindow, IsThatOfThePlaceWhereHandingOutContinues) {
  std::mt19937_64 random(1);
  for (int job = 0; job < test::scaled(50); ++job) {
    SCOPED_TRACE(job);
    const auto it = std::make_unique<Looking>();
    it->options.points_total = 300;
    const Departure departure{random() % 2 == 0, random() % 2 == 0, random() % 2 == 0};
    while (it->queue.begin() != it->options.points_total) {
      switch (random() % 6) {
        case 0:
          for (auto n = random() % 60; n != 0 && it->queue.end() != it->options.points_total; --n)
            it->queue.push(random_target(random));
          it->window.forget();
          break;
        case 1:
          it->window.continue_at({it->queue.begin(), 0});
          break;
        case 2:
          it->window.fill_request(departure);
          if (it->window.empty()) break;
          it->window.continue_at(it->window.place_after(
              0, 1 + static_cast<std::uint32_t>(random() % it->request.commits())));
          break;
        default: {
          if (it->queue.size() == 0) break;
          const std::uint32_t point = it->queue.begin();
          it->queue.mark_done(point);
          it->window.flash_fired(point);
          if (it->window.place().point < it->queue.begin())
            it->window.continue_at({it->queue.begin(), 0});
        }
      }
      it->window.fill_request(departure);
      ASSERT_NO_FATAL_FAILURE(expect_as_fresh(*it, departure));
    }
  }
}

/// The search runs once; points that arrive later count in the next search.
TEST(NextWindow, IsSearchedOnceUntilForgotten) {
  Looking it;
  it.options.points_total = 2;
  it.queue.push({});
  it.window.fill_request({});
  it.queue.push({});
  it.window.fill_request({});
  EXPECT_EQ(it.request.count, 1u);
  EXPECT_FALSE(it.window.ready());
  it.window.forget();
  it.window.fill_request({});
  EXPECT_EQ(it.request.count, 2u);
  EXPECT_TRUE(it.window.ready());
}

}  // namespace
}  // namespace lamplock::machine
