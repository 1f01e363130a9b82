// A stream over two bulk endpoints through libusb.
//
// In:  an open device. Out: a Stream that keeps transfers queued. Who: libusb_bus.
#pragma once

#include <libusb-1.0/libusb.h>

#include <cstdint>
#include <memory>

#include "host/error.hpp"
#include "host/usb/usb.hpp"

namespace lamplock::usb {

/// `context` and `handle` must outlive the stream, the interface of the endpoints is claimed.
inline std::unique_ptr<Stream> make_libusb_stream(libusb_context* /*context*/,
                                                  libusb_device_handle* /*handle*/,
                                                  std::uint8_t /*out*/, std::uint8_t /*in*/) {
  throw Error(Exit::no_device, "USB", "streams are not there yet", "use the serial port");
}

}  // namespace lamplock::usb
