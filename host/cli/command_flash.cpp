// `lamplock flash`: the firmware into a board.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/cli/validators.hpp"
#include "host/error.hpp"
#include "host/run/flash_board.hpp"
#include "host/run/image_path.hpp"

namespace lamplock::cli {
namespace {

struct FlashOptions : run::FlashOptions {
  bool json = false;
};

Json as_json(const run::Flashed& flashed) {
  const flash::UpdateReport& report = flashed.report;
  const auto text = [](const std::string& value) { return value.empty() ? Json() : Json(value); };
  Json document = {{"image", flashed.file},
                   {"board", text(flashed.board)},
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

void refuse_for_chip(const FlashOptions& options) {
  const auto refuse = [](const std::string& value, const char* name, const char* what) {
    if (!value.empty()) throw Error(Exit::bad_input, name, what, "see lamplock flash --help");
  };
  refuse(options.drive, "--drive", "a simulated board has no drive");
  refuse(options.lines, "--lines", "a simulated board has no lines of this computer");
}

Exit flash_board(const FlashOptions& options) {
  if (options.board == "chip") refuse_for_chip(options);
  Console console(options.json);
  const run::Flashed flashed = run::flash_board(options, console);
  console.document(as_json(flashed));
  return flashed.report.confirmed() ? Exit::done : Exit::job_failed;
}

}  // namespace

void add_flash(Command& program) {
  Command& app = program.add_command("flash", "Write the firmware to a board over USB");
  app.footer(
      "The board must run lamplock and be at rest, or be in its boot loader (hold BOOTSEL while\n"
      "plugging it in). Settings are kept. Only sectors that differ are written; they are read "
      "back.\n"
      "After an interruption the board starts in its boot loader: run the command again.\n"
      "With --lines, a board that does not answer or is not found on USB is reset into its boot\n"
      "loader through its pins RUN and BOOTSEL.\n"
      "Example:\n"
      "  lamplock flash --for pico\n"
      "  lamplock flash --for pico --serial E661640843322A2B\n"
      "  lamplock flash --for pico --lines examples/lines.toml\n"
      "  lamplock flash new.uf2 --drive /media/$USER/RPI-RP2\n"
      "  lamplock flash --for pico --board chip");
  const auto options = std::make_shared<FlashOptions>();
  const Option& image =
      app.add_option("IMAGE", &options->image, "UF2 or ELF file; without one --for names the board")
          .file(FileUse::read);
  app.add_option("--for", &options->for_board,
                 "Board whose image of this build is flashed; pico is a Raspberry Pi Pico wired "
                 "by hand. One of: " +
                     run::board_names())
      .value_name("BOARD")
      .excludes(image);
  const Option& serial =
      app.add_option("--serial", &options->serial,
                     "Flash the board with this serial number; lamplock devices shows it")
          .value_name("TEXT");
  const Option& drive =
      app.add_option(
             "--drive", &options->drive,
             "Copy the file to this drive of a boot loader (RPI-RP2), without access to USB")
          .value_name("DIR")
          .file(FileUse::folder)
          .excludes(serial);
  app.add_option(
         "--board", &options->board,
         "usb: a real board; chip: a simulated board with an empty flash, to try the command")
      .check(one_of({"usb", "chip"}))
      .value_name("usb|chip")
      .show_default();
  app.add_option("--lines", &options->lines,
                 "File (TOML) that assigns the board's pins RUN and BOOTSEL to GPIO lines of this "
                 "computer; see examples/lines.toml")
      .value_name("FILE")
      .file(FileUse::read)
      .excludes(drive);
  app.add_json(options->json);
  app.action([options] { return flash_board(*options); });
}

}  // namespace lamplock::cli
