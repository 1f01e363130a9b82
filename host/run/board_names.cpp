#include "host/run/board_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "host/error.hpp"
#include "host/run/board_port.hpp"
#include "host/run/simulated_boards.hpp"
#include "host/suggestion.hpp"
#include "sim/endpoint/tcp_address.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> fixed_names{virtual_board, chip_board, auto_board,
                                                      usb_board};

}  // namespace

std::string remedy_for_name(const std::string& name, const std::vector<std::string>& ports) {
  std::vector<std::string> known(fixed_names.begin(), fixed_names.end());
  for (const std::string& port : ports) known.push_back(fs::path(port).filename().string());
  std::vector<std::string> similar = similar_names(name, known);
  for (std::string& one : similar)  // a port is given with its folder
    for (const std::string& port : ports)
      if (fs::path(port).filename() == one) one = port;
  std::string remedy = question_of(similar);
  if (remedy.empty())
    remedy = fmt::format("give {}, HOST:PORT or a serial port", fmt::join(fixed_names, ", "));
  if (ports.empty()) return remedy + " (this computer has no serial port)";
  return fmt::format("{} (serial ports of this computer: {})", remedy, fmt::join(ports, ", "));
}

std::vector<std::string> serial_ports() {
  std::vector<std::string> ports;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("ttyACM") || name.starts_with("ttyUSB"))
      ports.push_back(entry.path().string());
  }
  std::sort(ports.begin(), ports.end());
  return ports;
}

void check_board_name(const std::string& name) {
  std::error_code ignored;
  if (std::find(fixed_names.begin(), fixed_names.end(), name) != fixed_names.end() ||
      usb_serial(name))
    return;
  if (fs::is_regular_file(name, ignored) || fs::is_directory(name, ignored))
    throw Error(Exit::bad_input, "--board",
                fmt::format("'{}' is a {}, not the port of a board", name,
                            fs::is_directory(name, ignored) ? "folder" : "file"),
                remedy_for_name("", serial_ports()));
  if (name.find('/') != std::string::npos || fs::exists(name, ignored)) return;
  if (sim::parse_tcp_address(name)) return;
  throw Error(Exit::bad_input, "--board", fmt::format("there is no board '{}'", name),
              remedy_for_name(name, serial_ports()));
}

}  // namespace lamplock::run
