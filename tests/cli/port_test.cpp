// Jobs over real ports: pseudo-terminals and TCP, to `lamplock sim` or to faulty peers.
#include <gmock/gmock.h>

#include <array>
#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "shared/wire/messages.hpp"
#include "sim/endpoint/pty_endpoint.hpp"
#include "sim/endpoint/tcp_endpoint.hpp"
#include "tests/cli/inputs.hpp"
#include "tests/cli/program.hpp"
#include "tests/cli/shots.hpp"

namespace lamplock::cli::test {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

/// Answers every QUERY with a STATUS of a future protocol version.
class FutureMachine {
 public:
  explicit FutureMachine(sim::ByteEndpoint& port) : port_(port), thread_([this] { serve(); }) {}
  ~FutureMachine() { end_ = true; }

  // Events of the parser.
  void on_realtime(std::uint8_t) {}
  void on_bad_frame() {}
  void on_line(std::string_view) {}
  void on_lost_line() {}
  void on_frame(std::span<const std::uint8_t> content) {
    wire::ByteReader in(content);
    const wire::FrameHeader asked = wire::read_header(in);
    if (asked.type != wire::FrameType::query) return;
    std::array<std::uint8_t, 64> answer{};
    wire::ByteWriter out(answer);
    wire::write_header(out, {wire::FrameType::status, asked.session, ++number_});
    out.put(static_cast<std::uint16_t>(wire::protocol_version + 1));
    out.put(std::uint32_t{0x12345678});  // an unknown layout
    std::array<std::uint8_t, wire::max_frame> frame{};
    const std::size_t size = wire::encode_frame(out.written(), frame);
    port_.write(std::span(frame).first(size));
  }

 private:
  void serve() {
    wire::StreamParser<wire::End::device> parser;
    std::array<std::uint8_t, 256> bytes{};
    while (!end_) {
      const std::size_t count = port_.read(bytes);
      for (std::size_t i = 0; i < count; ++i) parser.push(bytes[i], *this);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  sim::ByteEndpoint& port_;
  std::uint32_t number_ = 0;
  std::atomic<bool> end_{false};
  std::jthread thread_;
};

void expect_no_device(const std::string& port, const std::string& what) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(5, 1)));
  const Finished failed = run({"engrave", list, "--board", port, "--yes"});
  EXPECT_EQ(failed.status, 3);
  EXPECT_THAT(failed.err, MatchesRegex("error: [^\n]+: [^\n]+; [^\n]+\n"));
  EXPECT_THAT(failed.err, HasSubstr(what));
}

TEST(Port, that_does_not_exist) {
  const Folder folder;
  expect_no_device(folder / "none", "there is no such port");
}

TEST(Port, that_has_no_listener) {
  std::string address;
  { address = sim::TcpEndpoint("127.0.0.1:0").address(); }
  expect_no_device(address, "no connection");
}

TEST(Port, that_does_not_answer) {
  const sim::PtyEndpoint silent;
  expect_no_device(silent.address(), "does not answer");
}

TEST(Port, with_firmware_of_another_version) {
  sim::TcpEndpoint tcp("127.0.0.1:0");
  const FutureMachine future(tcp);
  const std::string version = std::string("version ") + std::to_string(wire::protocol_version + 1);
  expect_no_device(tcp.address(), version);
  sim::PtyEndpoint pty;
  const FutureMachine other(pty);
  expect_no_device(pty.address(), version);
}

TEST(Port, fires_nothing_without_permission) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(5, 1)));
  Running sim({"sim", "--pty", folder / "port", "--json"});
  ASSERT_TRUE(sim.wait_for("listening"));
  const Finished refused = run({"engrave", list, "--board", folder / "port"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--yes"));
  EXPECT_EQ(run({"engrave", list, "--board", folder / "port", "--dry"}).status, 0);
  EXPECT_EQ(run({"frame", list, "--speed", "1", "--board", folder / "port"}).status, 0);
  sim.interrupt();
  const Finished ended = sim.finish();
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(nlohmann::json::parse(ended.out)["shots"], 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "port"));
}

/// The address that a simulation with --tcp prints.
std::string tcp_address(const Running& sim) {
  const std::string text = sim.out(), intro = "listening on ";
  const auto at = text.rfind(intro + "127");
  return text.substr(at + intro.size(), text.find('\n', at) - at - intro.size());
}

TEST(Port, a_simulation_is_engraved_like_hardware) {
  const Folder folder;
  const auto points = walk(100, 4, 0.05);
  const std::string list = folder.write("p.xyz", xyz(points));
  Running sim({"sim", "--tcp", "127.0.0.1:0", "--lamp", "200", "--shots", folder / "shots.csv",
               "--vcd", folder / "sim.vcd"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  const Finished done = run({"engrave", list, "--lamp", "200", "--board", tcp_address(sim), "--yes",
                             "--json", "--report", folder / "report"});
  EXPECT_EQ(done.status, 0) << done.err;
  sim.interrupt();
  EXPECT_EQ(sim.finish().status, 0);
  EXPECT_EQ(read_shots(folder / "shots.csv").size(), points.size());
  EXPECT_THAT(read(folder / "sim.vcd"), HasSubstr("lamp_sync"));
  const auto report = nlohmann::json::parse(done.out);
  EXPECT_EQ(report["shots"], points.size());
  EXPECT_TRUE(report["missed"].is_null());
  EXPECT_TRUE(report["largest_error_steps"].is_null());
  EXPECT_EQ(Folder::files(folder.path() / "report"),
            (std::vector<std::string>{"cloud.png", "job.toml", "report.html", "report.json"}));
}

TEST(Port, another_job_speed_from_the_keyboard) {
  const Folder folder;
  const auto points = walk(600, 4, 0.05);
  const std::string list = folder.write("p.xyz", xyz(points));
  Running sim({"sim", "--tcp", "127.0.0.1:0", "--lamp", "200", "--shots", folder / "shots.csv"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  InTerminal engrave({"engrave", list, "--lamp", "200", "--board", tcp_address(sim), "--yes",
                      "--job-speed", "90"});
  ASSERT_TRUE(engrave.wait_for("engraving"));
  engrave.type("70\n");
  ASSERT_TRUE(engrave.wait_for("job speed 70 %"));
  engrave.type("+\n-\n-\n");
  ASSERT_TRUE(engrave.wait_for("job speed 80 %"));
  ASSERT_TRUE(engrave.wait_for("job speed 70 %"));
  ASSERT_TRUE(engrave.wait_for("job speed 60 %"));
  engrave.type("slower\n");
  ASSERT_TRUE(engrave.wait_for("a job speed in percent, + or -"));
  engrave.type("\x03");
  ASSERT_TRUE(engrave.wait_for("Enter to resume"));
  engrave.type("1000 %\n");
  ASSERT_TRUE(engrave.wait_for("job speed 140 %"));
  engrave.type("\n");
  ASSERT_TRUE(engrave.wait_for("resuming"));
  EXPECT_EQ(engrave.finish().status, 0);
  sim.interrupt();
  EXPECT_EQ(sim.finish().status, 0);
  EXPECT_EQ(read_shots(folder / "shots.csv").size(), points.size());
}

TEST(Port, held_by_its_user_during_a_hold_of_a_second) {
  const Folder folder;
  const std::string list = folder.write("p.xyz", xyz(walk(600, 4, 0.05)));
  Running sim({"sim", "--tcp", "127.0.0.1:0", "--lamp", "200"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  InTerminal engrave(
      {"engrave", list, "--lamp", "200", "--board", tcp_address(sim), "--yes", "--hold-at", "20"});
  ASSERT_TRUE(engrave.wait_for("holding for a second"));
  engrave.type("\x03");
  ASSERT_TRUE(engrave.wait_for("Enter to resume"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1800));
  engrave.type("\x03");
  const Finished stopped = engrave.finish();
  EXPECT_EQ(stopped.status, 130);
  const std::string intro = "Stopped at ";
  const auto at = stopped.out.find(intro);
  ASSERT_NE(at, std::string::npos) << stopped.out;
  EXPECT_LT(std::stoi(stopped.out.substr(at + intro.size())), 100) << "it resumed by itself";
  sim.interrupt();
  EXPECT_EQ(sim.finish().status, 0);
}

/// Without a terminal the job cannot be resumed: the first interrupt stops it.
TEST(Port, interrupted_and_continued) {
  const Folder folder;
  const auto points = walk(400, 4, 0.05);
  const std::string list = folder.write("p.xyz", xyz(points));
  Running sim({"sim", "--tcp", "127.0.0.1:0", "--lamp", "200", "--shots", folder / "shots.csv"});
  ASSERT_TRUE(sim.wait_for("Ctrl-C"));
  const std::vector<std::string> engrave{"engrave",        list,   "--lamp", "200", "--board",
                                         tcp_address(sim), "--yes"};
  Running first(engrave);
  ASSERT_TRUE(first.wait_for("engraving: "));
  first.interrupt();
  const Finished stopped = first.finish();
  EXPECT_EQ(stopped.status, 130);
  const auto at = stopped.err.find("--from ");
  ASSERT_NE(at, std::string::npos) << stopped.err;
  const std::string next = stopped.err.substr(at + 7, stopped.err.find('\n', at) - at - 7);
  EXPECT_GT(std::stoi(next), 0);
  EXPECT_LT(std::stoi(next), 400);
  std::vector<std::string> rest = engrave;
  rest.insert(rest.end(), {"--from", next});
  EXPECT_EQ(run(rest).status, 0);
  sim.interrupt();
  EXPECT_EQ(sim.finish().status, 0);
  const auto shots = read_shots(folder / "shots.csv");
  ASSERT_EQ(shots.size(), points.size());
  for (std::size_t i = 0; i < shots.size(); ++i) EXPECT_NEAR(shots[i].x, points[i].x, 0.0026) << i;
}

TEST(Simulation, impossible_ports) {
  const Folder folder;
  folder.write("file", "precious");
  const Finished pty = run({"sim", "--pty", folder / "file", "--seconds", "0.1"});
  EXPECT_EQ(pty.status, 3);
  EXPECT_EQ(read(folder / "file"), "precious");
  EXPECT_EQ(run({"sim", "--tcp", "nonsense", "--seconds", "0.1"}).status, 2);
}

TEST(Simulation, ends_by_itself_after_seconds) {
  const auto start = std::chrono::steady_clock::now();
  const Finished ended = run({"sim", "--seconds", "0.5", "--json"});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  EXPECT_EQ(ended.status, 0);
  EXPECT_GE(taken.count(), 0.5);
  EXPECT_NEAR(nlohmann::json::parse(ended.out)["flashes"], 50, 2);
}

}  // namespace
}  // namespace lamplock::cli::test
