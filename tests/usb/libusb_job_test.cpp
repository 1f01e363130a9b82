// Jobs on the virtual board over the real libusb: each point once, for any cut of the cable.
#include <gmock/gmock.h>

#include <cerrno>
#include <chrono>
#include <memory>
#include <random>

#include "host/error.hpp"
#include "host/job/job.hpp"
#include "host/link/sender.hpp"
#include "host/link/usb_transport.hpp"
#include "host/usb/libusb_bus.hpp"
#include "sim/virtual_board/virtual_board.hpp"
#include "sim/world/drive_settings.hpp"
#include "tests/scale.hpp"
#include "tests/usb/cabled_board.hpp"

namespace lamplock::usb {
namespace {

using lamplock::test::scaled;
using std::chrono::milliseconds;
using test::CabledBoard;
using test::EmulatedUsb;

constexpr double lamp_hz = 500;

job::Job random_job(std::size_t points, std::uint64_t seed, job::Profile& profile) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<> step(-0.05, 0.05);
  geometry::PointCloud cloud{{0, 0, 0}};
  while (cloud.size() < points) {
    const geometry::Point& p = cloud.back();
    cloud.push_back({p.x + step(random), p.y + step(random), p.z + step(random)});
  }
  profile = job::default_profile();
  job::set_lamp_hz(profile, lamp_hz);
  return job::make_job(cloud, profile, {});
}

class LibusbJobTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::can_be_emulated()) GTEST_SKIP() << "umockdev's library is not preloaded";
  }

  /// A job of `points` points, a board for it, and an emulated computer.
  void prepare(std::size_t points, std::uint64_t seed) {
    job::Profile profile;
    job_ = random_job(points, seed, profile);
    sim::WorldConfig world;
    world.lamp.frequency_hz = lamp_hz;
    world.drives = sim::drives_of(profile.settings);
    cable_.reset();
    usb_.reset();
    board_ = std::make_unique<sim::VirtualBoard>(profile.settings, world);
    usb_ = std::make_unique<EmulatedUsb>();
    cable_ = std::make_unique<CabledBoard>(*board_, *usb_);
  }
  link::UsbTransport connect() {
    const auto bus = std::make_shared<LibusbBus>();
    return {bus, link::find_board(*bus, "")};
  }
  void expect_each_point_once() {
    cable_->end();
    const sim::Shots& shots = board_->world().laser().shots();
    ASSERT_EQ(shots.size(), job_.targets.size());
    for (std::size_t i = 0; i < shots.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(shots[i].steps[axis], job_.targets[i].steps[axis], 1) << i;
  }

  std::unique_ptr<EmulatedUsb> usb_;
  std::unique_ptr<sim::VirtualBoard> board_;
  std::unique_ptr<CabledBoard> cable_;
  job::Job job_;
};

TEST_F(LibusbJobTest, AWholeJobRunsOverTheKernelsCalls) {
  prepare(400, 1);
  cable_->plug("1-2");
  link::UsbTransport transport = connect();
  link::JobSender sender(transport, job_);
  const link::JobResult result = sender.run();
  EXPECT_EQ(result.end, link::JobEnd::done);
  EXPECT_EQ(result.bad_frames, 0u);
  EXPECT_EQ(result.reconnects, 0u);
  expect_each_point_once();
}

/// Unplugged at a random moment, as the kernel reports it at once or after a while, and plugged in
/// again at another place.
TEST_F(LibusbJobTest, ContinuesWhereverItsBoardIsPluggedInAgain) {
  constexpr int kinds = 4;
  for (int round = 0; round < scaled(kinds); ++round) {
    prepare(300, 100 + static_cast<std::uint64_t>(round));
    std::mt19937_64 random(static_cast<std::uint64_t>(round));
    cable_->plug("1-2");
    link::UsbTransport transport = connect();
    link::SenderOptions options;
    options.reply_timeout = milliseconds(100);
    link::JobSender sender(transport, job_, options);
    const std::size_t pull_at = 20 + random() % 200;
    int pulls = 0;
    for (bool more = true; more; more = sender.step()) {
      if (pulls == 0 && sender.points_fired() >= pull_at) {
        if (round % 2 == 1) {
          cable_->fail(-EPROTO);
          for (int i = 0; i < 5; ++i) sender.step();
        }
        cable_->unplug(round % kinds < 2 ? -ESHUTDOWN : -ENODEV);
        ++pulls;
        for (int i = 0; i < 20; ++i) sender.step();
        EXPECT_FALSE(transport.connected());
        cable_->plug("1-" + std::to_string(3 + random() % 4));
      }
    }
    EXPECT_EQ(sender.result().end, link::JobEnd::done);
    EXPECT_EQ(pulls, 1);
    EXPECT_GE(sender.result().reconnects, 1u);
    expect_each_point_once();
  }
}

/// After a job is stopped by its user, the board does not continue.
TEST_F(LibusbJobTest, TheLastBytesOfAProgramThatEndsArrive) {
  prepare(400, 7);
  cable_->plug("1-2");
  {
    link::UsbTransport transport = connect();
    link::JobSender sender(transport, job_);
    while (sender.points_fired() < 50) ASSERT_TRUE(sender.step());
    cable_->ignore_cable(milliseconds(20));
    const std::uint8_t reset = 0x18;
    ASSERT_EQ(transport.write({&reset, 1}), 1u);
  }
  cable_->end();  // time is advanced manually
  const std::size_t shots = board_->world().laser().shots().size();
  board_->run_until(board_->now() + sim::ps_per_s);
  EXPECT_LE(board_->world().laser().shots().size(), shots + 1)
      << "the board must receive the reset";
  EXPECT_LT(shots, job_.targets.size());
}

}  // namespace
}  // namespace lamplock::usb
