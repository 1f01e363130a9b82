// `lamplock flash`: the firmware into a board.
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/flash_file.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/validators.hpp"
#include "host/flash/drive.hpp"
#include "host/flash/update.hpp"
#include "host/gpio/board_lines.hpp"
#include "host/gpio/host_lines.hpp"
#include "host/gpio/line_table.hpp"
#include "host/gpio/read_line_table.hpp"
#include "host/usb/libusb_bus.hpp"
#include "host/usb/simulated_usb.hpp"

namespace lamplock::cli {
namespace {

using flash::FlashProgress;

struct FlashOptions {
  std::string image, serial, drive, lines, board = "usb";
  bool json = false;
};

/// A board to flash that nobody has to own: a chip with nothing in its flash.
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

/// What pulls the pins RUN and BOOTSEL of the board; nothing without --lines. Throws Error.
std::function<void()> loader_lines(const std::string& file) {
  if (file.empty()) return {};
  const gpio::LineTable table = gpio::read_line_table(file);
  gpio::expect_loader_lines(table);
  return [table] { gpio::enter_loader(*gpio::host_lines(), table, gpio::real_sleep); };
}

/// A bar for reading, one for writing.
class FlashBar {
 public:
  void update(const FlashProgress& progress) {
    if (!bar_ || progress.step != step_) {
      const char* const title =
          progress.step == FlashProgress::Step::reading ? "reading" : "writing";
      bar_.reset();
      bar_ = std::make_unique<Progress>(title, progress.total);
      step_ = progress.step;
    }
    bar_->update(progress.done);
  }
  void end() { bar_.reset(); }

 private:
  std::unique_ptr<Progress> bar_;
  FlashProgress::Step step_ = FlashProgress::Step::reading;
};

Json as_json(const flash::UpdateReport& report, const std::string& image) {
  const auto text = [](const std::string& value) { return value.empty() ? Json() : Json(value); };
  Json document = {{"image", image},
                   {"way", report.drive ? "drive" : "usb"},
                   {"sectors", nullptr},
                   {"written", nullptr},
                   {"drive", nullptr},
                   {"serial", text(report.board.serial)},
                   {"port", text(report.port)},
                   {"version_before", text(report.version_before)},
                   {"version", text(report.version)},
                   {"version_problem", text(report.version_problem)}};
  if (report.drive) document["drive"] = report.drive->string();
  if (!report.flash) return document;
  document["sectors"] = report.flash->sectors;
  document["written"] = report.flash->written;
  return document;
}

Exit flash_site(const flash::UpdateSite& site, const FlashFile& file, const FlashOptions& options,
                Console& console) {
  FlashBar bar;
  flash::UpdateEvents events;
  events.on_step = [&](const std::string& name, const std::string& what) {
    bar.end();
    console.phase(name, what);
  };
  events.on_progress = [&](const FlashProgress& progress) { bar.update(progress); };
  flash::Update update(site, file.image, std::move(events));
  const flash::UpdateReport report =
      options.drive.empty() ? update.run(options.serial) : update.run_on_drive(options.drive);
  if (!report.version_problem.empty())
    console.say("the image is on the board; its version was not read: {}", report.version_problem);
  console.document(as_json(report, file.file));
  return report.confirmed() ? Exit::done : Exit::job_failed;
}

Exit flash_board(const FlashOptions& options) {
  Console console(options.json);
  const FlashFile file = read_flash_file(options.image);
  std::function<void()> pull = loader_lines(options.lines);
  console.phase("image", fmt::format("{}, {} bytes", file.file, file.image.size));
  if (options.board == "chip") {
    EmptyChip chip;
    const Exit exit = flash_site(chip.site(), file, options, console);
    console.line("a simulated board forgets this now");
    return exit;
  }
  ThisComputer computer;
  return flash_site(computer.site(std::move(pull)), file, options, console);
}

}  // namespace

void add_flash(Command& program) {
  Command& app = program.add_command("flash", "The firmware into a board, over USB");
  app.footer(
      "Takes a board that runs lamplock and is at rest, or one in its boot loader (BOOTSEL held\n"
      "while plugging in). Settings stay. What differs is written and read back; if anything cuts\n"
      "in, the board comes up in its boot loader and the command is given again.\n"
      "With --lines a board that is silent or on no bus is reset into its boot loader by its "
      "pins.\n"
      "Example:\n  lamplock flash\n  lamplock flash --serial E661640843322A2B\n"
      "  lamplock flash --lines examples/lines.toml\n"
      "  lamplock flash new.uf2 --drive /media/$USER/RPI-RP2\n  lamplock flash --board chip");
  const auto options = std::make_shared<FlashOptions>();
  app.add_option("IMAGE", &options->image,
                 "UF2 or ELF file; without it lamplock-rp2040.uf2 that came with the program");
  const Option& serial =
      app.add_option("--serial", &options->serial, "The board with this serial number: see devices")
          .value_name("TEXT");
  const Option& drive = app.add_option("--drive", &options->drive,
                                       "Copy to this drive of a boot loader, without access to USB")
                            .value_name("FOLDER")
                            .excludes(serial);
  app.add_option("--board", &options->board,
                 "usb: a real one; chip: a simulated one with an empty flash, to see it done")
      .check(one_of({"usb", "chip"}))
      .value_name("usb|chip")
      .show_default();
  app.add_option("--lines", &options->lines,
                 "Lines of this computer at the board's pins RUN and BOOTSEL (TOML), see "
                 "examples/lines.toml")
      .value_name("FILE")
      .excludes(drive);
  app.add_json(options->json);
  app.action([options] {
    const auto refuse = [&options](const std::string& value, const char* name, const char* what) {
      if (options->board == "chip" && !value.empty())
        throw Error(Exit::bad_input, name, what, "see lamplock flash --help");
    };
    refuse(options->drive, "--drive", "a simulated board has no drive");
    refuse(options->lines, "--lines", "a simulated board has no lines of this computer");
    return flash_board(*options);
  });
}

}  // namespace lamplock::cli
