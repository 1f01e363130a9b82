// Status messages that the machine sends by itself: a host that only listens always knows the
// machine's state, and receives a message only after a change.
#include <functional>

#include "host/link/connection.hpp"
#include "tests/board/hand_board.hpp"

namespace lamplock::test {
namespace {

/// A host that asks once and then only listens.
class Listener : private link::Transport {
 public:
  using Write = std::function<void(std::span<const std::uint8_t>)>;
  using Read = std::function<std::size_t(std::span<std::uint8_t>)>;

  Listener(Write write, Read read) : write_(std::move(write)), read_(std::move(read)) {
    host_.send_query(0, 1);
    host_.flush();
  }
  /// Number of STATUS messages since the last call.
  int hear() {
    int heard = 0;
    while (const auto message = host_.receive()) {
      if (!std::holds_alternative<wire::Status>(*message)) continue;
      last_status = std::get<wire::Status>(*message);
      ++heard;
    }
    return heard;
  }
  wire::Status last_status;  ///< last

 private:
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    write_(bytes);
    return bytes.size();
  }
  std::size_t read(std::span<std::uint8_t> bytes) override { return read_(bytes); }
  void wait(std::chrono::microseconds) override {}
  std::chrono::microseconds now() const override { return {}; }
  bool reconnect() override { return true; }

  Write write_;
  Read read_;
  link::Connection host_{*this};
};

/// The board must send `now` unasked if `sent` was its last STATUS (docs/wire-format.md).
bool is_due(const wire::Status& now, const wire::Status& sent) {
  return now.state != sent.state || now.hold_reason != sent.hold_reason ||
         now.alarm != sent.alarm || now.lamp_locked != sent.lamp_locked ||
         now.free_points >= sent.free_points + 128;
}

/// Random actions of a user.
class User {
 public:
  User(HandBoard& board, std::uint64_t seed) : core_(board.core), random_(seed) {}
  void act() {
    switch (random_() % 60) {
      case 0:
        return core_.on_realtime('!');
      case 1:
        core_.on_command({wire::Command::hold});
        return;
      case 2:
        return core_.input_changed(machine::Input::door, door_ = !door_);
      case 3:
        if (random_() % 4 == 0) core_.input_changed(machine::Input::estop, estop_ = !estop_);
        return;
      case 4:
        if (random_() % 4 == 0) core_.input_changed(machine::Input::limit_x, true);
        return;
      case 5:
        if (core_.state() == MachineState::alarm) core_.on_line("$X");
        return;
      case 6:
        if (random_() % 4 == 0) core_.on_command({wire::Command::stop});
        return;
      case 7:
        return core_.on_realtime(0x18);
      default:
        if (core_.state() == MachineState::hold) core_.on_command({wire::Command::resume});
        return;
    }
  }
  /// Returns the machine to a state in which it can run.
  void tidy() {
    if (door_) core_.input_changed(machine::Input::door, door_ = false);
    if (estop_) core_.input_changed(machine::Input::estop, estop_ = false);
    if (core_.state() == MachineState::alarm) core_.on_line("$X");
  }

 private:
  machine::Controller& core_;
  std::mt19937_64 random_;
  bool door_ = false, estop_ = false;
};

TEST(ReportedState, EveryChangeIsReportedInThePassThatDetectsIt) {
  std::array<int, 6> states{};
  int heard_in_all = 0, for_room = 0;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scaled(40)); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const job::Job job = jumping_row(300, seed);
    HandBoard board(job, seed);
    machine::Controller& core = board.core;
    User user(board, seed);
    ASSERT_NO_FATAL_FAILURE(board.begin(0));
    Listener host([&](auto bytes) { core.receive(bytes); },
                  [&](auto bytes) { return core.transmit(bytes); });
    ASSERT_EQ(host.hear(), 1);
    for (int i = 0; i < 4000; ++i) {
      const wire::Status before = host.last_status;
      board.pass([&] { user.act(); });
      const int heard = host.hear();
      const wire::Status now = board.status();
      ASSERT_EQ(heard, is_due(now, before) ? 1 : 0) << "pass " << i;
      ASSERT_FALSE(is_due(now, host.last_status));
      heard_in_all += heard;
      for_room += heard != 0 && now.state == before.state ? 1 : 0;
      ++states[static_cast<std::size_t>(now.state)];
      const bool over = now.state == MachineState::idle || now.state == MachineState::alarm ||
                        now.state == MachineState::estop;
      if (i % 400 != 399 || !over) continue;
      user.tidy();
      for (int rest = 0; rest < 2000 && !core.runner().at_rest(); ++rest) board.pass();
      const std::uint32_t next = board.status().first_unfired;
      if (next == job.targets.size()) break;
      ASSERT_NO_FATAL_FAILURE(board.begin(next));
      board.pass();
      host.hear();
    }
  }
  EXPECT_GT(heard_in_all, scaled(40) * 10);
  if (scaled(40) < 40) return;
  EXPECT_GT(for_room, 0);
  for (const int passes : states) EXPECT_GT(passes, 0);
}

TEST(ReportedState, ADetectedLampIsReported) {
  Rig rig(lamp_profile());
  Listener host([&](auto bytes) { rig.board.write(bytes); },
                [&](auto bytes) { return rig.board.read(bytes); });
  rig.run(10 * ps_per_ms);
  ASSERT_GE(host.hear(), 1);
  EXPECT_FALSE(host.last_status.lamp_locked);
  rig.run(ps_per_s);
  EXPECT_EQ(host.hear(), 1);
  EXPECT_TRUE(host.last_status.lamp_locked);
}

}  // namespace
}  // namespace lamplock::test
