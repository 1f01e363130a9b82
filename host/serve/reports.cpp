#include "host/serve/reports.hpp"

#include <algorithm>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/serve/access.hpp"

namespace lamplock::serve {
namespace {

constexpr std::string_view ending = ".html";
/// Length of a begin. Its colons become hyphens, because some file systems forbid colons in names.
constexpr std::size_t begin_length = std::string_view("2026-11-29T10-00-00Z").size();
constexpr std::size_t token_length = 32;

std::string in_name(std::string begin) {
  std::replace(begin.begin(), begin.end(), ':', '-');
  return begin;
}

/// The begin, a hyphen and a token. No other character: the name is part of a path.
bool is_name(std::string_view name) {
  return name.size() == begin_length + 1 + token_length &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f') || c == '-' || c == 'T' ||
                  c == 'Z';
         });
}

std::filesystem::path file_of(const std::filesystem::path& folder, std::string_view name) {
  return folder / (std::string(name) + std::string(ending));
}

}  // namespace

std::string Reports::new_name(const std::string& begin) {
  return in_name(begin) + "-" + random_token();
}

void Reports::keep(const std::string& name, std::string_view html) const {
  std::error_code ignored;
  std::filesystem::create_directories(folder_, ignored);
  std::set<std::string> kept = names();
  for (; kept.size() >= max_kept; kept.erase(kept.begin()))
    std::filesystem::remove(file_of(folder_, *kept.begin()), ignored);
  write_whole(file_of(folder_, name), html);
}

std::set<std::string> Reports::names() const {
  std::set<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, ignored))
    if (entry.path().extension() == ending && is_name(entry.path().stem().string()))
      names.insert(entry.path().stem().string());
  return names;
}

std::optional<std::string> Reports::read(std::string_view name) const {
  if (!is_name(name) || !std::filesystem::exists(file_of(folder_, name))) return std::nullopt;
  return read_file(file_of(folder_, name).string());
}

}  // namespace lamplock::serve
