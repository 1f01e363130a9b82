// The clouds that pages look at: the last ones that were opened.
//
// In:  clouds of files. Out: the same by a number, which a page uses to ask for points.
// Who: the server, in its thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <string>

#include "host/serve/cloud.hpp"

namespace lamplock::serve {

/// A cloud of a file of this state: a file that was sent again has another cloud.
struct OpenCloud {
  std::uint64_t number = 0;
  std::string file;  ///< its path, size and time (state_of())
  std::shared_ptr<const Cloud> cloud{};
};

/// Path, size and time of a file: another text when the file has changed.
std::string state_of(const std::filesystem::path& file);

class Clouds {
 public:
  /// Clouds and points kept; the clouds that were used least recently are dropped.
  static constexpr std::size_t max_open = 64, max_points = 4'000'000;

  const OpenCloud& add(std::string file, std::shared_ptr<const Cloud> cloud);
  /// Null if there is none.
  const OpenCloud* find_file(const std::string& file);
  /// Throws Error(bad_input) if there is none.
  const OpenCloud& find(std::uint64_t number);

 private:
  std::list<OpenCloud> open_;  ///< last used first
  std::uint64_t last_number_ = 0;
};

}  // namespace lamplock::serve
