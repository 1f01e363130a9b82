// `lamplock devices`: what is plugged in, and what is missing to use it.
#include <memory>
#include <nlohmann/json.hpp>

#include "host/cli/command_line.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/console.hpp"
#include "host/run/device_list.hpp"
#include "host/usb/libusb_bus.hpp"

namespace lamplock::cli {
namespace {

Json as_json(const run::DeviceRow& row) {
  const auto text = [](const std::string& value) { return value.empty() ? Json() : Json(value); };
  return {{"kind", row.kind},         {"name", row.name},
          {"board", text(row.board)}, {"serial", text(row.serial)},
          {"place", text(row.place)}, {"node", text(row.node)},
          {"use", text(row.use)},     {"problem", text(row.problem)}};
}

void say(Console& console, const run::DeviceRow& row) {
  const auto shown = [](const std::string& value) { return value.empty() ? "-" : value; };
  console.say("{:<12} {:<26} {:<18} {:<8} {:<15} {}", row.kind, row.name, shown(row.serial),
              shown(row.place), shown(row.node), row.use.empty() ? "not usable yet" : row.use);
  if (!row.problem.empty()) console.say("  {}", row.problem);
}

Exit list(bool json) {
  Console console(json);
  usb::LibusbBus bus;
  const std::vector<run::DeviceRow> rows = run::list_devices(bus);
  Json document = Json::array();
  for (const run::DeviceRow& row : rows) {
    if (!json) say(console, row);
    document.push_back(as_json(row));
  }
  if (rows.empty()) console.line("nothing that lamplock can use is plugged in");
  console.document(document);
  return Exit::done;
}

}  // namespace

void add_devices(Command& program) {
  Command& app = program.add_command(
      "devices", "List boards, boot loaders, pendants and GPIO chips of this computer");
  app.footer(
      "The list shows a remedy for each device that cannot be used (docs/devices.md).\n"
      "Example:\n"
      "  lamplock devices\n"
      "  lamplock devices --json");
  const auto json = std::make_shared<bool>(false);
  app.add_json(*json, "Print the list as JSON on stdout");
  app.action([json] { return list(*json); });
}

}  // namespace lamplock::cli
