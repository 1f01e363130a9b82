// A loader model that answers the kernel's calls: its transfers end at once, or wait until they are
// cancelled.
//
// In:  ioctls of a device node. Out: transfers of the model. Who: tests of flashing over libusb.
#pragma once

#include <linux/usbdevice_fs.h>

#include <deque>

#include "tests/flash/loader_model.hpp"
#include "tests/usb/emulated_usb.hpp"

namespace lamplock::usb::test {

class LoaderCalls final : public CallHandler {
 public:
  /// The model must outlive it.
  explicit LoaderCalls(flash::test::LoaderModel& model) : model_(model) {}

  std::optional<int> call(unsigned long request, void* argument) override;

 private:
  void submit(usbdevfs_urb& urb);

  flash::test::LoaderModel& model_;
  std::deque<usbdevfs_urb*> done_, waiting_;
};

}  // namespace lamplock::usb::test
