#include "host/gpio/line_address.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "host/access.hpp"
#include "host/text.hpp"

namespace lamplock::gpio {
namespace {

namespace fs = std::filesystem;

constexpr const char* device_folder = "/dev/";
constexpr const char* chip_prefix = "gpiochip";

}  // namespace

LineAddress parse_line_address(const std::string& text) {
  if (text.empty())
    throw Error(Exit::bad_input, "GPIO line", "the name is empty",
                "give a name such as GPIO17, or chip and number such as gpiochip0:17");
  const auto colon = text.rfind(':');
  const auto number =
      colon == std::string::npos ? std::nullopt : number_of<unsigned>(text.substr(colon + 1));
  // Names of lines may contain colons.
  if (!number || colon == 0) return {.name = text};
  const std::string chip = text.substr(0, colon);
  const bool is_file = chip.find('/') != std::string::npos;
  return {.chip = is_file ? chip : device_folder + chip, .number = *number};
}

std::vector<std::string> chip_files(const std::string& folder) {
  std::vector<std::pair<unsigned, std::string>> found;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(chip_prefix)) continue;
    if (const auto number = number_of<unsigned>(name.substr(std::strlen(chip_prefix))))
      found.emplace_back(*number, entry->path().string());
  }
  std::sort(found.begin(), found.end());
  std::vector<std::string> files;
  files.reserve(found.size());
  for (auto& [number, file] : found) files.push_back(std::move(file));
  return files;
}

std::string chip_problem(const std::string& chip, int error) {
  if (is_denied(error)) return fmt::format("no permission to open it; {}", access_remedy(chip));
  return fmt::format("cannot be opened ({}); `lamplock lines` lists the chips",
                     std::strerror(error));
}

Error chip_error(const std::string& chip, int error) {
  if (is_denied(error))
    return {Exit::no_device, chip, "no permission to open it", access_remedy(chip)};
  return {Exit::no_device, chip,
          error == ENOENT ? "there is no such chip"
                          : fmt::format("cannot be opened ({})", std::strerror(error)),
          "use a chip that `lamplock lines` lists"};
}

Error no_line_error(const std::string& place, const std::string& closed_chip) {
  if (!closed_chip.empty())
    return {Exit::no_device, place, "is not a line of the chips that may be opened",
            access_remedy(closed_chip)};
  return {Exit::bad_input, place, "there is no such line",
          "use a line that `lamplock lines` lists, or chip and number as in gpiochip0:17"};
}

bool has_no_edges(int error) { return error == ENXIO || error == ENODEV; }

Error request_error(const std::string& place, int error) {
  switch (error) {
    case EBUSY:
      return {Exit::no_device, place, "is used by another program or driver",
              "`lamplock lines` shows which; end it or use another line"};
    case EINVAL:
    case ENOTSUP:
    case ENXIO:
      return {Exit::bad_input, place, "its chip refuses the requested bias or direction",
              "try another bias, or another line"};
    default:
      return {Exit::no_device, place, fmt::format("cannot be used ({})", std::strerror(error)),
              "check with `lamplock lines` that its chip is connected"};
  }
}

void check_free(const std::vector<ChipInfo>& chips, const std::string& text) {
  const LineAddress place = parse_line_address(text);
  std::string closed;
  bool has_chip = false;
  for (const ChipInfo& chip : chips) {
    if (!place.chip.empty() && chip.file != place.chip) continue;
    has_chip = true;
    if (!chip.problem.empty()) closed = chip.file;
    for (const LineInfo& line : chip.lines) {
      if (place.name.empty() ? line.number != place.number : line.name != place.name) continue;
      if (line.user.empty()) return;
      throw Error(Exit::no_device, text, fmt::format("is used by {}", line.user),
                  "use another line, or end that program or driver");
    }
  }
  if (!place.chip.empty() && !has_chip) throw chip_error(place.chip, ENOENT);
  throw no_line_error(text, closed);
}

}  // namespace lamplock::gpio
