// Slices of planning are short in every mode, however often a window is replanned. A caller may
// wait for a slice that long, and the watchdog must be fed in each.
#include <algorithm>
#include <cmath>

#include "sim/chip/profile/shadow_stack.hpp"
#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

using settings::for_axis;

/// Measures slices on core 1, which has no interrupts.
class SliceWatch final : private sim::chip::StackView {
 public:
  explicit SliceWatch(ChipRig& rig)
      : core_(rig.board.chip().core(1)), stack_(core_, flash_image().symbols) {
    stack_.add(*this);
  }
  SliceWatch(const SliceWatch&) = delete;
  SliceWatch& operator=(const SliceWatch&) = delete;

  int count() const { return count_; }
  double max_ms() const { return static_cast<double>(longest_) / cycles_per_ms; }
  double mean_ms() const { return static_cast<double>(total_) / count_ / cycles_per_ms; }

 private:
  static constexpr double cycles_per_ms = 125'000;

  void entered(const sim::chip::ShadowFrame& /*frame*/) override {}
  void left(const sim::chip::ShadowFrame& frame) override {
    if (frame.symbol >= stack_.functions().size() ||
        stack_.functions()[frame.symbol].name.find("Controller::plan(") == std::string::npos)
      return;
    const sim::chip::Cycle took = core_.cycle() - frame.since;
    ++count_;
    total_ += took;
    longest_ = std::max(longest_, took);
  }

  sim::chip::Core& core_;
  sim::chip::ShadowStack stack_;
  int count_ = 0;
  sim::chip::Cycle total_ = 0, longest_ = 0;
};

/// Runs a job to its end. `max_ms`: the limit in the headers (controller.hpp).
void expect_short_slices(const job::Profile& profile, JoinMode mode,
                         const geometry::PointCloud& cloud, double max_ms) {
  ChipRig rig(profile);
  const SliceWatch slices(rig);
  job::JobOptions options;
  options.mode = mode;
  const job::Job job = job::make_job(cloud, profile, options);
  ASSERT_NO_FATAL_FAILURE(run_to_the_end(rig, job));
  std::printf("%d slices, mean %.2f ms, longest %.2f ms\n", slices.count(), slices.mean_ms(),
              slices.max_ms());
  EXPECT_GT(slices.count(), static_cast<int>(cloud.size()));
  EXPECT_LE(slices.max_ms(), max_ms);
  EXPECT_EQ(rig.board.chip().watchdog_resets(), 0u);
}

TEST(Slices, OfAllModesAreShort) {
  for (const JoinMode mode : {JoinMode::start_stop, JoinMode::path, JoinMode::free}) {
    SCOPED_TRACE(testing::Message() << "mode " << static_cast<int>(mode));
    job::Profile profile = chip_profile(1000);
    job::set_acceleration(profile, 10);
    for (int axis = 0; axis < 3; ++axis)
      job::state_setting(profile, for_axis(Id::speed_jump_x, axis), 45, "test");
    expect_short_slices(profile, mode, chip_points(40, 7), 10);
  }
}

/// With jerk limits the search of a path takes longer per point; both modes are tested.
TEST(Slices, WithLimitsOfJerkAreShort) {
  for (const JoinMode mode : {JoinMode::path, JoinMode::free})
    for (const double jerk_m_s3 : {2000.0, 100.0}) {
      SCOPED_TRACE(testing::Message() << "mode " << static_cast<int>(mode) << ", " << jerk_m_s3);
      job::Profile profile = chip_profile(500);
      job::set_acceleration(profile, 10);
      for (int axis = 0; axis < 3; ++axis) {
        job::state_setting(profile, for_axis(Id::speed_jump_x, axis), 45, "test");
        job::state_setting(profile, for_axis(Id::jerk_x, axis), jerk_m_s3, "test");
      }
      expect_short_slices(profile, mode, chip_points(20, 7), 20);
    }
}

/// Corners from which an axis cannot stop inside become full stops, one after the other, and each
/// replans the window: in one slice that exceeded the watchdog's period.
TEST(Slices, OfAPathAlongTheEndsOfTheWorkSpaceAreShort) {
  job::Profile profile = chip_profile(1000);
  job::set_acceleration(profile, 10);
  job::set_speed(profile, 1);
  const geometry::PointCloud cloud = chip_points(40, 7);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto of = [axis](const geometry::Point& p) { return std::array{p.x, p.y, p.z}[axis]; };
    double low = 0, high = 0;
    for (const geometry::Point& p : cloud) low = std::min(low, of(p)), high = std::max(high, of(p));
    const auto a = static_cast<int>(axis);
    const double corner = std::floor(low * 1000) / 1000 - 0.02;
    job::state_setting(profile, for_axis(Id::speed_jump_x, a), 1000, "test");
    job::state_setting(profile, for_axis(Id::min_corner_x, a), corner, "test");
    job::state_setting(profile, for_axis(Id::travel_x, a),
                       std::ceil((high - corner) * 1000) / 1000 + 0.02, "test");
  }
  expect_short_slices(profile, JoinMode::path, cloud, 10);
}

}  // namespace
}  // namespace lamplock::test
