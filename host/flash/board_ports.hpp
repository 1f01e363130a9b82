// Ports of running boards, found by their place on the bus.
//
// In:  a board. Out: its port's name, an open transport. Who: Update, the list of devices.
#pragma once

#include <memory>
#include <string>

#include "host/link/transport.hpp"
#include "host/usb/sysfs.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::flash {

class BoardPorts {
 public:
  virtual ~BoardPorts() = default;
  /// Empty until a driver has made one.
  virtual std::string name(const usb::DeviceInfo& board) = 0;
  /// Throws Error(no_device), with the remedy, if there is none or it may not be opened.
  virtual std::unique_ptr<link::Transport> open(const usb::DeviceInfo& board) = 0;
};

/// Serial ports of this computer: /dev/ttyACM*.
class SystemPorts final : public BoardPorts {
 public:
  SystemPorts() = default;
  explicit SystemPorts(usb::Sysfs sysfs) : sysfs_(std::move(sysfs)) {}
  std::string name(const usb::DeviceInfo& board) override;
  std::unique_ptr<link::Transport> open(const usb::DeviceInfo& board) override;

 private:
  usb::Sysfs sysfs_;
};

/// Ports without drivers: endpoints of the bus itself, which must outlive the ports.
class DirectPorts final : public BoardPorts {
 public:
  explicit DirectPorts(usb::Bus& bus) : bus_(bus) {}
  std::string name(const usb::DeviceInfo& board) override;
  std::unique_ptr<link::Transport> open(const usb::DeviceInfo& board) override;

 private:
  usb::Bus& bus_;
};

}  // namespace lamplock::flash
