#include "host/serve/reports.hpp"

#include <algorithm>
#include <vector>

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

/// The oldest one first.
std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored))
    if (entry.path().extension() == ending && is_name(entry.path().stem().string()))
      names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

std::filesystem::path file_of(const std::filesystem::path& folder, std::string_view name) {
  return folder / (std::string(name) + std::string(ending));
}

}  // namespace

void Reports::keep(const std::string& begin, std::string_view html) const {
  std::error_code ignored;
  std::filesystem::create_directories(folder_, ignored);
  const std::vector<std::string> kept = names_in(folder_);
  for (std::size_t i = 0; i + max_kept <= kept.size(); ++i)
    std::filesystem::remove(file_of(folder_, kept[i]), ignored);
  write_whole(file_of(folder_, in_name(begin) + "-" + random_token()).string(),
              [html](const std::filesystem::path& path) { write_file(path, std::string(html)); });
}

std::map<std::string, std::string> Reports::names() const {
  std::map<std::string, std::string> by_begin;
  for (const std::string& name : names_in(folder_)) {
    std::string begin = name.substr(0, begin_length);
    const std::size_t clock = begin.find('T');
    std::replace(begin.begin() + static_cast<std::ptrdiff_t>(std::min(clock, begin.size())),
                 begin.end(), '-', ':');
    by_begin[begin] = name;
  }
  return by_begin;
}

std::optional<std::string> Reports::read(std::string_view name) const {
  if (!is_name(name) || !std::filesystem::exists(file_of(folder_, name))) return std::nullopt;
  return read_file(file_of(folder_, name).string());
}

}  // namespace lamplock::serve
