#include "host/model/mtl.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/model/mesh_builder.hpp"
#include "host/model/text.hpp"
#include "host/text.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// The file name after the options of a map: -o, -s and -t have one to three numbers, -mm two, all
/// others one word.
std::string_view picture_name(std::string_view text) {
  text = trimmed(text);
  while (text.starts_with('-')) {
    const std::string_view option = next_field(text);
    const bool numbers = option == "-o" || option == "-s" || option == "-t";
    const int most = numbers ? 3 : option == "-mm" ? 2 : 1;
    for (int i = 0; i < most; ++i) {
      std::string_view rest = text;
      const std::string_view word = next_field(rest);
      if (numbers && !to_double(word)) break;
      text = rest;
    }
    text = trimmed(text);
  }
  return text;
}

/// False if the library is missing.
bool read_library(const path& file, Materials& materials) {
  std::string bytes;
  try {
    bytes = read_file(file);
  } catch (const Error&) {
    return false;
  }
  Lines lines(bytes);
  Material* material = &materials[""];
  while (const auto line = lines.next()) {
    std::string_view rest = *line;
    const std::string_view word = next_field(rest);
    if (word == "newmtl") material = &materials[std::string(trimmed(rest))];
    if (word == "map_Kd") material->picture = picture_name(rest);
    if (word != "Kd") continue;
    const auto red = to_double(next_field(rest));
    if (!red) continue;  // a spectrum or a colour of CIE
    // The manual: green and blue are equal to red if they are missing.
    const double green = to_double(next_field(rest)).value_or(*red);
    material->light = luma(*red, green, to_double(next_field(rest)).value_or(*red));
  }
  return true;
}

path beside(const path& obj, std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '\\', '/');
  return obj.parent_path() / text;
}

}  // namespace

std::vector<std::string> read_material_libraries(const path& obj, std::string_view names,
                                                 Materials& materials) {
  std::vector<std::string> missing;
  names = trimmed(names);
  if (names.empty() || read_library(beside(obj, names), materials)) return missing;
  // A name may contain blanks: fields that are no file are joined up to the extension.
  std::string pending;
  const auto keep_pending = [&] {
    if (!pending.empty()) missing.push_back(std::exchange(pending, {}));
  };
  for (auto name = next_field(names); !name.empty(); name = next_field(names)) {
    if (read_library(beside(obj, name), materials)) {
      keep_pending();
      continue;
    }
    const bool is_joined = !pending.empty();
    pending += (is_joined ? " " : "") + std::string(name);
    if (is_joined && read_library(beside(obj, pending), materials))
      pending.clear();
    else if (lower_extension(pending) == ".mtl")
      keep_pending();
  }
  keep_pending();
  return missing;
}

}  // namespace lamplock::model
