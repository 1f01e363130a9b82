// The pin map "cut": a fourth axis, a limit switch for each axis, a second link by UART.
#include <deque>

#include "tests/chip_board/chip_rig.hpp"

namespace lamplock::test {
namespace {

job::Profile cut_profile(int axes) {
  job::Profile profile = chip_profile();
  profile.settings.set_milli(Id::pin_map, 1000);
  profile.settings.set_milli(Id::axes, axes * 1000);
  return profile;
}

/// A PC at the other end of the UART.
class SerialCable final : public link::Transport, private sim::chip::ByteLine {
 public:
  explicit SerialCable(ChipRig& rig) : rig_(rig), uart_(rig.board.chip().system().uart0) {
    uart_.connect(*this);
  }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    for (const std::uint8_t byte : bytes) uart_.send_to_chip(byte);
    return bytes.size();
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    const std::size_t n = std::min(bytes.size(), heard_.size());
    std::copy_n(heard_.begin(), n, bytes.begin());
    heard_.erase(heard_.begin(), heard_.begin() + static_cast<std::ptrdiff_t>(n));
    return n;
  }
  void wait(std::chrono::microseconds time) override {
    const Picoseconds until = rig_.now() + time.count() * ps_per_us;
    while (rig_.now() < until && heard_.empty()) rig_.run(100 * ps_per_us);
  }
  std::chrono::microseconds now() const override {
    return std::chrono::microseconds(rig_.now() / ps_per_us);
  }
  bool connected() const override { return true; }
  bool reconnect() override { return true; }

  void type(std::string_view text) {
    write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  }
  /// Text received since the last call.
  std::string heard() {
    std::string text(heard_.begin(), heard_.end());
    heard_.clear();
    return text;
  }

 private:
  void byte_sent(std::uint8_t byte, sim::chip::Cycle /*at*/) override { heard_.push_back(byte); }

  ChipRig& rig_;
  sim::chip::Uart& uart_;
  std::deque<std::uint8_t> heard_;
};

TEST(CutMap, FourAxesAreRefusedWhereThreeHavePins) {
  job::Profile profile = cut_profile(4);
  profile.settings.set_milli(Id::pin_map, 0);
  ChipRig rig(profile);
  RunningJob running(rig, job::make_job(chip_points(5, 3), profile, {}), 1);
  try {
    running.sender.run();
    ADD_FAILURE() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("$960"));
  }
  EXPECT_TRUE(rig.monitor.nothing_happened());
}

TEST(CutMap, AJobForTheOtherMapIsRefused) {
  job::Profile profile = cut_profile(3);
  ChipRig rig(chip_profile());
  RunningJob running(rig, job::make_job(chip_points(5, 3), profile, {}), 1);
  EXPECT_ANY_THROW(running.sender.run());
  EXPECT_TRUE(rig.monitor.nothing_happened());
}

TEST(CutMap, EachAxisHasItsLimitSwitch) {
  for (const sim::Pin pin : {sim::Pin::limit_x, sim::Pin::limit_y, sim::Pin::limit_z}) {
    SCOPED_TRACE(static_cast<int>(pin));
    const job::Profile profile = cut_profile(3);
    ChipRig rig(profile);
    EXPECT_THAT(rig.status(), HasSubstr("<Idle"));
    rig.board.world().schedule(pin, true, rig.now() + ps_per_ms);
    rig.run(5 * ps_per_ms);
    EXPECT_THAT(rig.status(), HasSubstr("<Alarm"));
  }
}

TEST(CutMap, AJobByUart) {
  const job::Profile profile = cut_profile(3);
  const job::Job job = job::make_job(chip_points(40, 5), profile, {});
  ChipRig rig(profile);
  SerialCable cable(rig);
  link::JobSender sender(cable, job, RunningJob::options(1, 0));
  EXPECT_EQ(sender.run().end, JobEnd::done);
  expect_fired(rig, job);
  EXPECT_EQ(rig.monitor.violation(profile.settings), "");
}

TEST(CutMap, EachLinkIsAnsweredExceptTheOtherLinkDuringAJob) {
  const job::Profile profile = cut_profile(3);
  ChipRig rig(profile);
  SerialCable cable(rig);
  EXPECT_THAT(rig.answer("$I"), HasSubstr("[VER:"));
  EXPECT_EQ(cable.heard(), "");
  rig.heard.clear();
  cable.type("$I\n");
  rig.run(20 * ps_per_ms);
  rig.listen();
  EXPECT_THAT(cable.heard(), HasSubstr("[VER:"));
  EXPECT_EQ(rig.heard, "");
  RunningJob running(rig, job::make_job(chip_points(60, 5), profile, {}), 1);
  ASSERT_TRUE(running.run_until_fired(5));
  cable.type("$X\n?\x18");
  EXPECT_EQ(running.finish(), JobEnd::done);
  EXPECT_EQ(cable.heard(), "");
}

TEST(CutMap, NoiseOnTheOtherLinkDoesNotReachAJobInAHoldOrAtADoor) {
  const job::Profile profile = cut_profile(3);
  ChipRig rig(profile);
  SerialCable cable(rig);
  RunningJob running(rig, job::make_job(chip_points(60, 5), profile, {}), 1);
  ASSERT_TRUE(running.run_until_fired(5));
  const auto expect_state = [&](MachineState state) {
    const Picoseconds end = rig.now() + 200 * ps_per_ms;
    while (rig.now() < end) {
      cable.type("~?$I\n");
      ASSERT_TRUE(running.sender.step());
    }
    EXPECT_EQ(running.sender.status().state, state);
    EXPECT_EQ(cable.heard(), "");
  };
  running.sender.pause();
  ASSERT_NO_FATAL_FAILURE(expect_state(MachineState::hold));
  rig.board.world().schedule(sim::Pin::door, true, rig.now() + ps_per_ms);
  ASSERT_NO_FATAL_FAILURE(expect_state(MachineState::door));
  rig.board.world().schedule(sim::Pin::door, false, rig.now() + ps_per_ms);
  ASSERT_NO_FATAL_FAILURE(expect_state(MachineState::hold));
  running.sender.resume();
  EXPECT_EQ(running.finish(), JobEnd::done);
  expect_fired(rig, running.job);
  EXPECT_EQ(rig.monitor.violation(profile.settings), "");
}

TEST(CutMap, AnIncompleteLineIsNotCompletedByTheOtherLink) {
  const job::Profile profile = cut_profile(3);
  ChipRig rig(profile);
  SerialCable cable(rig);
  rig.type("$110=6");
  rig.run(10 * ps_per_ms);
  cable.type("0\n");
  rig.run(20 * ps_per_ms);
  EXPECT_THAT(cable.heard(), HasSubstr("error:1\r"));
  EXPECT_EQ(rig.board.stored_settings(), profile.settings);
}

}  // namespace
}  // namespace lamplock::test
