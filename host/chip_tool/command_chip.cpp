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

#include "host/chip_tool/chip_faults.hpp"
#include "host/chip_tool/chip_run.hpp"
#include "host/chip_tool/chip_summary.hpp"
#include "host/chip_tool/command_chip.hpp"
#include "host/cli/command_line.hpp"
#include "host/cli/console.hpp"
#include "host/cli/interrupt.hpp"
#include "host/cli/program.hpp"
#include "host/cli/validators.hpp"
#include "host/run/endpoints.hpp"
#include "host/run/simulator_error.hpp"
#include "sim/chip/script/parser.hpp"
#include "sim/chip/script/runner.hpp"

namespace lamplock::chip_tool {
namespace {

using cli::Command;
using cli::Console;
using cli::Interrupt;
using cli::is_ended_by_signal;
using cli::one_of;
using run::max_unsent;
using run::open_pty;
using run::refuse;

using WallClock = std::chrono::steady_clock;
using sim::Picoseconds;
using sim::chip::script::Port;

/// Interval for ports and Ctrl-C, simulated time.
constexpr Picoseconds slice = 100 * sim::ps_per_us;
/// A run with terminals that is further ahead of the wall clock waits.
constexpr Picoseconds tolerated_lead = sim::ps_per_ms;
/// A script without --until must end by then.
constexpr Picoseconds default_script_limit = 60 * sim::ps_per_s;
/// Costliest functions shown per core.
constexpr std::size_t profile_lines = 20;
constexpr std::size_t mib = 1024 * 1024;
/// The value of --pty, --uart and --uart1 without a name.
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
    if (unsent_.size() < max_unsent) unsent_ += said;
    const auto* const first = reinterpret_cast<const std::uint8_t*>(unsent_.data());
    unsent_.erase(0, endpoint_->write({first, unsent_.size()}));
  }

 private:
  Port port_;
  std::unique_ptr<sim::PtyEndpoint> endpoint_;
  std::string unsent_;
};

/// Terminals for the bytes of the chip's ports.
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

/// Keeps a run with terminals at the pace of the wall clock if possible; a run that is late does
/// not catch up later.
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

/// Latest end of a run, and the source of that limit.
RunResult limit_of(const Options& options) {
  if (options.until.empty() && !options.run.script.empty())
    return {RunEnd::default_limit, default_script_limit, 0};
  if (options.until.empty())
    return {RunEnd::until, std::numeric_limits<Picoseconds>::max() - slice, 0};
  try {
    return {RunEnd::until, sim::chip::script::parse_time(options.until, "--until"), 0};
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
}

/// Runs to the end of the script, to the limit, or until the user or the debugger ends it.
RunEnd run_to_end(ChipRun& run, Terminals& terminals, const RunResult& limit,
                  const Interrupt& interrupt) {
  const auto interrupted = [&interrupt] { return interrupt.count() != 0; };
  const auto stopped = [&interrupt] {
    return interrupt.terminated()   ? RunEnd::terminated
           : interrupt.count() != 0 ? RunEnd::interrupt
                                    : RunEnd::debugger;
  };
  const auto script_done = [&run] { return run.script() != nullptr && run.script()->done(); };
  Pace pace;
  while (run.now() < limit.limit && !script_done()) {
    if (interrupted()) return stopped();
    // On a grid of slices: the one before may have ended late.
    const Picoseconds next = (run.now() / slice + 1) * slice;
    if (!run.run_until(std::min(limit.limit, next), interrupted)) return stopped();
    terminals.exchange(run.ports());
    if (terminals.any()) pace.wait(run.now());
  }
  return script_done() ? RunEnd::script : limit.end;
}

using sim::chip::script::Failure;

[[noreturn]] void expectation_failed(const std::string& script, const Failure& failure,
                                     const std::string& remedy) {
  throw Error(Exit::job_failed, script + ':' + std::to_string(failure.line),
              "expected " + failure.expected + ", seen: " + failure.seen + ", at " +
                  sim::chip::script::time_text(failure.at),
              remedy);
}

[[noreturn]] void image_failed(const ChipRun& run, const sim::chip::Fault& fault) {
  throw Error(Exit::job_failed, run.image_name(), fault_text(run, fault),
              fmt::format("correct the image, or write 'allow {}' in the script if it is intended",
                          word_of(fault.kind)));
}

/// A fault has priority over an expectation that failed later: it is the likely cause.
Exit conclude(const ChipRun& run, const Options& options, const RunResult& result) {
  const std::string& script = options.run.script;
  if (result.end == RunEnd::terminated) return Exit::terminated;
  const auto* const runner = run.script();
  const std::optional<Failure> failure =
      runner != nullptr ? runner->failure() : std::optional<Failure>();
  const sim::chip::Fault* const fault = run.fatal_fault();
  if (fault != nullptr && (!failure || fault->at <= failure->at)) image_failed(run, *fault);
  if (failure) expectation_failed(script, *failure, "examine the trace (--vcd FILE)");
  const bool has_end = runner != nullptr || !options.until.empty();
  // Ctrl-C is the usual end of a run without another one.
  if (result.end == RunEnd::interrupt && (has_end || is_ended_by_signal()))
    return Exit::interrupted;
  if (runner == nullptr || runner->done()) return Exit::done;
  if (result.end == RunEnd::debugger) return Exit::interrupted;
  Failure open = open_step(run, result);
  open.seen += " (" + end_text(result) + ')';
  expectation_failed(script, open, "examine the trace (--vcd FILE) or give a later --until");
}

Exit run_image(const Options& options) {
  Console console(options.json);
  RunResult result = limit_of(options);
  ChipRun run(options.run);
  if (const std::string door = run.debugger_address(); !door.empty())
    console.say("waiting for a debugger: gdb-multiarch {} -ex 'target remote {}'",
                options.run.image, door);
  const Interrupt interrupt;
  Terminals terminals(options, console);
  console.require_output();
  const auto start = WallClock::now();
  result.end = run_to_end(run, terminals, result, interrupt);
  result.wall_seconds = std::chrono::duration<double>(WallClock::now() - start).count();
  run.finish();
  console.text(chip_summary(run, result));
  if (options.freq) console.text(chip_frequencies(run));
  for (std::size_t core = 0; core < 2; ++core)
    if (const auto* profile = run.profile(core)) console.text(profile->text(profile_lines));
  console.document(chip_json(run, result));
  return conclude(run, options, result);
}

}  // namespace

void add_chip(Command& program) {
  Command& app = cli::add_chip_command(program);
  app.footer(
      "Example:\n  lamplock chip blink.uf2 --until 2.5s --vcd blink.vcd --freq\n"
      "  lamplock chip firmware.elf --script test.script      # status 1 if it does not pass\n"
      "  lamplock chip firmware.elf --pty                     # its serial port on a terminal\n\n"
      "A HardFault, a lock-up, a bad boot block and a reset by the watchdog are errors: the\n"
      "summary has cause, pc, lr, symbol and cycle of the first of each. A script permits them by\n"
      "'allow hardfault', 'allow lockup', 'allow bootblock' and 'allow watchdog'.\n"
      "Exit status: 0 done, 1 fault of the image or expectation not met, 2 bad input, 3 terminal\n"
      "or port cannot be opened; ended by a signal before the end of the script or --until: 130\n"
      "SIGINT (Ctrl-C), 129 SIGHUP, 143 SIGTERM. Without script and --until Ctrl-C gives 0.");
  const auto options = std::make_shared<Options>();
  app.add_option("IMAGE", &options->run.image, "ELF, UF2 or BIN file")
      .file(cli::FileUse::read)
      .required();
  app.add_option("--until", &options->until,
                 "Stop at this simulated time, such as 2.5s or 10ms; default: the end of the "
                 "script, at most 60s; without a script: Ctrl-C")
      .value_name("TIME");
  app.add_option("--script", &options->run.script,
                 "Script that drives pins and ports and checks them (docs/chip-script.md)")
      .value_name("FILE")
      .file(cli::FileUse::read);
  app.add_option("--vcd", &options->run.vcd, "Write a trace of all pins (VCD, for GTKWave)")
      .value_name("FILE")
      .file(cli::FileUse::write, ".vcd");
  app.add_option("--profile", &options->run.profile,
                 "Write cycles by function and interrupt as folded stacks for flame graphs, and "
                 "print a table")
      .value_name("FILE")
      .file(cli::FileUse::write, ".txt");
  app.add_option("--flash-use", &options->run.flash_use,
                 "Write how often each line of 8 bytes of the flash was visited and missed the "
                 "cache (docs/chip-simulator.md)")
      .value_name("FILE")
      .file(cli::FileUse::write, ".txt");
  app.add_option("--pty", &options->pty,
                 "Open a pseudo-terminal for the USB serial port of the image and run in real "
                 "time; --pty=LINK creates a link to the pseudo-terminal")
      .bare(unnamed);
  app.add_option("--uart", &options->uart0,
                 "UART0: - prints its output; pty opens a pseudo-terminal; any other name also "
                 "creates a link of that name to the pseudo-terminal")
      .value_name("-|pty|LINK");
  app.add_option("--uart1", &options->uart1,
                 "Same as --uart for UART1; the output of both can be printed")
      .value_name("-|pty|LINK");
  app.add_option("--gdb", &options->run.gdb,
                 "Wait for gdb on this port of 127.0.0.1 (0: any free port), or on HOST:PORT, with "
                 "both cores halted at reset")
      .value_name("PORT");
  app.add_option("--freq", &options->freq, "Print the frequencies of clocks and pins at the end");
  app.add_option(
      "--step-every-clock", &options->run.step_every_clock,
      "Run PIO and DMA in every clock cycle instead of skipping idle cycles; slower, same trace");
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
