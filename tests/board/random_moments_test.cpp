// A G-code job with a laser and, at a random moment, a hold, a door, a reset, a limit switch or the
// e-stop: how the machine stops, when the light ends, whether the position is known, the state of
// the outputs, and whether the rest of the job runs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <random>

#include "shared/boards/all_boards.hpp"
#include "tests/board/program_host.hpp"
#include "tests/judges/motion_judge.hpp"

namespace lamplock::test::random_moments_test {
namespace {

using testing::Each;

constexpr std::uint8_t reset_byte = 0x18;
/// From a command to the begin of braking: a batch and the ticks handed out ahead
/// (firmware/machine/runners/program_runner.hpp).
constexpr double reaction_ms = 40;

enum class What { hold, door, reset, limit, estop };

/// A program's end position and the outputs that it leaves switched on.
struct ProgramEnd {
  StepPosition place{};
  bool aux = false, air = false;
};

/// Lines and arcs at some 20 to 100 mm/s, light on most of them, outputs switched on the way.
std::string random_program(std::mt19937_64& random, ProgramEnd& end) {
  const auto pick = [&random](int from, int to) {
    return std::uniform_int_distribution<>(from, to)(random);
  };
  std::string text = fmt::format("G21 G90 M{} S1000\n", pick(3, 4));
  for (int i = 0; i < 8; ++i) {
    const int x = pick(-30, 30), y = pick(-30, 30);
    if (pick(0, 2) == 0) {
      end.aux = pick(0, 1) != 0;
      text += fmt::format("M6{} P0\n", end.aux ? 2 : 3);
    } else if (pick(0, 4) == 0) {
      end.air = pick(0, 2) != 0;
      text += end.air ? "M8\n" : "M9\n";
    }
    if (pick(0, 5) == 0)
      text += fmt::format("G0 X{} Y{}\n", x, y);
    else if (pick(0, 4) == 0)
      text += fmt::format("G91 G2 X{0} Y{0} R{1} F{2}\nG90\n", pick(1, 3), 4, pick(12, 60) * 100);
    else
      text += fmt::format("G1 X{} Y{} F{}\n", x, y, pick(12, 60) * 100);
  }
  const int x = pick(0, 1) * 80 - 40, y = pick(-30, 30);  // far from the place before
  end.place = {x * 200, y * 200, 0, 0};
  return text + fmt::format("G1 X{} Y{}\n", x, y);
}

class Moment {
 public:
  Moment(std::uint64_t seed, What what) : random_(seed), what_(what) {
    profile_.settings.set_milli(Id::laser_mode, 1000);
    profile_.settings.set_milli(Id::pin_map, static_cast<int>(boards::PinMap::cut_io) * 1000);
    rig_ = std::make_unique<Rig>(profile_);
    judge_ = std::make_unique<MotionJudge>(rig_->board, profile_.settings, true);
    host_ = std::make_unique<ProgramHost>(*rig_, ProgramHost::Banner::kept);
    host_->run_ms(5);
    program_ = random_program(random_, end_);
    lines_ = static_cast<std::size_t>(std::count(program_.begin(), program_.end(), '\n'));
  }

  void run() {
    host_->send(program_);
    host_->run_ms(std::uniform_real_distribution<>(0, 3000)(random_));
    ran_ = rig_->state() == MachineState::run;
    ASSERT_EQ(judge_->fault(), "");
    make();
    if (what_ == What::limit || what_ == What::estop) return stops_dead();
    if (what_ == What::reset) return comes_to_rest_and_forgets();
    comes_to_rest_and_resumes();
  }

 private:
  sim::Picoseconds now() const { return rig_->board.now(); }
  void set(sim::Pin pin, bool level) { rig_->board.world().schedule(pin, level, now()); }
  void make() {
    at_ = now();
    if (what_ == What::hold) host_->send("!");
    if (what_ == What::reset) host_->send(reset_byte);
    if (what_ == What::door) set(sim::Pin::door, true);
    if (what_ == What::limit) set(sim::Pin::limit_y, true);
    if (what_ == What::estop) set(sim::Pin::estop, true);
    host_->run_ms(0.5);
  }
  StepPosition loads() const { return rig_->board.world().drives().position(); }
  bool dark_since(double ms) const {
    return !rig_->board.world().beam().shone(at_ + static_cast<sim::Picoseconds>(ms * 1e9), now());
  }
  bool is_high(sim::Pin pin) const { return rig_->board.bus().level(pin); }
  /// All outputs are off from 0.5 ms after the event on.
  void expect_all_off() const {
    EXPECT_FALSE(is_high(sim::Pin::aux_out));
    EXPECT_FALSE(is_high(sim::Pin::air));
  }
  /// The machine comes to rest within the braking time, stays there and knows its position.
  void expect_rest() {
    // At most 1 m/s, braking at 2 m/s2.
    host_->run_ms(reaction_ms + 500);
    const StepPosition stood = loads();
    host_->run_ms(50);
    EXPECT_EQ(loads(), stood);
    EXPECT_EQ(host_->position(), stood);
    EXPECT_EQ(judge_->fault(), "");
  }

  void stops_dead() {
    EXPECT_TRUE(dark_since(0.001));
    expect_all_off();
    const StepPosition stood = loads();
    host_->run_ms(100);
    expect_all_off();
    EXPECT_TRUE(dark_since(0.001));
    EXPECT_EQ(loads(), stood);
    EXPECT_EQ(host_->position(), stood);
    EXPECT_TRUE(host_->has_said(what_ == What::limit ? "ALARM:1" : "ALARM:10"));
    EXPECT_EQ(rig_->board.bus().level(sim::Pin::enable), what_ == What::limit);
    EXPECT_EQ(host_->answers().size(), lines_);
  }
  /// As in grbl, it reports a lost position if it breaks off a motion. The end of a motion that is
  /// in the ticks already, 3 ms ahead at most, is not broken off.
  void comes_to_rest_and_forgets() {
    EXPECT_TRUE(dark_since(0.3));
    expect_all_off();
    host_->run_ms(3);
    const StepPosition end_of_ticks = loads();
    expect_rest();
    expect_all_off();
    EXPECT_TRUE(dark_since(0.3));
    const bool lost = host_->has_said("ALARM:3");
    EXPECT_TRUE(lost || loads() == end_of_ticks);
    EXPECT_EQ(rig_->state(), lost ? MachineState::alarm : MachineState::idle);
  }
  void comes_to_rest_and_resumes() {
    const bool door = what_ == What::door;
    if (door) {
      EXPECT_TRUE(dark_since(0.001));
    }
    expect_rest();
    // Feeder and extraction stay on; air is off while the door is open.
    const bool aux = is_high(sim::Pin::aux_out);
    host_->run_ms(100);
    EXPECT_EQ(is_high(sim::Pin::aux_out), aux);
    if (door && ran_) {
      EXPECT_FALSE(is_high(sim::Pin::air));
    }
    EXPECT_TRUE(dark_since(door ? 0.001 : reaction_ms + 500));
    if (ran_) {
      EXPECT_EQ(rig_->state(), door ? MachineState::door : MachineState::hold);
    }
    if (door) {
      set(sim::Pin::door, false);
      host_->run_ms(1);
    }
    host_->send("~");
    ASSERT_TRUE(host_->wait_for(lines_, 30));
    ASSERT_TRUE(host_->wait_for_rest(30));
    EXPECT_THAT(host_->answers(), Each("ok"));
    EXPECT_EQ(loads(), end_.place);
    EXPECT_EQ(is_high(sim::Pin::aux_out), end_.aux);
    EXPECT_EQ(is_high(sim::Pin::air), end_.air);
    EXPECT_EQ(judge_->fault(), "");
  }

  std::mt19937_64 random_;
  What what_;
  job::Profile profile_ = lamp_profile(100, settings::LampMode::free_beat);
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<MotionJudge> judge_;
  std::unique_ptr<ProgramHost> host_;
  std::string program_;
  std::size_t lines_ = 0;
  ProgramEnd end_;
  bool ran_ = false;  ///< when the event occurred
  sim::Picoseconds at_ = 0;
};

class RandomMoments : public testing::TestWithParam<What> {};

TEST_P(RandomMoments, StopAsTheyShould) {
  const int moments = scaled(200);
  for (int i = 0; i < moments; ++i) {
    SCOPED_TRACE(fmt::format("moment {}", i));
    Moment(static_cast<std::uint64_t>(i) * 5 + static_cast<std::uint64_t>(GetParam()), GetParam())
        .run();
    if (testing::Test::HasFailure()) return;
  }
}

INSTANTIATE_TEST_SUITE_P(OfAJob, RandomMoments,
                         testing::Values(What::hold, What::door, What::reset, What::limit,
                                         What::estop));

}  // namespace
}  // namespace lamplock::test::random_moments_test
