// What the machine tells by itself: a host that only listens knows at every moment how it stands,
// and hears no more often than something has changed.
#include <functional>

#include "host/link/connection.hpp"
#include "tests/board/hand_board.hpp"

namespace lamplock::test {
namespace {

/// A host that asks once, and listens from then on.
class Listener : private link::Transport {
 public:
  using Write = std::function<void(std::span<const std::uint8_t>)>;
  using Read = std::function<std::size_t(std::span<std::uint8_t>)>;

  Listener(Write write, Read read) : write_(std::move(write)), read_(std::move(read)) {
    host_.send_query(0, 1);
    host_.flush();
  }
  /// Statuses that have come since the last time.
  int hear() {
    int heard = 0;
    while (const auto message = host_.receive()) {
      if (!std::holds_alternative<wire::Status>(*message)) continue;
      told = std::get<wire::Status>(*message);
      ++heard;
    }
    return heard;
  }
  wire::Status told;  ///< last

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

/// A status that has to come by itself after one that said `told` (docs/wire-format.md).
bool is_due(const wire::Status& now, const wire::Status& told) {
  return now.state != told.state || now.hold_reason != told.hold_reason ||
         now.alarm != told.alarm || now.lamp_locked != told.lamp_locked ||
         now.free_points >= told.free_points + 128;
}

/// What a user does with the machine, at random.
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
  /// The machine can run again.
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

TEST(ToldState, EveryChangeIsToldInThePassThatSeesItAndNothingElse) {
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
      const wire::Status before = host.told;
      board.pass([&] { user.act(); });
      const int heard = host.hear();
      const wire::Status now = board.status();
      ASSERT_EQ(heard, is_due(now, before) ? 1 : 0) << "pass " << i;
      ASSERT_FALSE(is_due(now, host.told));
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

TEST(ToldState, ALampThatIsFoundIsTold) {
  Rig rig(lamp_profile());
  Listener host([&](auto bytes) { rig.board.write(bytes); },
                [&](auto bytes) { return rig.board.read(bytes); });
  rig.run(10 * ps_per_ms);
  ASSERT_GE(host.hear(), 1);
  EXPECT_FALSE(host.told.lamp_locked);
  rig.run(ps_per_s);
  EXPECT_EQ(host.hear(), 1);
  EXPECT_TRUE(host.told.lamp_locked);
}

}  // namespace
}  // namespace lamplock::test
