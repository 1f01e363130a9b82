// `lamplock chip`: any image for the RP2040 in the chip simulator.
#include <array>
#include <chrono>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "host/chip_tool/chip_run.hpp"
#include "host/chip_tool/chip_summary.hpp"
#include "host/chip_tool/command_chip.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/console.hpp"
#include "host/cli/endpoints.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/program.hpp"
#include "host/cli/simulator_error.hpp"
#include "host/cli/validators.hpp"
#include "sim/chip/script/parser.hpp"

namespace lamplock::chip_tool {
namespace {

using cli::Command;
using cli::Console;
using cli::Interrupt;
using cli::most_unsent;
using cli::one_of;
using cli::open_pty;
using cli::refuse;

using WallClock = std::chrono::steady_clock;
using sim::Picoseconds;
using sim::chip::script::Port;

/// Ports and Ctrl-C are looked at this often, simulated time.
constexpr Picoseconds slice = 100 * sim::ps_per_us;
/// So much ahead of the wall clock, a run with terminals waits.
constexpr Picoseconds tolerated_lead = sim::ps_per_ms;
/// Costliest functions shown per core.
constexpr std::size_t profile_lines = 20;
constexpr std::size_t mib = 1024 * 1024;
/// What --pty, --uart and --uart1 mean without a name of one's own.
constexpr const char* unnamed = "pty";

struct Options {
  ChipRunOptions run;
  std::string until, pty, uart0, uart1;
  bool freq = false, json = false;
};

/// A port of the chip at a pseudo-terminal.
class Terminal {
 public:
  Terminal(Port port, const std::string& link, const std::string& option)
      : port_(port),
        endpoint_(open_pty(option + ' ' + link, link == unnamed ? std::string() : link)) {}

  std::string address() const { return endpoint_->address(); }
  void exchange(sim::chip::script::SerialPorts& ports) {
    std::array<std::uint8_t, 1024> bytes{};
    const std::size_t count = endpoint_->read(bytes);
    if (count > 0) ports.send(port_, {reinterpret_cast<const char*>(bytes.data()), count});
    const std::string said = ports.take(port_);
    if (unsent_.size() < most_unsent) unsent_ += said;
    const auto* const first = reinterpret_cast<const std::uint8_t*>(unsent_.data());
    unsent_.erase(0, endpoint_->write({first, unsent_.size()}));
  }

 private:
  Port port_;
  std::unique_ptr<sim::PtyEndpoint> endpoint_;
  std::string unsent_;
};

/// Where the bytes of the chip's ports go.
class Terminals {
 public:
  Terminals(const Options& options, Console& console) : console_(console) {
    if (!options.pty.empty()) add(Port::usb, options.pty, "--pty", "USB");
    add_uart(Port::uart0, options.uart0, "--uart", "UART0");
    add_uart(Port::uart1, options.uart1, "--uart1", "UART1");
  }
  bool any() const { return !terminals_.empty(); }
  void exchange(sim::chip::script::SerialPorts& ports) {
    for (const auto& terminal : terminals_) terminal->exchange(ports);
    for (const Port port : shown_)
      if (const std::string said = ports.take(port); !said.empty()) console_.text(said);
  }

 private:
  void add(Port port, const std::string& link, const std::string& option, const char* name) {
    terminals_.push_back(std::make_unique<Terminal>(port, link, option));
    console_.say("{} is {}", name, terminals_.back()->address());
  }
  void add_uart(Port port, const std::string& link, const std::string& option, const char* name) {
    if (link == "-")
      shown_.push_back(port);
    else if (!link.empty())
      add(port, link, option, name);
  }
  Console& console_;
  std::vector<Port> shown_;
  std::vector<std::unique_ptr<Terminal>> terminals_;
};

/// A run with terminals keeps to the wall clock where it can; a run that has fallen behind does not
/// hurry afterwards.
class Pace {
 public:
  void wait(Picoseconds simulated) {
    const auto wall =
        std::chrono::duration_cast<std::chrono::nanoseconds>(WallClock::now() - start_).count() *
        sim::ps_per_ns;
    const Picoseconds lead = simulated - wall;
    if (lead > tolerated_lead)
      std::this_thread::sleep_for(std::chrono::nanoseconds(lead / sim::ps_per_ns));
    else if (lead < 0)
      start_ -= std::chrono::nanoseconds(lead / sim::ps_per_ns);
  }

 private:
  WallClock::time_point start_ = WallClock::now();
};

/// Runs to the end of time or of the script; whether nobody interrupted it.
bool run_to_end(ChipRun& run, Terminals& terminals, Picoseconds until) {
  const Interrupt interrupt;
  const auto interrupted = [&interrupt] { return interrupt.count() != 0; };
  Pace pace;
  while (run.now() < until && (run.script() == nullptr || !run.script()->done())) {
    if (interrupted()) return false;
    // On a grid of slices, however far the one before has gone beyond its end.
    if (!run.run_until(std::min(until, (run.now() / slice + 1) * slice), interrupted)) return false;
    terminals.exchange(run.ports());
    if (terminals.any()) pace.wait(run.now());
  }
  return true;
}

[[noreturn]] void expectation_failed(const std::string& script,
                                     const sim::chip::script::Failure& failure) {
  throw Error(Exit::job_failed, script + ':' + std::to_string(failure.line),
              "expected " + failure.expected + ", seen: " + failure.seen + ", at " +
                  sim::chip::script::time_text(failure.at),
              "look at the trace (--vcd FILE)");
}

Exit conclude(const ChipRun& run, const std::string& script, bool whole) {
  if (run.script() == nullptr) return Exit::done;
  if (run.script()->failure()) expectation_failed(script, *run.script()->failure());
  if (run.script()->done()) return Exit::done;
  if (!whole) return Exit::interrupted;
  expectation_failed(script, run.script()->standing());
}

Picoseconds end_time(const Options& options) {
  if (options.until.empty()) return std::numeric_limits<Picoseconds>::max() - slice;
  try {
    return sim::chip::script::parse_time(options.until, "--until");
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
}

Exit run_image(const Options& options) {
  Console console(options.json);
  const Picoseconds until = end_time(options);
  ChipRun run(options.run);
  if (const std::string door = run.debugger_address(); !door.empty())
    console.say("waiting for a debugger: gdb-multiarch {} -ex 'target remote {}'",
                options.run.image, door);
  Terminals terminals(options, console);
  const auto start = WallClock::now();
  const bool whole = run_to_end(run, terminals, until);
  const double wall_seconds = std::chrono::duration<double>(WallClock::now() - start).count();
  run.finish();
  console.text(chip_summary(run, wall_seconds));
  if (options.freq) console.text(chip_frequencies(run));
  for (std::size_t core = 0; core < 2; ++core)
    if (const auto* profile = run.profile(core)) console.text(profile->text(profile_lines));
  console.document(chip_json(run, wall_seconds));
  return conclude(run, options.run.script, whole);
}

}  // namespace

void add_chip(Command& program) {
  Command& app = cli::add_chip_command(program);
  app.footer(
      "Example:\n  lamplock chip blink.uf2 --until 2.5s --vcd blink.vcd --freq\n"
      "  lamplock chip firmware.elf --script test.script      # status 1 if it does not pass\n"
      "  lamplock chip firmware.elf --pty                     # its serial port on a terminal");
  const auto options = std::make_shared<Options>();
  app.add_option("IMAGE", &options->run.image, "ELF, UF2 or BIN file").required();
  app.add_option("--until", &options->until,
                 "End at this simulated time, such as 2.5s or 10ms; without it when the script "
                 "ends, or at Ctrl-C")
      .value_name("TIME");
  app.add_option("--script", &options->run.script,
                 "Drive pins and ports, and expect things of them (docs/chip-script.md)")
      .value_name("FILE");
  app.add_option("--vcd", &options->run.vcd, "Trace of all pins, for GTKWave").value_name("FILE");
  app.add_option("--profile", &options->run.profile,
                 "Cycles by function and interrupt, as folded stacks for flame graphs; a table on "
                 "the terminal")
      .value_name("FILE");
  app.add_option("--pty", &options->pty,
                 "Serial port of the image's USB as a pseudo-terminal; --pty=LINK makes a link to "
                 "it; keeps to the wall clock")
      .bare(unnamed);
  app.add_option("--uart", &options->uart0,
                 "UART0: - shows what it sends, pty makes a pseudo-terminal, any other name a "
                 "link to one")
      .value_name("-|pty|LINK");
  app.add_option("--uart1", &options->uart1, "The same for UART1; both can be shown")
      .value_name("-|pty|LINK");
  app.add_option("--gdb", &options->run.gdb,
                 "Wait for gdb on this port of 127.0.0.1 (0: any free one), or on HOST:PORT, with "
                 "both cores halted at reset")
      .value_name("PORT");
  app.add_option("--freq", &options->freq, "Print the frequencies of clocks and pins at the end");
  app.add_option("--step-every-clock", &options->run.step_every_clock,
                 "Run PIO and DMA in every single clock instead of skipping those in which nothing "
                 "happens: slower, the same trace");
  const auto flash_mib = std::make_shared<std::size_t>(options->run.flash_size / mib);
  app.add_option("--flash-size", flash_mib.get(), "Size of the flash in MiB")
      .check(one_of({"1", "2", "4", "8", "16"}))
      .value_name("1|2|4|8|16")
      .show_default();
  app.add_json(options->json, "Print the summary as JSON on stdout");
  app.action([options, flash_mib] {
    options->run.flash_size = *flash_mib * mib;
    return run_image(*options);
  });
}

}  // namespace lamplock::chip_tool
