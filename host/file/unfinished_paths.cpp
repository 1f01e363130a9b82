#include "host/file/unfinished_paths.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <climits>
#include <cstring>

namespace lamplock {
namespace {

/// Outputs of a command are written one by one, some in threads; folders are made for one report.
constexpr std::size_t max_paths = 32;

enum class Use : int { free, filling, used };

struct Place {
  std::atomic<Use> use{Use::free};
  std::array<char, PATH_MAX> path{};
};
static_assert(std::atomic<Use>::is_always_lock_free);

std::array<Place, max_paths> places;

}  // namespace

UnfinishedPath::UnfinishedPath(const std::filesystem::path& path) : place_(max_paths) {
  std::error_code error;
  const std::filesystem::path whole = std::filesystem::absolute(path, error);
  const auto& text = whole.native();
  if (error || text.size() >= places[0].path.size()) return;
  for (place_ = 0; place_ < max_paths; ++place_) {
    Use expected = Use::free;
    if (places[place_].use.compare_exchange_strong(expected, Use::filling)) break;
  }
  if (place_ == max_paths) return;
  std::memcpy(places[place_].path.data(), text.c_str(), text.size() + 1);
  places[place_].use = Use::used;
}

UnfinishedPath::~UnfinishedPath() {
  if (place_ < max_paths) places[place_].use = Use::free;
}

void remove_unfinished_paths() noexcept {
  for (std::size_t i = max_paths; i-- > 0;)
    if (places[i].use == Use::used && ::unlink(places[i].path.data()) != 0)
      ::rmdir(places[i].path.data());
}

}  // namespace lamplock
