#include "host/run/flash_board.hpp"

#include <fmt/format.h>

#include <functional>
#include <memory>
#include <utility>

#include "host/flash/drive.hpp"
#include "host/gpio/board_lines.hpp"
#include "host/gpio/host_lines.hpp"
#include "host/gpio/line_table.hpp"
#include "host/gpio/read_line_table.hpp"
#include "host/run/flash_file.hpp"
#include "host/usb/libusb_bus.hpp"
#include "host/usb/simulated_usb.hpp"

namespace lamplock::run {
namespace {

using flash::FlashProgress;

/// A simulated board: a chip with an empty flash.
class EmptyChip {
 public:
  EmptyChip() {
    chip_.power_on();
    bus_.sleep(start_time);
  }
  flash::UpdateSite site() { return {bus_, ports_}; }

 private:
  /// The ROM looks for a program for half a second (RP2040 datasheet, 2.8.1.3).
  static constexpr std::chrono::milliseconds start_time{700};
  sim::chip::Chip chip_;
  usb::SimulatedUsb bus_{chip_};
  flash::DirectPorts ports_{bus_};
};

/// The boards of this computer.
struct ThisComputer {
  usb::LibusbBus bus;
  flash::SystemPorts ports;
  flash::UpdateSite site(std::function<void()> pull_loader_lines) {
    return {bus, ports, flash::usual_drive_roots(), flash::write_through,
            std::move(pull_loader_lines)};
  }
};

/// A function that pulls the pins RUN and BOOTSEL of the board; empty without --lines. Throws
/// Error.
std::function<void()> loader_lines(const std::string& file) {
  if (file.empty()) return {};
  const gpio::LineTable table = gpio::read_line_table(file);
  gpio::expect_loader_lines(table);
  return [table] { gpio::enter_loader(*gpio::host_lines(), table, gpio::real_sleep); };
}

/// A progress for reading, one for writing.
class FlashProgressView {
 public:
  explicit FlashProgressView(Frontend& frontend) : frontend_(frontend) {}
  void update(const FlashProgress& progress) {
    if (!shown_ || progress.step != step_) {
      const bool reads = progress.step == FlashProgress::Step::reading;
      shown_.reset();
      shown_ = frontend_.progress(reads ? "reading" : "writing", progress.total, 0);
      step_ = progress.step;
    }
    shown_->update(progress.done);
  }
  void end() { shown_.reset(); }

 private:
  Frontend& frontend_;
  std::unique_ptr<Progress> shown_;
  FlashProgress::Step step_ = FlashProgress::Step::reading;
};

flash::UpdateReport flash_site(const flash::UpdateSite& site, const FlashFile& file,
                               const FlashOptions& options, Frontend& frontend) {
  FlashProgressView view(frontend);
  flash::UpdateEvents events;
  events.on_step = [&](const std::string& name, const std::string& what) {
    view.end();
    frontend.phase(name, what);
  };
  events.on_progress = [&](const FlashProgress& progress) { view.update(progress); };
  flash::Update update(site, file.image, std::move(events));
  flash::UpdateReport report = options.drive.empty() ? update.run(options.serial, file.board)
                                                     : update.run_on_drive(options.drive);
  if (!report.version_problem.empty())
    frontend.say("the image is on the board; its version was not read: {}", report.version_problem);
  return report;
}

}  // namespace

Flashed flash_board(const FlashOptions& options, Frontend& frontend) {
  const bool is_chip = options.board == "chip";
  const FlashFile file = read_flash_file(options.image, options.for_board);
  std::function<void()> pull = loader_lines(options.lines);
  frontend.phase("image",
                 fmt::format("{}, {} bytes{}", file.file, file.image.size,
                             file.board.empty() ? "" : fmt::format(", board {}", file.board)));
  if (is_chip) {
    EmptyChip chip;
    Flashed flashed{file.file, file.board, flash_site(chip.site(), file, options, frontend)};
    frontend.line("simulated board: changes are not kept");
    return flashed;
  }
  ThisComputer computer;
  return {file.file, file.board,
          flash_site(computer.site(std::move(pull)), file, options, frontend)};
}

}  // namespace lamplock::run
