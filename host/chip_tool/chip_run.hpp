// Runs one image on one simulated chip, with all devices that can be connected to it.
//
// In:  an image, options of the run; time.
// Out: the run: its pads, ports, profile, and the state of its script.
// Who: `lamplock chip`, which runs slices of time and shows the results.
//
// Time 0 is power-up. A PC is connected to the USB from the start; it has no effect on an image
// without USB. With a debugger the cores are halted before their first instruction until it
// continues them.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>

#include "sim/chip/chip.hpp"
#include "sim/chip/fabric/flash_use.hpp"
#include "sim/chip/image/image.hpp"
#include "sim/chip/profile/function_table.hpp"
#include "sim/chip/script/serial_ports.hpp"
#include "sim/chip/trace/pad_counter.hpp"
#include "sim/chip/usb_host/usb_host.hpp"

namespace lamplock::sim {
class TcpEndpoint;
}
namespace lamplock::sim::chip {
class Profile;
}
namespace lamplock::sim::chip::gdb {
class Server;
}
namespace lamplock::sim::chip::script {
class Runner;
}

namespace lamplock::chip_tool {

/// Options of a run; empty: not used.
struct ChipRunOptions {
  std::string image{}, script{}, vcd{}, profile{}, flash_use{};
  std::string gdb{};  ///< [HOST:]PORT, 0 any free one
  bool step_every_clock = false;
  std::size_t flash_size = sim::chip::FlashChip::default_size;
};

/// Why a run ended.
enum class RunEnd : std::uint8_t { script, until, default_limit, interrupt, terminated, debugger };

/// How a run ended.
struct RunResult {
  RunEnd end = RunEnd::until;
  sim::Picoseconds limit = 0;  ///< simulated time at which it was to end
  double wall_seconds = 0;
};

/// The run.
class ChipRun {
 public:
  /// Reads the files and switches the power on. Throws Error(bad_input).
  explicit ChipRun(const ChipRunOptions& options);
  ~ChipRun();
  ChipRun(const ChipRun&) = delete;
  ChipRun& operator=(const ChipRun&) = delete;

  /// Address of the chip for a debugger, HOST:PORT; empty without one.
  std::string debugger_address() const;
  /// Runs to a simulated time, and the instructions in progress to their ends. A debugger may halt
  /// the chip; `is_cancelled` is called meanwhile. False: the debugger or is_cancelled has ended
  /// the run.
  bool run_until(sim::Picoseconds until, const std::function<bool()>& is_cancelled);
  /// The time up to which the chip has run; its last instructions may end later.
  sim::Picoseconds now() const { return reached_; }
  /// Writes the trace, the profile and the use of the flash to their files. Throws
  /// Error(bad_input).
  void finish();

  const sim::chip::FunctionTable& functions() const { return functions_; }
  const std::string& image_name() const { return options_.image; }
  /// The script allows such a fault.
  bool allows(const sim::chip::Fault& fault) const;
  /// The first fault that the script does not allow; null: none.
  const sim::chip::Fault* fatal_fault() const;
  sim::chip::Chip& chip() { return chip_; }
  const sim::chip::Chip& chip() const { return chip_; }
  sim::chip::UsbHost& usb_host() { return host_; }
  sim::chip::script::SerialPorts& ports() { return ports_; }
  const sim::chip::PadCounter& pads() const { return pads_; }
  /// Null without a script.
  const sim::chip::script::Runner* script() const { return runner_.get(); }
  /// The profile of a core; null without one.
  const sim::chip::Profile* profile(std::size_t core) const;

 private:
  struct Trace;
  struct CoreProfile;

  bool advance(sim::chip::Cycle target, const std::function<bool()>& is_cancelled);

  ChipRunOptions options_;
  sim::chip::Image image_;
  sim::chip::FunctionTable functions_;
  sim::chip::Chip chip_;
  sim::chip::UsbHost host_;
  sim::chip::script::SerialPorts ports_;
  sim::chip::PadCounter pads_;
  std::unique_ptr<sim::chip::script::Runner> runner_;
  std::unique_ptr<Trace> trace_;
  std::unique_ptr<sim::chip::FlashUse> flash_use_;
  std::array<std::unique_ptr<CoreProfile>, 2> profiles_;
  std::unique_ptr<sim::TcpEndpoint> door_;
  std::unique_ptr<sim::chip::gdb::Server> debugger_;
  sim::Picoseconds reached_ = 0;
};

}  // namespace lamplock::chip_tool
