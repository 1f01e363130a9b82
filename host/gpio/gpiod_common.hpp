// Common code for libgpiod 1.x and 2.x: opens chips, finds lines, names users.
//
// In:  files of chips, names of lines. Out: open chips; texts. Who: gpiod_v1.cpp or gpiod_v2.cpp; a
//      build has one of them.
#pragma once

#include <gpiod.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/gpio/line_address.hpp"
#include "host/gpio/lines.hpp"

namespace lamplock::gpio {

/// User of a line as other programs see it.
inline constexpr const char* consumer = "lamplock";
/// Events that the kernel queues for a line (drivers/gpio/gpiolib-cdev.c).
inline constexpr unsigned kept_events = 16;

struct CloseChip {
  void operator()(gpiod_chip* chip) const { ::gpiod_chip_close(chip); }
};
using Chip = std::unique_ptr<gpiod_chip, CloseChip>;

/// Null if the chip cannot be opened, with errno.
inline Chip open_chip(const std::string& file) { return Chip(::gpiod_chip_open(file.c_str())); }

/// Result of `find` on the first chip where it finds the line. Throws no_line_error().
template <class Find>
auto find_on_chips(const std::string& name, const Find& find) {
  std::string closed;
  for (const std::string& file : chip_files()) {
    Chip chip = open_chip(file);
    if (!chip) {
      closed = file;
    } else if (auto found = find(std::move(chip))) {
      return std::move(*found);
    }
  }
  throw no_line_error(name, closed);
}

inline std::string text_of(const char* text) { return text == nullptr ? "" : text; }

/// The user of a line. Drivers of the kernel may have no name.
inline std::string user_of(const char* name, bool used) {
  const std::string user = text_of(name);
  return used && user.empty() ? "kernel" : user;
}

/// All chips, each described by `info_of` from its file.
template <class InfoOf>
std::vector<ChipInfo> all_chips(const InfoOf& info_of) {
  std::vector<ChipInfo> all;
  for (const std::string& file : chip_files()) all.push_back(info_of(file));
  return all;
}

}  // namespace lamplock::gpio
