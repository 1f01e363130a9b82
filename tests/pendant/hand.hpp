// An operator at a simulated machine: jogger, link and virtual board, round by round.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "host/link/simulated_transport.hpp"
#include "host/pendant/jogger.hpp"
#include "tests/board/rig.hpp"

namespace lamplock::pendant {

inline constexpr double steps_per_mm = 200, accel_mm_s2 = 2000;

/// A cable that records what is written, accepts as few bytes as configured, loses some, and can be
/// cut in one direction.
class ListenedCable final : public link::Transport {
 public:
  explicit ListenedCable(sim::Board& board) : inner_(board) {}

  std::size_t write(std::span<const std::uint8_t> bytes) override {
    const std::size_t room = std::min(bytes.size(), max_written());
    for (const std::uint8_t byte : bytes.first(room)) {
      keep(byte);
      if (!cut && !loses(byte)) inner_.write(std::span(&byte, 1));
    }
    return room;
  }
  std::size_t read(std::span<std::uint8_t> bytes) override {
    const std::size_t count = inner_.read(bytes);
    return cut || mute ? 0 : count;
  }
  void wait(std::chrono::microseconds time) override { inner_.wait(time); }
  std::chrono::microseconds now() const override { return inner_.now(); }
  bool reconnect() override { return true; }

  std::function<std::size_t()> max_written = [] { return std::size_t{4096}; };
  std::function<bool(std::uint8_t)> loses = [](std::uint8_t) { return false; };
  bool cut = false, mute = false;
  std::vector<std::string> lines;      ///< complete lines written
  std::vector<std::uint8_t> realtime;  ///< without `?`

 private:
  void keep(std::uint8_t byte) {
    if (byte == '?') return;
    if (byte >= 0x80 || byte == '!' || byte == '~' || byte == 0x18) return realtime.push_back(byte);
    if (byte != '\n') {
      line_ += static_cast<char>(byte);
      return;
    }
    lines.push_back(line_);
    line_.clear();
  }
  link::SimulatedTransport inner_;
  std::string line_;
};

/// The machine has three axes, 200 steps/mm, 1 m/s, 2 m/s2, travel of 100 mm round the origin.
class Hand {
 public:
  explicit Hand(KeyMap map = default_key_map(), const job::Profile& profile = plain_profile())
      : Hand(std::move(map), profile, jog_limits(profile.settings)) {}
  /// The jogger uses limits of another machine.
  Hand(KeyMap map, const job::Profile& profile, const JogLimits& limits)
      : rig(profile), cable(rig.board), jogger(port, limits, std::move(map)) {
    run_ms(150);  // the first report
    cable.lines.clear();
    jogger.take_notes();
  }
  static job::Profile plain_profile() {
    job::Profile profile = test::lamp_profile(100, settings::LampMode::free_beat);
    job::state_setting(profile, settings::Id::laser_mode, 1, "test");
    return profile;
  }

  /// Lets time pass; the loop runs every 2 ms.
  void run_ms(double ms) {
    const auto until = cable.now() + Time(static_cast<Time::rep>(ms * 1000));
    while (cable.now() < until) {
      jogger.poll();
      cable.wait(std::min<Time>(Time(2000), until - cable.now()));
    }
  }
  /// The same without a host.
  void run_alone_ms(double ms) { rig.run(static_cast<sim::Picoseconds>(ms * 1e9)); }
  /// Runs until nothing moves; false if that takes more than 5 s.
  bool come_to_rest() {
    for (int i = 0; i < 500; ++i) {
      run_ms(10);
      if (jogger.rests() && jogger.machine().status.is("Idle")) return true;
    }
    return false;
  }
  double at(int axis) const {
    return rig.board.world().drives().position()[index(axis)] / steps_per_mm;
  }
  double x() const { return at(0); }
  void select(Selector selector) { jogger.take(selector_event(selector)); }
  void turn(int clicks) { jogger.take(count_event(Event::Kind::wheel, clicks)); }
  void key(Key key) { jogger.take(key_event(Event::Kind::key_down, key)); }
  /// Turns the wheel for `ms`, `clicks` every 30 ms.
  void keep_turning(int clicks, double ms) {
    constexpr double interval_ms = 30;
    while (ms > 0) {
      turn(clicks);
      run_ms(std::min(interval_ms, ms));
      ms -= interval_ms;
    }
  }
  /// Reported positions equal those of the drives, and there was no light.
  void expect_sound() {
    const std::vector<double> reported = jogger.machine().place(false);
    for (int a = 0; a < 3; ++a)
      EXPECT_NEAR(reported.at(index(a)), at(a), 0.5 / steps_per_mm + 0.0006) << "axis " << a;
    EXPECT_EQ(rig.board.world().drives().total_faults(), 0u);
    expect_dark();
  }
  void expect_dark() const {
    EXPECT_TRUE(rig.shots().empty());
    EXPECT_EQ(rig.board.world().beam().openings(), 0u);
  }

  test::Rig rig;
  ListenedCable cable;
  link::LinePort port{cable};
  Jogger jogger;
};

}  // namespace lamplock::pendant
