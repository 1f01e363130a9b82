#include "host/serve/clouds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "host/error.hpp"
#include "host/serve/refusal.hpp"

namespace lamplock::serve {

std::string state_of(const std::filesystem::path& file) {
  std::error_code ignored;
  return fmt::format("{} {} {}", file.string(), std::filesystem::file_size(file, ignored),
                     std::filesystem::last_write_time(file, ignored).time_since_epoch().count());
}

const OpenCloud& Clouds::add(std::string file, std::shared_ptr<const Cloud> cloud) {
  open_.push_front({++last_number_, std::move(file), std::move(cloud)});
  const auto count = [this] {
    std::size_t points = 0;
    for (const OpenCloud& each : open_) points += each.cloud->size();
    return points;
  };
  while (open_.size() > 1 && (open_.size() > max_open || count() > max_points)) open_.pop_back();
  return open_.front();
}

const OpenCloud* Clouds::find_file(const std::string& file) {
  const auto found = std::find_if(open_.begin(), open_.end(),
                                  [&](const OpenCloud& each) { return each.file == file; });
  if (found == open_.end()) return nullptr;
  open_.splice(open_.begin(), open_, found);
  return &open_.front();
}

const OpenCloud& Clouds::find(std::uint64_t number) {
  const auto found = std::find_if(open_.begin(), open_.end(),
                                  [&](const OpenCloud& each) { return each.number == number; });
  if (found == open_.end()) throw Refusal(Exit::bad_input, "cloud-closed");
  open_.splice(open_.begin(), open_, found);
  return open_.front();
}

}  // namespace lamplock::serve
