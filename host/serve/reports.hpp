// The reports of the jobs and programs that the server has run: files of its folder, the last 20.
//
// In:  the page of a report and the begin of its job. Out: the page, by a name with 128 random
//      bits: a client without access to the history cannot guess it, so that a
//      browser can open a report by its address alone.
// Who: the history, which writes them outside of the thread of the server; the server.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>

namespace lamplock::serve {

class Reports {
 public:
  /// A page of a million points has 15 MB.
  static constexpr std::size_t max_kept = 20;

  explicit Reports(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// A name that no other report has. `begin` of the job, UTC: "2026-11-29T10:00:00Z".
  static std::string new_name(const std::string& begin);
  /// Stores a page under a name of new_name(), and removes the oldest reports beyond max_kept.
  /// Throws Error(bad_input) if it cannot be written.
  void keep(const std::string& name, std::string_view html) const;
  /// Names of the stored reports, the oldest first: a name begins with its time.
  std::set<std::string> names() const;
  /// The page, or nullopt if no report has this name.
  std::optional<std::string> read(std::string_view name) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace lamplock::serve
