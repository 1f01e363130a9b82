// An emulated pendant for programs that search for one by libudev and hidapi: sysfs, a node whose
// other end belongs to the test, and the ioctls of hidraw (umockdev).
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <termios.h>
#include <umockdev-1.0/umockdev.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <string>
#include <vector>

#include "host/pendant/display.hpp"

namespace lamplock::pendant {

inline constexpr const char* umockdev_library = "libumockdev-preload.so.0";

/// umockdev must be loaded before the C library: the first call in a process runs the test again
/// with it, reports its result and returns false; in that second run it returns true.
inline bool inside_umockdev() {
  constexpr const char* mark = "LAMPLOCK_INSIDE_UMOCKDEV";
  if (std::getenv(mark) != nullptr) return true;
  const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
  const std::string filter =
      std::string("--gtest_filter=") + info->test_suite_name() + "." + info->name();
  const pid_t child = ::fork();
  if (child == 0) {
    ::setenv(mark, "1", 1);
    ::setenv("LD_PRELOAD", umockdev_library, 1);
    ::setenv("ASAN_OPTIONS", "detect_leaks=0:verify_asan_link_order=0", 1);
    ::execl("/proc/self/exe", "test_pendant", filter.c_str(), nullptr);
    ::_exit(127);
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "the same test inside umockdev";
  return false;
}

/// The node of a pendant.
enum class Node : std::uint8_t {
  open,   ///< the pendant
  locked  ///< a node that no user may open
};

/// The machine's USB, with one pendant plugged in.
class HidBench {
 public:
  HidBench(const char* vendor, const char* product, Node at_node = Node::open)
      : testbed_(umockdev_testbed_new()) {
    const std::string hid = std::string("0003:") + vendor + ":" + product + ".0001";
    const std::string usb = "/devices/pci0000:00/usb1/1-2", interface = usb + "/1-2:1.0",
                      device = interface + "/" + hid, raw = device + "/hidraw/hidraw0";
    add("P: " + usb + "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=" + vendor +
        "\\n\nA: idProduct=" + product + "\\n\nA: bcdDevice=0100\\n\n");
    add("P: " + interface +
        "\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=00\\n\n");
    add("P: " + device + "\nE: SUBSYSTEM=hid\nE: HID_ID=0003:0000" + vendor + ":0000" + product +
        "\nE: HID_NAME=pendant\nE: HID_UNIQ=\n");
    add("P: " + raw +
        "\nN: hidraw0\nE: SUBSYSTEM=hidraw\nE: DEVNAME=/dev/hidraw0\nE: MAJOR=240\n"
        "E: MINOR=0\nA: dev=240:0\\n\n");
    gchar* const root = umockdev_testbed_get_root_dir(testbed_);
    root_ = root;
    g_free(root);
    if (at_node == Node::locked) {
      // umockdev itself needs access to these files for every user.
      std::filesystem::permissions(root_, std::filesystem::perms::all);
      for (const auto& file : std::filesystem::recursive_directory_iterator(root_))
        if (!file.is_symlink())
          std::filesystem::permissions(file.path(), std::filesystem::perms::all);
      std::filesystem::permissions(node_file(), std::filesystem::perms::none);
      return;
    }
    connect_node();
    answer_ioctls();
  }
  ~HidBench() {
    unplug();
    if (handler_ != nullptr) {
      umockdev_testbed_detach_ioctl(testbed_, node, nullptr);
      g_object_unref(handler_);
    }
    g_object_unref(testbed_);
  }
  HidBench(const HidBench&) = delete;
  HidBench& operator=(const HidBench&) = delete;

  static constexpr const char* node = "/dev/hidraw0";
  std::filesystem::path node_file() const { return root_ + node; }
  void send(const std::vector<std::uint8_t>& report) const {
    ASSERT_EQ(::write(master_, report.data(), report.size()), static_cast<ssize_t>(report.size()));
  }
  /// Simulates unplugging the receiver.
  void unplug() {
    if (master_ >= 0) ::close(master_);
    master_ = -1;
  }
  /// Reports that were sent to its display.
  std::vector<FeatureReport> shown() {
    const std::lock_guard lock(mutex_);
    return shown_;
  }

 private:
  void add(const std::string& text) {
    GError* error = nullptr;
    ASSERT_TRUE(umockdev_testbed_add_from_string(testbed_, text.c_str(), &error))
        << error->message << "\n"
        << text;
  }
  void connect_node() {
    termios raw{};
    ::cfmakeraw(&raw);
    std::array<char, 256> name{};
    int slave = -1;
    ASSERT_EQ(::openpty(&master_, &slave, name.data(), &raw, nullptr), 0);
    ::close(slave);
    // A child program must not keep this end open.
    ASSERT_EQ(::fcntl(master_, F_SETFD, FD_CLOEXEC), 0);
    std::filesystem::remove(node_file());
    std::filesystem::create_symlink(name.data(), node_file());
  }
  void answer_ioctls() {
    handler_ = umockdev_ioctl_base_new();
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&HidBench::on_ioctl), this);
    GError* error = nullptr;
    ASSERT_TRUE(umockdev_testbed_attach_ioctl(testbed_, node, handler_, &error)) << error->message;
  }
  /// linux/hidraw.h: HIDIOCGRDESCSIZE is _IOR('H', 1, int), HIDIOCSFEATURE(n) _IOWR('H', 6, n).
  static gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, HidBench* self) {
    const auto request = umockdev_ioctl_client_get_request(client);
    const auto number = request & 0xffff;
    const auto size = request >> 16 & 0x3fff;
    constexpr gulong size_of_descriptor = 'H' << 8 | 0x01, set_feature = 'H' << 8 | 0x06;
    if (number != size_of_descriptor && number != set_feature) return 0;
    UMockdevIoctlData* const data =
        umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, size, nullptr);
    if (number == size_of_descriptor) {
      std::array<guint8, sizeof(int)> bytes{52};
      umockdev_ioctl_data_update(data, 0, bytes.data(), bytes.size());
      umockdev_ioctl_client_complete(client, 0, 0);
    } else {
      self->keep(*data);
      umockdev_ioctl_client_complete(client, static_cast<glong>(size), 0);
    }
    umockdev_ioctl_data_unref(data);
    return 1;
  }
  void keep(const UMockdevIoctlData& data) {
    FeatureReport report{};
    std::memcpy(report.data(), data.data,
                std::min(report.size(), static_cast<std::size_t>(data.data_len)));
    const std::lock_guard lock(mutex_);
    shown_.push_back(report);
  }

  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* handler_ = nullptr;
  std::string root_;
  int master_ = -1;
  std::mutex mutex_;
  std::vector<FeatureReport> shown_;
};

}  // namespace lamplock::pendant
