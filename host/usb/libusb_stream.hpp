// A stream over two bulk endpoints through libusb.
//
// In:  an open device whose interface is claimed. Out: a Stream that keeps transfers queued.
// Who: libusb_bus.
//
// Several transfers wait for bytes of the device at any time, so that its packets never wait for
// this program; bytes to it go into a few transfers only, so that new bytes are sent soon. There is
// no thread: write(), read() and wait() process the transfers.
#pragma once

#include <libusb-1.0/libusb.h>

#include <cstdint>
#include <memory>

#include "host/usb/usb.hpp"

namespace lamplock::usb {

/// `context` and `handle` must outlive the stream. If transfers cannot be queued, alive() is false
/// from the start.
std::unique_ptr<Stream> make_libusb_stream(libusb_context* context, libusb_device_handle* handle,
                                           std::uint8_t out_endpoint, std::uint8_t in_endpoint);

}  // namespace lamplock::usb
