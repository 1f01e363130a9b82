#include "host/pendant/hid.hpp"

#include <fmt/format.h>
#include <hidapi/hidapi.h>

#include <algorithm>

#include "host/access.hpp"
#include "host/error.hpp"

namespace lamplock::pendant {
namespace {

struct CloseDevice {
  void operator()(hid_device* device) const { ::hid_close(device); }
};
using Handle = std::unique_ptr<hid_device, CloseDevice>;

class HidapiDevice final : public HidDevice {
 public:
  explicit HidapiDevice(Handle handle) : handle_(std::move(handle)) {}

  std::size_t read(std::span<std::uint8_t> report, std::chrono::milliseconds wait) override {
    if (!handle_) return 0;
    // A signal during the wait counts as the loss of the device, which is safe.
    const int count = ::hid_read_timeout(handle_.get(), report.data(), report.size(),
                                         static_cast<int>(wait.count()));
    if (count < 0) handle_.reset();
    return count < 0 ? 0 : static_cast<std::size_t>(count);
  }
  bool send_feature(std::span<const std::uint8_t> report) override {
    return handle_ && ::hid_send_feature_report(handle_.get(), report.data(), report.size()) >= 0;
  }
  bool gone() const override { return !handle_; }

 private:
  Handle handle_;
};

}  // namespace

std::vector<HidInfo> list_pendants() {
  std::vector<HidInfo> found;
  hid_device_info* const all = ::hid_enumerate(0, 0);
  for (const hid_device_info* device = all; device != nullptr; device = device->next)
    if (const PendantId* id = find_pendant(device->vendor_id, device->product_id))
      found.push_back({id, device->path});
  ::hid_free_enumeration(all);
  std::sort(found.begin(), found.end(),
            [](const HidInfo& a, const HidInfo& b) { return a.path < b.path; });
  // hidapi lists a node once for each usage in its descriptor.
  found.erase(std::unique(found.begin(), found.end(),
                          [](const HidInfo& a, const HidInfo& b) { return a.path == b.path; }),
              found.end());
  return found;
}

std::unique_ptr<HidDevice> open_pendant(const HidInfo& info) {
  const std::string where = fmt::format("{} at {}", info.id->name, info.path);
  // hidapi does not report why it cannot open a node.
  if (const AccessProblem problem = access_problem(info.path))
    throw Error(Exit::no_device, where, problem.what, problem.remedy);
  Handle handle(::hid_open_path(info.path.c_str()));
  if (!handle) throw Error(Exit::no_device, where, "cannot be opened", "plug it in again");
  return std::make_unique<HidapiDevice>(std::move(handle));
}

}  // namespace lamplock::pendant
