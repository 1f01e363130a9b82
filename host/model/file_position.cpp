#include "host/model/file_position.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "host/file.hpp"

namespace lamplock::model {

std::size_t FilePosition::line() const {
  const std::string_view before = text.substr(0, offset);
  return static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n')) + 1;
}

void FilePosition::refuse(const std::string& what, const std::string& remedy) const {
  const std::string place =
      counts_groups ? fmt::format("group {}", (line() + 1) / 2) : fmt::format("line {}", line());
  lamplock::refuse(file, fmt::format("{}: {}", place, what), remedy);
}

}  // namespace lamplock::model
