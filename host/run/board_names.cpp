#include "host/run/board_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>
#include <system_error>
#include <utility>

#include "host/error.hpp"
#include "host/run/board_port.hpp"
#include "host/run/simulated_boards.hpp"
#include "sim/endpoint/tcp_address.hpp"

namespace lamplock::run {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 4> names{virtual_board, chip_board, auto_board, usb_board};
/// More letters off is another word, not a slip.
constexpr std::size_t max_letters_apart = 2;

}  // namespace

// Levenshtein's distance, a row of the table at a time.
std::size_t letters_apart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

std::string remedy_for_name(const std::string& name, const std::vector<std::string>& ports) {
  std::string remedy;
  for (const std::string_view known : names)
    if (letters_apart(name, known) <= max_letters_apart)
      remedy += fmt::format("{}'{}'", remedy.empty() ? "did you mean " : " or ", known);
  remedy += remedy.empty()
                ? fmt::format("give {}, HOST:PORT or a serial port", fmt::join(names, ", "))
                : "?";
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
  if (std::find(names.begin(), names.end(), name) != names.end() || usb_serial(name)) return;
  if (name.find('/') != std::string::npos || fs::exists(name, ignored)) return;
  if (sim::parse_tcp_address(name)) return;
  throw Error(Exit::bad_input, "--board", fmt::format("there is no board '{}'", name),
              remedy_for_name(name, serial_ports()));
}

}  // namespace lamplock::run
