#include "host/chip_tool/chip_run.hpp"

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/run/endpoints.hpp"
#include "host/run/simulated_boards.hpp"
#include "host/run/simulator_error.hpp"
#include "sim/chip/gdb/server.hpp"
#include "sim/chip/profile/call_stacks.hpp"
#include "sim/chip/profile/profile.hpp"
#include "sim/chip/profile/shadow_stack.hpp"
#include "sim/chip/script/parser.hpp"
#include "sim/chip/script/runner.hpp"
#include "sim/chip/trace/pad_trace.hpp"
#include "sim/endpoint/tcp_endpoint.hpp"

namespace lamplock::chip_tool {
namespace {

using run::open_tcp;
using run::read_image;
using run::refuse;

namespace chip = sim::chip;

chip::script::Script read_script(const std::string& file) {
  const std::string text = read_text_file(file);
  try {
    return chip::script::parse(text, file);
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
}

chip::ChipOptions chip_options(const ChipRunOptions& options) {
  chip::ChipOptions result;
  result.flash_size = options.flash_size;
  return result;
}

std::unique_ptr<sim::TcpEndpoint> open_door(const std::string& port) {
  const bool port_alone = port.find(':') == std::string::npos;
  return open_tcp("--gdb " + port, port_alone ? "127.0.0.1:" + port : port);
}

void write_text(const std::string& file, const std::string& text) {
  write_whole(file, [&text](const std::filesystem::path& path) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw Error(Exit::bad_input, path.string(), "cannot be written", "check the disk");
  });
}

}  // namespace

/// A file that is written while the chip runs.
struct ChipRun::Trace {
  Trace(const std::string& name, chip::Chip& chip)
      : file(name), stream(file.path(), std::ios::binary), writer(stream, chip) {}
  StagedFile file;
  std::ofstream stream;
  chip::PadTrace writer;
};

/// Both views of the use of a core's cycles.
struct ChipRun::CoreProfile {
  CoreProfile(chip::Core& core, const chip::Image& image)
      : stack(core, image.symbols), table(stack), ways(stack) {}
  chip::ShadowStack stack;
  chip::Profile table;
  chip::CallStacks ways;
};

ChipRun::ChipRun(const ChipRunOptions& options)
    : options_(options),
      image_(read_image(options.image)),
      functions_(image_.symbols),
      chip_(chip_options(options)),
      host_(chip_.wheel(), chip_.usb()),
      ports_(chip_, host_),
      pads_(chip_) {
  if (!options.script.empty())
    runner_ = std::make_unique<chip::script::Runner>(chip_, ports_, read_script(options.script));
  for (const std::string& file : {options.vcd, options.profile, options.flash_use})
    if (!file.empty()) check_target(file);
  if (!options.vcd.empty()) trace_ = std::make_unique<Trace>(options.vcd, chip_);
  if (!options.profile.empty())
    for (std::size_t core = 0; core < profiles_.size(); ++core)
      profiles_[core] = std::make_unique<CoreProfile>(chip_.core(static_cast<int>(core)), image_);
  if (!options.flash_use.empty()) {
    flash_use_ = std::make_unique<chip::FlashUse>(options.flash_size);
    chip_.xip().count_use(flash_use_.get());
  }
  try {
    chip_.load(image_, options.image);
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
  chip_.pio_dma().set_step_every_clock(options.step_every_clock);
  chip_.power_on();
  if (options.gdb.empty()) return;
  door_ = open_door(options.gdb);
  debugger_ = std::make_unique<chip::gdb::Server>(chip_, *door_, chip::gdb::Start::halted);
}

ChipRun::~ChipRun() = default;

std::string ChipRun::debugger_address() const { return door_ ? door_->address() : std::string(); }

const chip::Profile* ChipRun::profile(std::size_t core) const {
  return profiles_[core] ? &profiles_[core]->table : nullptr;
}

bool ChipRun::advance(chip::Cycle target, const std::function<bool()>& is_cancelled) {
  if (debugger_) return debugger_->run_until(target, is_cancelled);
  chip_.run_until(target);
  return true;
}

bool ChipRun::run_until(sim::Picoseconds until, const std::function<bool()>& is_cancelled) {
  bool runs = true;
  chip::Cycle reached = 0;
  // A change of the clock changes the cycle of a given time.
  for (chip::Cycle target = chip_.wheel().cycle_at(until); runs && target > chip_.wheel().now();
       target = chip_.wheel().cycle_at(until)) {
    runs = advance(target, is_cancelled);
    reached = target;
  }
  // Instructions may have ended a little later.
  const chip::Cycle end =
      std::min(std::max(reached, chip_.wheel().cycle_at(until)), chip_.wheel().now());
  reached_ = chip_.wheel().time_of(end);
  chip_.gpio().catch_up(end);
  ports_.poll(end);
  if (trace_) trace_->writer.flush(now());
  return runs;
}

bool ChipRun::allows(const chip::Fault& fault) const {
  return runner_ != nullptr && runner_->allows(fault.kind);
}

const chip::Fault* ChipRun::fatal_fault() const {
  const auto& faults = chip_.faults();
  const auto found = std::find_if(faults.begin(), faults.end(),
                                  [this](const chip::Fault& fault) { return !allows(fault); });
  return found == faults.end() ? nullptr : &*found;
}

void ChipRun::finish() {
  if (trace_) {
    trace_->writer.finish(now());
    trace_->stream.close();
    if (!trace_->stream)
      throw Error(Exit::bad_input, options_.vcd, "cannot be written",
                  "check permissions and free space");
    trace_->file.commit();
  }
  if (!options_.profile.empty())
    write_text(options_.profile, profiles_[0]->ways.folded() + profiles_[1]->ways.folded());
  if (flash_use_) write_text(options_.flash_use, flash_use_->text());
}

}  // namespace lamplock::chip_tool
