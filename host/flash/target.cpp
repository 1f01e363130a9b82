#include "host/flash/target.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/error.hpp"

namespace lamplock::flash {
namespace {

using usb::DeviceInfo;
using usb::Kind;

bool can_be_flashed(const DeviceInfo& device) {
  const Kind kind = usb::known_device(device).kind;
  return kind == Kind::board || kind == Kind::boot_loader;
}

std::string list_of(const std::vector<DeviceInfo>& devices) {
  std::string text;
  for (const DeviceInfo& device : devices) text += (text.empty() ? "" : ", ") + name_of(device);
  return text;
}

}  // namespace

std::string name_of(const DeviceInfo& device) {
  const std::string serial = device.serial.empty() ? "" : " " + device.serial;
  return fmt::format("{}{} (USB {})", usb::known_device(device).name, serial, device.place);
}

std::vector<DeviceInfo> flashable(usb::Bus& bus) {
  std::vector<DeviceInfo> there;
  for (const DeviceInfo& device : bus.devices())
    if (can_be_flashed(device)) there.push_back(device);
  return there;
}

DeviceInfo find_target(usb::Bus& bus, const std::string& serial) {
  const std::vector<DeviceInfo> there = flashable(bus);
  std::vector<DeviceInfo> meant = there;
  if (!serial.empty())
    meant.erase(std::remove_if(meant.begin(), meant.end(),
                               [&](const DeviceInfo& d) { return d.serial != serial; }),
                meant.end());
  if (meant.size() == 1) return meant.front();
  if (meant.size() > 1)
    throw Error(Exit::bad_input, "flash", "several boards are plugged in: " + list_of(meant),
                serial.empty() ? "choose one with --serial" : "unplug all but one");
  if (!there.empty())
    throw Error(Exit::no_device, "--serial " + serial,
                "no board has this serial number; connected: " + list_of(there),
                "give one of these, or leave --serial out");
  throw Error(Exit::no_device, "flash", "no board is plugged in",
              "plug it in, a board without a program with BOOTSEL held; lamplock devices lists it");
}

std::optional<DeviceInfo> find_at(usb::Bus& bus, Kind kind, const std::string& place) {
  for (const DeviceInfo& device : bus.devices())
    if (device.place == place && usb::known_device(device).kind == kind) return device;
  return std::nullopt;
}

}  // namespace lamplock::flash
