#include "host/run/device_list.hpp"

#include <algorithm>
#include <system_error>

#include "host/access.hpp"
#include "host/link/usb_transport.hpp"
#include "host/usb/known_devices.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;
using usb::DeviceInfo;
using usb::Kind;

void add(std::string& list, const char* separator, const std::string& more) {
  if (!list.empty() && !more.empty()) list += separator;
  list += more;
}

/// Two ways lead to a board, each with a driver or permission of its own; one is enough.
DeviceRow board_row(const DeviceInfo& device, const usb::Sysfs& sysfs) {
  DeviceRow row{"board", device.name, device.serial, device.place, "", "", ""};
  if (const boards::BoardRow* board = usb::board_of(device)) row.board = board->name;
  if (link::stream_interface(device)) {
    if (device.problem.empty()) row.use = "--board usb:" + device.serial;
    row.problem = device.problem;
  }
  const std::vector<std::string> ports = sysfs.serial_ports(device.place);
  if (ports.empty()) {
    add(row.problem, "; ",
        "the system has made no serial port for it, which lamplock flash and other programs need; "
        "load the kernel's driver: sudo modprobe cdc_acm");
    return row;
  }
  row.node = ports.front();
  const AccessProblem problem = access_problem(row.node);
  if (!problem) add(row.use, ", ", "--board " + row.node + ", lamplock flash");
  add(row.problem, "; ", problem.text());
  return row;
}

DeviceRow loader_row(const DeviceInfo& device) {
  return {"boot loader",
          std::string(usb::known_device(device).name),
          device.serial,
          device.place,
          "",
          device.problem.empty() ? "lamplock flash" : "",
          device.problem};
}

DeviceRow pendant_row(const DeviceInfo& device, const usb::Sysfs& sysfs) {
  DeviceRow row{
      "pendant", std::string(usb::known_device(device).name), device.serial, device.place, "", "",
      ""};
  const std::vector<std::string> nodes = sysfs.hid_nodes(device.place);
  if (nodes.empty()) {
    row.problem = "the system has made no hidraw node for it; check that the kernel has hidraw";
    return row;
  }
  row.node = nodes.front();
  row.problem = access_problem(row.node).text();
  if (row.problem.empty()) row.use = "lamplock jog";
  return row;
}

/// "/dev/gpiochip0" and the like, by name.
std::vector<DeviceRow> gpio_rows(const fs::path& nodes) {
  std::vector<DeviceRow> rows;
  std::error_code failure;
  for (fs::directory_iterator at(nodes, failure), end; !failure && at != end;
       at.increment(failure)) {
    const std::string name = at->path().filename().string();
    if (!name.starts_with("gpiochip")) continue;
    const std::string problem = access_problem(at->path()).text();
    rows.push_back({"GPIO", name, "", "", at->path().string(),
                    problem.empty() ? "inputs and outputs of this computer" : "", problem});
  }
  std::sort(rows.begin(), rows.end(),
            [](const DeviceRow& a, const DeviceRow& b) { return a.node < b.node; });
  return rows;
}

}  // namespace

std::vector<DeviceRow> list_devices(usb::Bus& bus, const DevicePlaces& places) {
  std::vector<DeviceRow> boards, loaders, pendants;
  for (const DeviceInfo& device : bus.devices()) {
    const Kind kind = usb::known_device(device).kind;
    if (kind == Kind::board) boards.push_back(board_row(device, places.sysfs));
    if (kind == Kind::boot_loader) loaders.push_back(loader_row(device));
    if (kind == Kind::pendant) pendants.push_back(pendant_row(device, places.sysfs));
  }
  std::vector<DeviceRow> rows = std::move(boards);
  for (const auto& more : {loaders, pendants, gpio_rows(places.nodes)})
    rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

}  // namespace lamplock::run
