#include "host/similar_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "host/suggestion.hpp"

namespace lamplock {
namespace {

namespace fs = std::filesystem;

bool is_of(const fs::path& path, PathKind kind) {
  std::error_code ignored;
  switch (kind) {
    case PathKind::file:
      return fs::is_regular_file(path, ignored);
    case PathKind::folder:
      return fs::is_directory(path, ignored);
    case PathKind::port:
      return fs::is_character_file(path, ignored);
  }
  return false;
}

/// Names in a folder, sorted; none if it cannot be read.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end;
       !error && entry != end; entry.increment(error))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// The path up to its first part that does not exist, and the parts after that.
struct Missing {
  fs::path folder{}, part{}, rest{};
};

Missing first_missing(const fs::path& path) {
  Missing missing;
  for (const fs::path& part : path) {
    std::error_code ignored;
    if (!missing.part.empty())
      missing.rest /= part;
    else if (fs::exists(missing.folder / part, ignored))
      missing.folder /= part;
    else
      missing.part = part;
  }
  return missing;
}

std::vector<std::string> similar_paths(const Missing& missing, PathKind kind) {
  std::vector<std::string> possible, paths;
  for (const std::string& name : names_in(missing.folder))
    if (is_of(missing.rest.empty() ? missing.folder / name : missing.folder / name / missing.rest,
              kind))
      possible.push_back(name);
  for (const std::string& name : similar_names(missing.part.string(), possible)) {
    const fs::path path = missing.folder / name;
    paths.push_back((missing.rest.empty() ? path : path / missing.rest).string());
  }
  return paths;
}

}  // namespace

std::vector<std::string> similar_paths(const fs::path& missing, PathKind kind) {
  return similar_paths(first_missing(missing), kind);
}

std::string missing_path_remedy(const fs::path& missing, PathKind kind) {
  const Missing parts = first_missing(missing);
  const std::string question = question_of(similar_paths(parts, kind));
  if (!question.empty()) return question;
  if (!parts.rest.empty())
    return fmt::format("check its folder: there is no {}", (parts.folder / parts.part).string());
  return "check the name";
}

}  // namespace lamplock
