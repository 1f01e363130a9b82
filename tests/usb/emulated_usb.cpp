#include "tests/usb/emulated_usb.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <umockdev.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string_view>

#include "firmware/boards/rp2040/usb/descriptors.hpp"

namespace lamplock::usb::test {
namespace {

std::string hex_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

/// Hexadecimal as in device descriptors, low byte first.
std::string hex_of(std::uint16_t value) {
  return fmt::format("{:02x}{:02x}", value & 0xff, value >> 8);
}

std::string path_of(const EmulatedDevice& device) {
  return "/devices/pci0000:00/0000:00:14.0/usb1/" + device.place;
}
std::string node_of(const EmulatedDevice& device) {
  return fmt::format("bus/usb/001/{:03}", device.address);
}

gboolean handle_call(UMockdevIoctlBase*, UMockdevIoctlClient* client, CallHandler* handler) {
  // The caller is a thread of this process, so its pointers are valid here.
  void* const argument = *reinterpret_cast<void**>(umockdev_ioctl_client_get_arg(client)->data);
  const auto error = handler->call(umockdev_ioctl_client_get_request(client), argument);
  if (!error) return FALSE;
  umockdev_ioctl_client_complete(client, *error == 0 ? 0 : -1, *error);
  return TRUE;
}

}  // namespace

bool can_be_emulated() {
  const char* const preloaded = std::getenv("LD_PRELOAD");
  return preloaded != nullptr && std::string_view(preloaded).find("umockdev") != std::string::npos;
}

EmulatedDevice emulated_loader() {
  return {"1-4",
          5,
          "12011001000000408a2e03000001010203"
          "01"
          "0902370002010080fa"
          "0904000002080650000705810240000007050202400000"
          "0904010002ff0000000705030240000007058402400000",
          "Raspberry Pi",
          "RP2 Boot",
          "E0C9125B0D9B"};
}

EmulatedDevice emulated_board() {
  namespace board = rp2040::usb;
  return {"1-2",
          6,
          hex_of(board::device_descriptor) + hex_of(board::configuration_descriptor),
          "lamplock",
          "lamplock picobob",
          "E661640843322A2B"};
}

EmulatedDevice emulated_old_board() {
  namespace board = rp2040::usb;
  constexpr std::size_t stream_size = 9 + 7 + 7;  // the interface is the last, with two endpoints
  constexpr std::size_t size = board::configuration_size - stream_size;
  std::array<std::uint8_t, size> configuration{};
  std::copy_n(board::configuration_descriptor.begin(), size, configuration.begin());
  configuration[2] = board::low_byte(size);
  configuration[3] = board::high_byte(size);
  configuration[4] = board::stream_interface;  // the number of interfaces before it
  EmulatedDevice old = emulated_board();
  old.descriptors = hex_of(board::device_descriptor) + hex_of(configuration);
  return old;
}

EmulatedDevice emulated_pendant(std::uint16_t vendor, std::uint16_t product) {
  return {"1-1",
          7,
          "1201100100000008" + hex_of(vendor) + hex_of(product) +
              "000100000001"
              "0902220001010080320904000001030000000921100100012216000705810308000a",
          "",
          "pendant",
          ""};
}

EmulatedUsb::EmulatedUsb() : testbed_(umockdev_testbed_new()) {
  // Lets a process without root's rights reach the nodes and listen for events there.
  for (const char* const path : {"", "/ioctl", "/ioctl/_default"})
    ::chmod(real_path(path).c_str(), 0777);
}

EmulatedUsb::~EmulatedUsb() {
  for (UMockdevIoctlBase* const handler : handlers_) g_object_unref(handler);
  g_object_unref(testbed_);
}

std::string EmulatedUsb::real_path(const std::string& path) const {
  gchar* const root = umockdev_testbed_get_root_dir(testbed_);
  std::string real = root + path;
  g_free(root);
  return real;
}

void EmulatedUsb::add(const EmulatedDevice& device) {
  std::string text = fmt::format(
      "P: {0}\nN: {1}\nE: SUBSYSTEM=usb\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM={2:03}\n"
      "E: DEVNAME=/dev/{1}\nE: DEVTYPE=usb_device\nA: busnum=1\\n\nA: devnum={2}\\n\n"
      "A: bConfigurationValue=1\\n\nA: speed=12\\n\n",
      path_of(device), node_of(device), device.address);
  for (const auto& [name, value] : {std::pair{"manufacturer", device.manufacturer},
                                    {"product", device.product},
                                    {"serial", device.serial}})
    if (!value.empty()) text += fmt::format("A: {}={}\\n\n", name, value);
  text += fmt::format("H: descriptors={}\n", device.descriptors);
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed_, text.c_str(), &error) == 0)
    throw std::runtime_error(error->message);
}

void EmulatedUsb::add_below(const EmulatedDevice& device, unsigned interface,
                            const std::string& subsystem, const std::string& path,
                            const std::string& node) {
  const std::string text =
      fmt::format("P: {}/{}:1.{}/{}\nN: {}\nE: SUBSYSTEM={}\nE: DEVNAME=/dev/{}\n", path_of(device),
                  device.place, interface, path, node, subsystem, node);
  GError* error = nullptr;
  if (umockdev_testbed_add_from_string(testbed_, text.c_str(), &error) == 0)
    throw std::runtime_error(error->message);
}

void EmulatedUsb::remove(const EmulatedDevice& device) {
  umockdev_testbed_remove_device(testbed_, ("/sys" + path_of(device)).c_str());
}

void EmulatedUsb::attach(const EmulatedDevice& device, CallHandler& handler) {
  handlers_.push_back(umockdev_ioctl_base_new());
  g_object_connect(handlers_.back(), "signal-after::handle-ioctl", handle_call, &handler, nullptr);
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(testbed_, ("/dev/" + node_of(device)).c_str(), handlers_.back(),
                                    &error) == 0)
    throw std::runtime_error(error->message);
}

void EmulatedUsb::set_node(const EmulatedDevice& device, const std::string& file) {
  const std::filesystem::path node = real_path("/dev/" + node_of(device));
  std::filesystem::remove(node);
  std::filesystem::create_symlink(file, node);
}

}  // namespace lamplock::usb::test
