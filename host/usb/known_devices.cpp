#include "host/usb/known_devices.hpp"

#include <algorithm>
#include <array>

#include "shared/boards/all_boards.hpp"
#include "shared/boards/usb_ids.hpp"

namespace lamplock::usb {
namespace {

struct Row {
  std::uint16_t vendor, product;
  KnownDevice device;
};

/// Sources: RP2040 datasheet, 2.8.5.1; for pendants the numbers that the devices report.
constexpr std::array<Row, 5> rows = {{
    {0x2e8a, 0x0003, {Kind::boot_loader, "RP2040 boot loader"}},
    {0x10ce, 0xeb70, {Kind::pendant, "XHC HB04"}},
    {0x10ce, 0xeb93, {Kind::pendant, "XHC WHB04B"}},
    {0x0b33, 0x0020, {Kind::pendant, "Contour ShuttleXpress"}},
    {0x0b33, 0x0030, {Kind::pendant, "Contour ShuttlePro v2"}},
}};

}  // namespace

KnownDevice known_device(const DeviceInfo& device) {
  if (device.vendor == boards::usb_vendor_id && device.product == boards::usb_product_id &&
      device.manufacturer == board_manufacturer)
    return {Kind::board, "lamplock board"};
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
    return row.vendor == device.vendor && row.product == device.product;
  });
  return found == rows.end() ? KnownDevice{} : found->device;
}

const boards::BoardRow* board_of(const DeviceInfo& device) {
  const std::string_view name = device.name;
  if (known_device(device).kind != Kind::board || !name.starts_with(boards::usb_product_prefix))
    return nullptr;
  return boards::find_board(name.substr(boards::usb_product_prefix.size()));
}

}  // namespace lamplock::usb
