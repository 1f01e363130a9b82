// What is plugged into this computer that lamplock can use, and what is missing to use it.
//
// In:  a bus, /sys, the folder of device nodes. Out: rows. Who: `devices`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/usb/sysfs.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::run {

/// One thing.
struct DeviceRow {
  std::string kind;     ///< "board", "boot loader", "pendant", "GPIO"
  std::string name;     ///< what it is
  std::string serial;   ///< empty if it has none
  std::string place;    ///< on the bus; empty for GPIO
  std::string node;     ///< what to give to commands: /dev/ttyACM0; empty if there is none
  std::string use;      ///< what can be done with it as it is; empty: nothing yet
  std::string problem;  ///< what is missing, with the remedy; empty: nothing
  std::string board{};  ///< whose image it runs, as for flash --for; empty: unknown, or no board
};

/// Where to look; other folders in tests.
struct DevicePlaces {
  usb::Sysfs sysfs{};
  std::filesystem::path nodes = "/dev";
};

/// Boards, boot loaders, pendants, GPIO chips, in this order.
std::vector<DeviceRow> list_devices(usb::Bus& bus, const DevicePlaces& places = {});

}  // namespace lamplock::run
