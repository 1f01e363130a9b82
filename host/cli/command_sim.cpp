// `lamplock sim`: a simulated board at the end of a real port, at the pace of the wall clock.
#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "host/cli/board_files.hpp"
#include "host/cli/boards.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/endpoints.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/options.hpp"
#include "host/cli/outputs.hpp"
#include "host/cli/staged_file.hpp"
#include "sim/world/limit_settings.hpp"
#include "sim/world/world.hpp"

namespace lamplock::cli {
namespace {

using SimulationClock = std::chrono::steady_clock;
using sim::Picoseconds;

/// The world is looked at this often; a USB frame.
constexpr std::chrono::milliseconds poll_interval{1};
/// Falling behind by more is told, and made up for by waiting less, not by hurrying.
constexpr std::chrono::milliseconds tolerated_lag{100};

struct SimOptions {
  std::string board = virtual_board, image, pty, tcp, vcd, shots;
  std::optional<double> seconds;
  bool json = false;
  MachineOptions machine;
  LampFaults faults;
  SimulatedDrives drives;
};

/// The board's ports. Whoever spoke last is answered.
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

/// Tells the board when the last host closes its port, and when one comes.
class HostWatch {
 public:
  void look(sim::Board& board, const Ports& ports) {
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
                      Console& console) {
  const Interrupt interrupt;
  HostWatch hosts;
  auto start = SimulationClock::now();
  const double limit_s = options.seconds.value_or(std::numeric_limits<double>::infinity());
  while (interrupt.count() == 0 && sim::seconds(board.now()) < limit_s) {
    ports.exchange(board);
    hosts.look(board, ports);
    const auto wall =
        std::chrono::duration_cast<std::chrono::nanoseconds>(SimulationClock::now() - start);
    const Picoseconds due = wall.count() * sim::ps_per_ns;
    const Picoseconds lag = due - board.now();
    if (lag > std::chrono::nanoseconds(tolerated_lag).count() * sim::ps_per_ns) {
      console.say("fell behind the wall clock by {} ms", lag / sim::ps_per_ms);
      start += std::chrono::nanoseconds(lag / sim::ps_per_ns);
      continue;
    }
    board.run_until(due);
    std::this_thread::sleep_for(poll_interval);
  }
}

Exit simulate(const SimOptions& options) {
  Console console(options.json);
  check_image(options.board, options.image);
  check_distinct({{"--vcd", options.vcd}, {"--shots", options.shots}});
  for (const std::string& file : {options.vcd, options.shots})
    if (!file.empty()) check_target(file);
  const settings::Values values = options.machine.profile().settings;
  sim::WorldConfig world;
  world.lamp = options.faults.lamp(values);
  world.drives = options.drives.drives(values);
  world.switches = sim::limits_of(values);
  Ports ports(options);
  const SimulatedBoard made = make_board(options.board, options.image, values, world);
  sim::Board& board = *made.board;
  std::optional<PinTrace> trace;
  if (!options.vcd.empty()) trace.emplace(options.vcd, board);
  for (const auto& port : ports.all()) console.say("listening on {}", port->address());
  if (!options.seconds) console.say("Ctrl-C ends the simulation");
  run_at_wall_pace(board, ports, options, console);
  const auto shots = board.world().laser().shots().size();
  const auto flashes = board.world().lamp().flashes();
  console.say("{} shots, {} lamp flashes in {:.1f} s", shots, flashes, sim::seconds(board.now()));
  if (trace) trace->finish();
  if (!options.shots.empty()) write_shots(options.shots, board, values);
  console.document({{"shots", shots}, {"flashes", flashes}});
  return Exit::done;
}

}  // namespace

void add_sim(Command& program) {
  Command& app = program.add_command(
      "sim", "A simulated board on a port, at the pace of the wall clock, as hardware would be");
  app.footer(
      "Example:\n  lamplock sim --pty /tmp/engraver --lamp 100\n"
      "  lamplock engrave model.stl --size 5 --board /tmp/engraver     # in another terminal");
  const auto options = std::make_shared<SimOptions>();
  app.add_option("--board", &options->board,
                 "virtual: the firmware core on a virtual clock; chip: the flash image, "
                 "instruction by instruction")
      .check(one_of({virtual_board, chip_board}))
      .value_name("virtual|chip")
      .show_default();
  app.add_option("--image", &options->image,
                 "Flash image for the chip; without it that of this build")
      .value_name("FILE");
  app.add_option("--pty", &options->pty, "Pseudo-terminal, with a link to it of this name")
      .value_name("LINK");
  app.add_option("--tcp", &options->tcp, "Listen there; port 0 chooses a free one")
      .value_name("HOST:PORT");
  app.add_option("--seconds", &options->seconds, "End after so long")
      .check(number_from(0, false))
      .value_name("S");
  app.add_option("--vcd", &options->vcd, "Trace of all pins, for GTKWave").value_name("FILE");
  app.add_option("--shots", &options->shots, "What the laser fired, as CSV").value_name("FILE");
  app.add_json(options->json);
  options->machine.add_machine(app);
  options->machine.add_overrides(app);
  options->faults.add(app);
  options->drives.add(app);
  app.action([options] { return simulate(*options); });
}

}  // namespace lamplock::cli
