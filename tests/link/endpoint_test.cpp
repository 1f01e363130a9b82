// Real ports: the sender's transports connected to the endpoints of the simulator.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "host/error.hpp"
#include "host/link/sender.hpp"
#include "host/link/serial_transport.hpp"
#include "host/link/tcp_transport.hpp"
#include "sim/endpoint/pty_endpoint.hpp"
#include "sim/endpoint/tcp_address.hpp"
#include "sim/endpoint/tcp_endpoint.hpp"
#include "tests/link/fake_machine.hpp"
#include "tests/link/random_job.hpp"
#include "tests/scale.hpp"

namespace lamplock {
namespace {

using namespace std::chrono_literals;
using link::SerialTransport;
using link::TcpTransport;
using sim::PtyEndpoint;
using sim::TcpEndpoint;
using Bytes = std::vector<std::uint8_t>;

constexpr auto patience = 5s;

Bytes all_bytes() {
  Bytes bytes(256);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

/// Moves `bytes` from one end to the other, until all have arrived or a time-out.
template <class From, class To>
Bytes carry(const Bytes& bytes, From& from, To& to) {
  Bytes got;
  std::size_t sent = 0;
  const auto until = std::chrono::steady_clock::now() + patience;
  while (got.size() < bytes.size() && std::chrono::steady_clock::now() < until) {
    sent += from.write(std::span(bytes).subspan(sent));
    std::array<std::uint8_t, 100> piece{};
    const std::size_t count = to.read(piece);
    got.insert(got.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(count));
    if (count == 0) std::this_thread::sleep_for(200us);
  }
  return got;
}

std::filesystem::path link_path(const std::string& name) {
  return std::filesystem::temp_directory_path() / (name + std::to_string(::getpid()));
}

TEST(PtyEndpoint, CarriesEveryByteBothWays) {
  PtyEndpoint endpoint;
  SerialTransport transport(endpoint.address());
  EXPECT_EQ(carry(all_bytes(), transport, endpoint), all_bytes());
  EXPECT_EQ(carry(all_bytes(), endpoint, transport), all_bytes());
}

TEST(PtyEndpoint, SurvivesReconnectingHosts) {
  const auto path = link_path("lamplock-pty-");
  {
    PtyEndpoint endpoint(path);
    EXPECT_EQ(endpoint.address(), path.string());
    for (int i = 0; i < 3; ++i) {
      SerialTransport transport(path.string());
      EXPECT_EQ(carry(all_bytes(), transport, endpoint), all_bytes());
      EXPECT_TRUE(transport.reconnect());
      EXPECT_EQ(carry(all_bytes(), endpoint, transport), all_bytes());
    }
    std::array<std::uint8_t, 10> bytes{};
    EXPECT_EQ(endpoint.read(bytes), 0u);
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(path)));
}

TEST(PtyEndpoint, KnowsWhetherAHostHasItOpen) {
  PtyEndpoint endpoint;
  EXPECT_FALSE(endpoint.host_present());
  {
    const SerialTransport transport(endpoint.address());
    EXPECT_TRUE(endpoint.host_present());
    ::close(::open(endpoint.address().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
    EXPECT_TRUE(endpoint.host_present());
  }
  EXPECT_FALSE(endpoint.host_present());
  const SerialTransport again(endpoint.address());
  EXPECT_TRUE(endpoint.host_present());
}

/// Programs open and close it in any order, some of them between two looks of the simulator.
TEST(PtyEndpoint, KnowsWhetherAnyOfManyHostsHasItOpen) {
  PtyEndpoint endpoint;
  std::mt19937 random(5);
  std::vector<int> hosts;
  const auto below = [&](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  for (int i = 0; i < test::scaled(2000); ++i) {
    constexpr std::size_t max_hosts = 3;
    if (below(max_hosts) >= hosts.size()) {
      hosts.push_back(::open(endpoint.address().c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK));
      ASSERT_GE(hosts.back(), 0);
    } else {
      const auto host = hosts.begin() + static_cast<std::ptrdiff_t>(below(hosts.size()));
      ::close(*host);
      hosts.erase(host);
    }
    if (below(2) == 0) continue;
    ASSERT_EQ(endpoint.host_present(), !hosts.empty()) << "after " << i << " changes";
  }
  for (const int host : hosts) ::close(host);
  EXPECT_FALSE(endpoint.host_present());
}

TEST(TcpEndpoint, KnowsWhetherAHostIsConnected) {
  TcpEndpoint endpoint("127.0.0.1:0");
  EXPECT_FALSE(endpoint.host_present());
  {
    TcpTransport transport(endpoint.address());
    EXPECT_TRUE(endpoint.host_present());
    const std::array<std::uint8_t, 3> bytes{'?', '!', '~'};
    EXPECT_EQ(transport.write(bytes), bytes.size());
    EXPECT_TRUE(endpoint.host_present());
  }
  // Bytes that were sent earlier can still be read.
  EXPECT_FALSE(endpoint.host_present());
  std::array<std::uint8_t, 10> bytes{};
  EXPECT_EQ(endpoint.read(bytes), 3u);
}

TEST(PtyEndpoint, ReplacesAnOldLinkButNoFile) {
  const auto path = link_path("lamplock-file-");
  std::filesystem::create_symlink("/nowhere", path);
  { PtyEndpoint endpoint(path); }
  { std::ofstream(path) << "precious"; }
  EXPECT_THROW(PtyEndpoint{path}, std::exception);
  EXPECT_TRUE(std::filesystem::is_regular_file(path));
  std::filesystem::remove(path);
}

TEST(SerialTransport, DetectsThatTheOtherEndIsGone) {
  // A link of its own, since the number of a pseudo-terminal is soon reused.
  const auto path = link_path("lamplock-gone-");
  auto endpoint = std::make_unique<PtyEndpoint>(path);
  SerialTransport transport(path.string());
  EXPECT_TRUE(transport.connected());
  endpoint.reset();
  std::array<std::uint8_t, 10> bytes{};
  EXPECT_EQ(transport.read(bytes), 0u);
  EXPECT_FALSE(transport.connected());
  EXPECT_FALSE(transport.reconnect());
  EXPECT_EQ(transport.write(bytes), 0u);
}

TEST(SerialTransport, OnePortHasOneProgram) {
  PtyEndpoint endpoint;
  std::string text;
  {
    const SerialTransport first(endpoint.address());
    // Locks belong to an open file, so a second one in this process counts as another program.
    try {
      const SerialTransport second(endpoint.address());
    } catch (const Error& error) {
      text = error.what();
    }
    EXPECT_THAT(text, testing::HasSubstr("another program uses the port"));
  }
  EXPECT_NO_THROW(SerialTransport(endpoint.address()));
}

TEST(SerialTransport, HasTheSpeedOfTheBoardsUart) {
  const PtyEndpoint endpoint;
  const SerialTransport transport(endpoint.address());
  const int port = ::open(endpoint.address().c_str(), O_RDWR | O_NOCTTY);
  ASSERT_GE(port, 0);
  termios line{};
  EXPECT_EQ(::tcgetattr(port, &line), 0);
  ::close(port);
  EXPECT_EQ(::cfgetospeed(&line), speed_t{B1000000});
  static_assert(boards::uart_baud == 1'000'000);
}

TEST(SerialTransport, MissingPortIsAnError) {
  try {
    SerialTransport transport("/dev/no-such-port");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.exit(), Exit::no_device);
    EXPECT_NE(std::string(error.what()).find("/dev/no-such-port"), std::string::npos);
  }
}

TEST(TcpEndpoint, CarriesEveryByteBothWaysOverReconnects) {
  TcpEndpoint endpoint("127.0.0.1:0");
  TcpTransport transport(endpoint.address());
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(carry(all_bytes(), transport, endpoint), all_bytes());
    EXPECT_EQ(carry(all_bytes(), endpoint, transport), all_bytes());
    EXPECT_TRUE(transport.reconnect());
  }
}

TEST(TcpEndpoint, HasOneHostAtATime) {
  TcpEndpoint endpoint("127.0.0.1:0");
  std::optional<TcpTransport> first{std::in_place, endpoint.address()};
  EXPECT_EQ(carry(all_bytes(), *first, endpoint), all_bytes());
  TcpTransport second(endpoint.address());
  EXPECT_EQ(carry(all_bytes(), *first, endpoint), all_bytes());
  std::array<std::uint8_t, 10> bytes{};
  second.wait(1s);
  EXPECT_EQ(second.read(bytes), 0u);
  EXPECT_FALSE(second.connected());
  EXPECT_EQ(carry(all_bytes(), endpoint, *first), all_bytes());
  first.reset();
  EXPECT_TRUE(second.reconnect());
  EXPECT_EQ(carry(all_bytes(), second, endpoint), all_bytes());
}

TEST(TcpTransport, BadAddressesAndUnusedOnesAreErrors) {
  std::string dead;
  {
    TcpEndpoint endpoint("127.0.0.1:0");
    dead = endpoint.address();
  }
  const auto exit_of = [](const std::string& address) {
    try {
      TcpTransport transport(address);
    } catch (const Error& error) {
      return error.exit();
    }
    return Exit::done;
  };
  EXPECT_EQ(exit_of(dead), Exit::no_device);
  EXPECT_EQ(exit_of("nonsense"), Exit::bad_input);
  EXPECT_EQ(exit_of("host:"), Exit::bad_input);
  EXPECT_EQ(exit_of("[]:1"), Exit::bad_input);
}

TEST(TcpAddress, AcceptsIpv6InBrackets) {
  const auto address = sim::parse_tcp_address("[::1]:2000");
  ASSERT_TRUE(address);
  EXPECT_EQ(address->host, "::1");
  EXPECT_EQ(address->port, "2000");
}

TEST(TcpEndpoint, UsedOrWrongAddressesAreErrors) {
  TcpEndpoint endpoint("127.0.0.1:0");
  EXPECT_THROW(TcpEndpoint{endpoint.address()}, std::system_error);
  EXPECT_THROW(TcpEndpoint{"nonsense"}, std::invalid_argument);
}

/// A board that runs in wall time behind an endpoint, in its own thread.
class Board {
 public:
  explicit Board(sim::ByteEndpoint& endpoint) : endpoint_(endpoint), thread_([this] { loop(); }) {}
  ~Board() { finish(); }
  void finish() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  std::unique_ptr<test::FakeMachine> machine = std::make_unique<test::FakeMachine>();

 private:
  void loop() {
    auto link = std::make_unique<link::Link>();
    std::array<std::uint8_t, 1024> bytes{};
    Bytes out;
    while (!stop_) {
      const std::size_t count = endpoint_.read(bytes);
      link->receive(std::span<const std::uint8_t>(bytes).first(count), *machine);
      machine->fire(20);
      link->poll(*machine);
      const std::size_t sent = link->transmit(bytes);
      out.insert(out.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(sent));
      const std::size_t taken = endpoint_.write(out);
      out.erase(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(taken));
      if (count == 0) std::this_thread::sleep_for(500us);
    }
  }
  sim::ByteEndpoint& endpoint_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

void send_job(link::Transport& transport, Board& board, bool cut) {
  const job::Job job = test::random_job(5000, 1);
  link::JobSender sender(transport, job);
  int step = 0;
  while (sender.step())
    if (cut && ++step % 10 == 0 && step <= 50) transport.reconnect();
  EXPECT_EQ(sender.result().end, link::JobEnd::done);
  board.finish();
  ASSERT_EQ(board.machine->fired.size(), job.targets.size());
  for (std::size_t i = 0; i < job.targets.size(); ++i)
    ASSERT_TRUE(test::same(board.machine->received[i], job.targets[i]));
}

TEST(Ports, AJobOverAPseudoTerminal) {
  PtyEndpoint endpoint;
  SerialTransport transport(endpoint.address());
  Board board(endpoint);
  send_job(transport, board, true);
}

TEST(Ports, AJobOverTcpWithCuts) {
  TcpEndpoint endpoint("127.0.0.1:0");
  TcpTransport transport(endpoint.address());
  Board board(endpoint);
  send_job(transport, board, true);
}

}  // namespace
}  // namespace lamplock
