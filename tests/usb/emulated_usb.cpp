#include "tests/usb/emulated_usb.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <string_view>

#include "firmware/boards/rp2040/usb/descriptors.hpp"

namespace lamplock::usb::test {
namespace {

constexpr std::chrono::milliseconds no_time{0};

std::string hex_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

/// As device descriptors have it, low byte first.
std::string hex_of(std::uint16_t value) {
  return fmt::format("{:02x}{:02x}", value & 0xff, value >> 8);
}

std::string path_of(const EmulatedDevice& device) {
  return "/devices/pci0000:00/0000:00:14.0/usb1/" + device.place;
}
std::string node_of(const EmulatedDevice& device) {
  return fmt::format("bus/usb/001/{:03}", device.address);
}

gboolean handle_call(UMockdevIoctlBase*, UMockdevIoctlClient* client, EmulatedUsb* usb) {
  return usb->call(client) ? TRUE : FALSE;
}

/// The kernel's status of a transfer (usb error codes of its documentation).
int status_of(TransferEnd end) {
  switch (end) {
    case TransferEnd::done:
      return 0;
    case TransferEnd::stalled:
      return -EPIPE;
    case TransferEnd::gone:
      return -ENODEV;
    case TransferEnd::overflow:
      return -EOVERFLOW;
    default:
      return -EIO;
  }
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
          "lamplock laser controller",
          "E661640843322A2B"};
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
  // So that a process without root's rights finds its way, and may listen for events there.
  ::chmod(real_path("").c_str(), 0777);
}

EmulatedUsb::~EmulatedUsb() {
  if (handler_ != nullptr) g_object_unref(handler_);
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

void EmulatedUsb::attach(const EmulatedDevice& device, flash::test::LoaderModel& model) {
  model_ = &model;
  handler_ = umockdev_ioctl_base_new();
  g_object_connect(handler_, "signal-after::handle-ioctl", handle_call, this, nullptr);
  GError* error = nullptr;
  if (umockdev_testbed_attach_ioctl(testbed_, ("/dev/" + node_of(device)).c_str(), handler_,
                                    &error) == 0)
    throw std::runtime_error(error->message);
}

/// A transfer is over at once, or waits until it is taken back.
void EmulatedUsb::submit(usbdevfs_urb& urb) {
  constexpr int setup_size = 8;
  auto* const bytes = static_cast<std::uint8_t*>(urb.buffer);
  Transfer moved;
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    const auto half = [&](int at) {
      return static_cast<std::uint16_t>(bytes[at] | bytes[at + 1] << 8);
    };
    moved = model_->control(
        {bytes[0], bytes[1], half(2), half(4)},
        {bytes + setup_size, static_cast<std::size_t>(urb.buffer_length - setup_size)}, no_time);
  } else {
    const std::span<std::uint8_t> data(bytes, static_cast<std::size_t>(urb.buffer_length));
    moved = (urb.endpoint & direction_in) != 0 ? model_->bulk_in(urb.endpoint, data, no_time)
                                               : model_->bulk_out(urb.endpoint, data, no_time);
  }
  urb.actual_length = static_cast<int>(moved.size);
  urb.status = status_of(moved.end);
  (moved.end == TransferEnd::timed_out ? waiting_ : done_).push_back(&urb);
}

bool EmulatedUsb::call(UMockdevIoctlClient* client) {
  // The caller is a thread of this process: its pointers are ours.
  void* const argument = *reinterpret_cast<void**>(umockdev_ioctl_client_get_arg(client)->data);
  const auto answer = [&](int error) {
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    return true;
  };
  switch (umockdev_ioctl_client_get_request(client)) {
    case USBDEVFS_GET_CAPABILITIES:
      *static_cast<std::uint32_t*>(argument) = USBDEVFS_CAP_BULK_CONTINUATION |
                                               USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                               USBDEVFS_CAP_ZERO_PACKET;
      return answer(0);
    case USBDEVFS_CLAIMINTERFACE:
      return answer(model_->claim(0) == TransferEnd::done ? 0 : EBUSY);
    case USBDEVFS_RELEASEINTERFACE:
      return answer(0);
    case USBDEVFS_CLEAR_HALT:
      model_->clear_halt(static_cast<std::uint8_t>(*static_cast<unsigned*>(argument)));
      return answer(0);
    case USBDEVFS_SUBMITURB:
      if (model_->gone()) return answer(ENODEV);
      submit(*static_cast<usbdevfs_urb*>(argument));
      return answer(0);
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      if (done_.empty()) return answer(EAGAIN);
      *static_cast<void**>(argument) = done_.front();
      done_.pop_front();
      return answer(0);
    case USBDEVFS_DISCARDURB: {
      const auto found = std::find(waiting_.begin(), waiting_.end(), argument);
      if (found == waiting_.end()) return answer(EINVAL);
      (*found)->status = -ENOENT;
      done_.push_back(*found);
      waiting_.erase(found);
      return answer(0);
    }
    default:
      return false;
  }
}

}  // namespace lamplock::usb::test
