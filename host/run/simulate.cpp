#include "host/run/simulate.hpp"

#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <span>
#include <thread>
#include <vector>

#include "host/duration_text.hpp"
#include "host/file/staged_file.hpp"
#include "host/run/board_files.hpp"
#include "host/run/endpoints.hpp"
#include "sim/world/limit_settings.hpp"
#include "sim/world/world.hpp"

namespace lamplock::run {
namespace {

using SimulationClock = std::chrono::steady_clock;
using sim::Picoseconds;

/// Interval between two exchanges with the ports; a USB frame.
constexpr std::chrono::milliseconds poll_interval{1};
/// A greater lag is reported and not made up for.
constexpr std::chrono::milliseconds tolerated_lag{100};

/// The board's ports. The board answers the port that sent last.
class Ports {
 public:
  explicit Ports(const SimOptions& options) {
    if (!options.pty.empty() || options.tcp.empty())
      ports_.push_back(open_pty("--pty " + options.pty, options.pty));
    if (!options.tcp.empty()) ports_.push_back(open_tcp("--tcp " + options.tcp, options.tcp));
    speaker_ = ports_.front().get();
  }

  const std::vector<std::unique_ptr<sim::ByteEndpoint>>& all() const { return ports_; }

  void exchange(sim::Board& board) {
    std::array<std::uint8_t, 1024> bytes{};
    for (const auto& port : ports_) {
      drop_front(to_board_, board.write(to_board_));
      if (!to_board_.empty()) break;  // the host waits, nothing is lost
      const std::size_t count = port->read(bytes);
      if (count == 0) continue;
      if (speaker_ != port.get()) to_host_.clear();
      speaker_ = port.get();
      append(to_board_, std::span(bytes).first(count));
    }
    drop_front(to_board_, board.write(to_board_));
    while (to_host_.empty()) {
      const std::size_t count = board.read(bytes);
      if (count == 0) break;
      append(to_host_, std::span(bytes).first(count));
      drop_front(to_host_, speaker_->write(to_host_));
    }
    drop_front(to_host_, speaker_->write(to_host_));
  }

 private:
  using Bytes = std::vector<std::uint8_t>;
  static void append(Bytes& queue, std::span<const std::uint8_t> bytes) {
    queue.insert(queue.end(), bytes.begin(), bytes.end());
  }
  static void drop_front(Bytes& queue, std::size_t count) {
    queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(count));
  }

  std::vector<std::unique_ptr<sim::ByteEndpoint>> ports_;
  sim::ByteEndpoint* speaker_ = nullptr;
  Bytes to_board_, to_host_;
};

/// Reports to the board when the last host closes its port, and when one opens it.
class HostPresence {
 public:
  void poll(sim::Board& board, const Ports& ports) {
    bool present = false;
    for (const auto& port : ports.all()) present = port->host_present() || present;
    if (present != present_) board.set_host_present(present);
    present_ = present;
  }

 private:
  bool present_ = false;
};

/// Runs until the user or --seconds ends it.
void run_at_wall_pace(sim::Board& board, Ports& ports, const SimOptions& options,
                      Frontend& frontend, const Interrupts& interrupts) {
  HostPresence hosts;
  auto start = SimulationClock::now();
  const double limit_s = options.seconds.value_or(std::numeric_limits<double>::infinity());
  while (interrupts.count() == 0 && sim::seconds(board.now()) < limit_s) {
    ports.exchange(board);
    hosts.poll(board, ports);
    const auto wall =
        std::chrono::duration_cast<std::chrono::nanoseconds>(SimulationClock::now() - start);
    const Picoseconds due = wall.count() * sim::ps_per_ns;
    const Picoseconds lag = due - board.now();
    if (lag > std::chrono::nanoseconds(tolerated_lag).count() * sim::ps_per_ns) {
      frontend.say("lags the wall clock by {} ms", lag / sim::ps_per_ms);
      start += std::chrono::nanoseconds(lag / sim::ps_per_ns);
      continue;
    }
    board.run_until(due);
    std::this_thread::sleep_for(poll_interval);
  }
}

}  // namespace

Simulated simulate(const SimOptions& options, Frontend& frontend) {
  check_image(options.board, options.image);
  for (const std::string& file : {options.vcd, options.shots})
    if (!file.empty()) check_target(file);
  const settings::Values values = options.machine.profile().settings;
  sim::WorldConfig world;
  world.lamp = options.faults.lamp(values);
  world.drives = options.drives.drives(values);
  world.switches = sim::limits_of(values);
  world.heat = options.spot.heat(values);
  Ports ports(options);
  const SimulatedBoard made = make_board(options.board, options.image, values, world);
  sim::Board& board = *made.board;
  std::optional<PinTrace> trace;
  if (!options.vcd.empty()) trace.emplace(options.vcd, board);
  // The reader of the address may end the simulation at once.
  const std::unique_ptr<Interrupts> interrupts = frontend.interrupts();
  for (const auto& port : ports.all()) frontend.say("listening on {}", port->address());
  frontend.require_output();
  if (!options.seconds) frontend.say("Ctrl-C ends the simulation");
  run_at_wall_pace(board, ports, options, frontend, *interrupts);
  Simulated result{board.world().laser().shots().size(), board.world().lamp().flashes()};
  frontend.say("{} shots, {} lamp flashes in {}", result.shots, result.flashes,
               duration_text(sim::seconds(board.now())));
  if (trace) result.lost.attempt(options.vcd, [&trace] { trace->finish(); });
  if (!options.shots.empty())
    result.lost.attempt(options.shots, [&] { write_shots(options.shots, board, values); });
  return result;
}

}  // namespace lamplock::run
