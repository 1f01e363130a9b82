// The firmware's end of the link: sessions, order, acknowledgements, and its transmissions.
#include "firmware/link/link.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "host/job/job.hpp"
#include "host/link/connection.hpp"
#include "tests/link/fake_machine.hpp"
#include "tests/link/random_job.hpp"

namespace lamplock::link {
namespace {

using test::FakeMachine;
using wire::FrameType;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint32_t session = 0x80818283;

/// Link and machine, and a transport that connects a Connection to them without delay.
class Bench : public Transport {
 public:
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    link->receive(bytes, *machine);
    return bytes.size();
  }
  std::size_t read(std::span<std::uint8_t> bytes) override { return link->transmit(bytes); }
  void wait(std::chrono::microseconds) override {}
  std::chrono::microseconds now() const override { return {}; }
  bool reconnect() override { return true; }

  void frame(FrameType type, std::uint32_t number, const Bytes& payload,
             std::uint32_t of_session = session) {
    host.send({type, of_session, number}, payload);
    host.flush();
  }
  void begin(std::uint32_t points = 1000, std::uint32_t of_session = session) {
    wire::JobHeader header;
    header.points_total = points;
    Bytes payload(wire::max_job_header_size);
    wire::ByteWriter out(payload);
    wire::write_job_header(out, header);
    payload.resize(out.size());
    frame(FrameType::begin, 0, payload, of_session);
  }
  void text(std::string_view line) {
    write({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()});
  }
  std::vector<Message> messages() {
    std::vector<Message> all;
    while (auto message = host.receive()) all.push_back(*message);
    return all;
  }
  wire::Status last_status() {
    const auto all = messages();
    if (all.empty() || !std::holds_alternative<wire::Status>(all.back())) {
      ADD_FAILURE() << "no status";
      return {};
    }
    return std::get<wire::Status>(all.back());
  }

  std::unique_ptr<Link> link = std::make_unique<Link>();
  std::unique_ptr<FakeMachine> machine = std::make_unique<FakeMachine>();
  Connection host{*this};
};

const Bytes one_point{0x15, 1, 2, 3};

TEST(Link, QueryIsEchoedForAnyVersion) {
  Bench bench;
  bench.frame(FrameType::query, 42, {99, 0}, 0);
  const auto status = bench.last_status();
  EXPECT_EQ(status.version, wire::protocol_version);
  EXPECT_EQ(status.echo, 42u);
  EXPECT_EQ(status.session, 0u);
  EXPECT_EQ(status.free_points, motion::PointQueue::capacity);
}

TEST(Link, BeginOfTheSameSessionIsAcknowledgedNotRestarted) {
  Bench bench;
  bench.begin();
  bench.frame(FrameType::data, 1, one_point);
  bench.begin();
  const auto status = bench.last_status();
  EXPECT_EQ(bench.machine->begins, 1);
  EXPECT_EQ(status.session, session);
  EXPECT_EQ(status.next_number, 2u);
  EXPECT_EQ(status.received, 1u);
}

TEST(Link, OnlyTheNextFrameIsAccepted) {
  Bench bench;
  bench.begin();
  bench.frame(FrameType::data, 2, one_point);
  EXPECT_EQ(bench.last_status().next_number, 1u);
  bench.frame(FrameType::data, 1, one_point);
  bench.frame(FrameType::data, 1, one_point);
  bench.frame(FrameType::data, 2, one_point, session + 1);
  const auto status = bench.last_status();
  EXPECT_EQ(status.next_number, 2u);
  EXPECT_EQ(status.received, 1u);
  EXPECT_EQ(status.link.duplicates, 1u);
  EXPECT_EQ(status.link.out_of_order, 2u);
}

TEST(Link, ANewConnectionDiscardsOnlyIncompleteInput) {
  Bench bench;
  bench.begin();
  bench.frame(FrameType::data, 1, one_point);
  bench.text("$110=6");
  bench.link->new_connection();
  bench.text("0\n");
  bench.text("\x02half a frame");
  bench.link->new_connection();
  bench.text("$$\n");
  EXPECT_EQ(bench.machine->lines, std::vector<std::string>({"0", "$$"}));
  EXPECT_EQ(bench.machine->lost_lines, 0);
  bench.frame(FrameType::data, 2, one_point);
  const auto status = bench.last_status();
  EXPECT_EQ(status.session, session);
  EXPECT_EQ(status.next_number, 3u);
  // A text host receives no STATUS, although the preceding host used frames.
  bench.link->new_connection();
  bench.machine->state = wire::MachineState::hold;
  bench.link->poll(*bench.machine);
  EXPECT_TRUE(bench.messages().empty());
}

TEST(Link, DataWithoutAJobIsIgnored) {
  Bench bench;
  bench.frame(FrameType::data, 1, one_point, 0);
  EXPECT_TRUE(bench.machine->received.empty());
  EXPECT_EQ(bench.link->counters().out_of_order, 1u);
  bench.begin();
  bench.link->forget_session();
  bench.frame(FrameType::data, 1, one_point);
  EXPECT_TRUE(bench.machine->received.empty());
  EXPECT_EQ(bench.last_status().session, 0u);
}

TEST(Link, RefusalsNameFrameResultAndValue) {
  Bench bench;
  bench.machine->begin_result = Result::bad_value;
  bench.machine->refused = 901;
  bench.begin();
  auto all = bench.messages();
  ASSERT_EQ(all.size(), 2u);
  auto refused = std::get<RefusedFrame>(all[0]);
  EXPECT_EQ(refused.refused.type, FrameType::begin);
  EXPECT_EQ(refused.refused.result, Result::bad_value);
  EXPECT_EQ(refused.refused.value, 901u);
  EXPECT_EQ(bench.link->session(), 0u);

  bench.machine->begin_result = Result::ok;
  bench.begin();
  bench.messages();
  bench.frame(FrameType::data, 1, {0x03, 0xFF, 0xFF, 0xFF, 0x7F});
  all = bench.messages();
  ASSERT_EQ(all.size(), 2u);
  refused = std::get<RefusedFrame>(all[0]);
  EXPECT_EQ(refused.number, 1u);
  EXPECT_EQ(refused.refused.result, Result::out_of_bounds);
  EXPECT_EQ(std::get<wire::Status>(all[1]).next_number, 1u);
}

TEST(Link, OtherVersionAndSessionZeroAreRefused) {
  Bench bench;
  bench.frame(FrameType::begin, 0, {wire::protocol_version + 1, 0});
  EXPECT_EQ(std::get<RefusedFrame>(bench.messages().at(0)).refused.result, Result::bad_version);
  bench.begin(10, 0);
  EXPECT_EQ(std::get<RefusedFrame>(bench.messages().at(0)).refused.result, Result::bad_value);
  EXPECT_EQ(bench.machine->begins, 0);
}

TEST(Link, CommandsActOnceAndOnlyOnTheirJob) {
  Bench bench;
  bench.frame(FrameType::command, 1, {1});
  EXPECT_EQ(std::get<RefusedFrame>(bench.messages().at(0)).refused.result, Result::no_job);
  bench.begin();
  bench.frame(FrameType::command, 1, {1});
  bench.frame(FrameType::command, 1, {1});
  bench.frame(FrameType::command, 2, {2});
  bench.frame(FrameType::command, 1, {3});
  EXPECT_EQ(bench.machine->commands,
            (std::vector<wire::CommandRequest>{{wire::Command::hold}, {wire::Command::resume}}));
  EXPECT_EQ(bench.last_status().last_command, 2u);
}

TEST(Link, CommandsHaveAValueOnlyWhereDefined) {
  Bench bench;
  bench.begin();
  bench.frame(FrameType::command, 1, {5, 70, 0, 0, 0});
  EXPECT_EQ(bench.machine->commands,
            (std::vector<wire::CommandRequest>{{wire::Command::job_speed, 70}}));
  bench.messages();
  bench.frame(FrameType::command, 2, {4, 0x40, 0x0D, 0x03, 0});
  EXPECT_EQ(bench.machine->commands.back(),
            (wire::CommandRequest{wire::Command::lamp_frequency, 200'000}));
  EXPECT_EQ(std::get<RefusedFrame>(bench.messages().at(0)).refused.result, Result::unsupported);
  const std::size_t taken = bench.machine->commands.size();
  for (const Bytes& bad : {Bytes{},
                           {0},
                           {1, 0},
                           {3, 1, 0, 0, 0},
                           {5},
                           {5, 70},
                           {5, 70, 0, 0},
                           {5, 70, 0, 0, 0, 0},
                           {6},
                           {6, 1, 0, 0, 0},
                           {255}}) {
    bench.messages();
    bench.frame(FrameType::command, 3, bad);
    EXPECT_EQ(std::get<RefusedFrame>(bench.messages().at(0)).refused.result, Result::bad_frame);
  }
  EXPECT_EQ(bench.machine->commands.size(), taken);
}

TEST(Link, FullQueueIsNotARefusal) {
  Bench bench;
  bench.begin(5000);
  const Bytes hundred(100, 0x00);  // points without a delta
  std::uint32_t number = 0;
  while (bench.machine->queue.free() >= 100) bench.frame(FrameType::data, ++number, hundred);
  bench.messages();
  bench.frame(FrameType::data, number + 1, hundred);
  const auto all = bench.messages();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(std::get<wire::Status>(all[0]).next_number, number + 1);
}

TEST(Link, StatusIsSentUnrequestedWhenSpaceHasGrownOrTheStateChanged) {
  Bench bench;
  bench.begin(5000);
  bench.frame(FrameType::data, 1, Bytes(300, 0x00));
  bench.messages();
  bench.machine->fire(wire::free_points_step - 1);
  bench.link->poll(*bench.machine);
  EXPECT_TRUE(bench.messages().empty());
  bench.machine->fire(1);
  bench.link->poll(*bench.machine);
  EXPECT_EQ(bench.last_status().first_unfired, wire::free_points_step);
  bench.link->poll(*bench.machine);
  EXPECT_TRUE(bench.messages().empty());
  bench.machine->hold(wire::HoldReason::dead_man);
  bench.link->poll(*bench.machine);
  EXPECT_EQ(bench.last_status().hold_reason, wire::HoldReason::dead_man);
}

TEST(Link, EachChangeIsReportedOnceAndNoStatusIsSentWithoutOne) {
  Bench bench;
  bench.begin();
  bench.messages();
  FakeMachine& machine = *bench.machine;
  const auto polled = [&bench] {
    for (int i = 0; i < 3; ++i) bench.link->poll(*bench.machine);
    return bench.messages().size();
  };
  const int before = machine.statuses;
  EXPECT_EQ(polled(), 0u);
  EXPECT_EQ(machine.statuses, before);
  const std::function<void()> changes[] = {
      [&] { machine.state = wire::MachineState::hold; },
      [&] { machine.reason = wire::HoldReason::reset; },
      [&] { machine.alarm = 3; },
      [&] { machine.lamp_locked = true; },
      [&] { machine.lamp_locked = false; },
  };
  for (const std::function<void()>& change : changes) {
    change();
    EXPECT_EQ(polled(), 1u);
  }
  EXPECT_EQ(machine.statuses, before + static_cast<int>(std::size(changes)));
}

TEST(Link, TextSendersNeverReceiveAFrame) {
  Bench bench;
  bench.begin();
  bench.messages();
  bench.text("$I\n");
  bench.machine->hold(wire::HoldReason::dead_man);
  bench.link->poll(*bench.machine);
  EXPECT_EQ(bench.link->transmit_size(), 0u);
  EXPECT_EQ(bench.machine->lines, std::vector<std::string>({"$I"}));
}

TEST(Link, NoFrameIsSentWithinAnUnfinishedLine) {
  Bench bench;
  bench.link->send_text("[OPT:");
  bench.frame(FrameType::query, 1, {1, 0}, 0);
  bench.link->send_text("V,15]\r\n");
  bench.link->poll(*bench.machine);
  const auto all = bench.messages();
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(std::get<std::string>(all[0]), "[OPT:V,15]");
  EXPECT_EQ(std::get<wire::Status>(all[1]).echo, 1u);
}

TEST(Link, MessagesWithoutRoomAreSentLaterAsAWhole) {
  Bench bench;
  const std::string line = std::string(98, 'x') + "\r\n";
  std::size_t lines = 0;
  while (bench.link->send_text(line)) ++lines;
  EXPECT_GE(lines * line.size(), 2048u);
  EXPECT_EQ(bench.link->counters().transmit_overflows, 1u);
  bench.frame(FrameType::query, 7, {1, 0}, 0);
  bench.frame(FrameType::query, 8, {1, 0}, 0);
  EXPECT_EQ(bench.messages().size(), lines);
  EXPECT_EQ(bench.host.bad_frames(), 0u);
  bench.link->poll(*bench.machine);
  const auto all = bench.messages();
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(std::get<wire::Status>(all[0]).echo, 8u);
}

TEST(Link, LinesAndRealtimeBytesReachTheMachine) {
  Bench bench;
  bench.text("G1 X1\r\n?\n" + std::string(300, 'y') + "\n");
  EXPECT_EQ(bench.machine->lines, (std::vector<std::string>{"G1 X1", ""}));
  EXPECT_EQ(bench.machine->realtime, Bytes{'?'});
  EXPECT_EQ(bench.machine->lost_lines, 1);
  EXPECT_EQ(bench.link->counters().lost_lines, 1u);
}

TEST(Link, UnknownFrameTypesAreRefused) {
  Bench bench;
  bench.frame(static_cast<FrameType>(0x55), 3, {});
  const auto refused = std::get<RefusedFrame>(bench.messages().at(0));
  EXPECT_EQ(refused.refused.result, Result::bad_frame);
  EXPECT_EQ(refused.number, 3u);
}

}  // namespace
}  // namespace lamplock::link
