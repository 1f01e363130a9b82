// A stream over two bulk endpoints through libusb.
//
// In:  an open device whose interface is claimed. Out: a Stream that keeps transfers queued.
// Who: libusb_bus.
//
// Several transfers wait for bytes of the device at any time, so that none of its packets waits for
// this program; bytes to it go into a few transfers, so that what is written next is never far
// behind. There is no thread: transfers are looked after in write(), read() and wait().
#pragma once

#include <libusb-1.0/libusb.h>

#include <cstdint>
#include <memory>

#include "host/usb/usb.hpp"

namespace lamplock::usb {

/// `context` and `handle` must outlive the stream. If transfers cannot be queued the stream is not
/// alive from the start.
std::unique_ptr<Stream> make_libusb_stream(libusb_context* context, libusb_device_handle* handle,
                                           std::uint8_t out_endpoint, std::uint8_t in_endpoint);

}  // namespace lamplock::usb
