#include "host/model/mtl.hpp"

#include <algorithm>
#include <string_view>

#include "host/error.hpp"
#include "host/file.hpp"
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

void read_library(const path& file, std::map<std::string, std::string>& pictures) {
  std::string bytes;
  try {
    bytes = read_file(file);
  } catch (const Error&) {
    return;
  }
  Lines lines(bytes);
  std::string material;
  while (const auto line = lines.next()) {
    std::string_view rest = *line;
    const std::string_view word = next_field(rest);
    if (word == "newmtl") material = trimmed(rest);
    if (word == "map_Kd") pictures[material] = picture_name(rest);
  }
}

}  // namespace

std::map<std::string, std::string> pictures_of_materials(const path& file, const std::string& obj) {
  std::map<std::string, std::string> pictures;
  Lines lines(obj);
  while (const auto line = lines.next()) {
    std::string_view rest = *line;
    if (next_field(rest) != "mtllib") continue;
    std::string beside(trimmed(rest));
    std::replace(beside.begin(), beside.end(), '\\', '/');
    read_library(file.parent_path() / beside, pictures);
  }
  return pictures;
}

std::string without_material_libraries(std::string obj) {
  constexpr std::string_view word = "mtllib";
  for (std::size_t at = obj.find(word); at != std::string::npos; at = obj.find(word, at + 1)) {
    obj[at] = '#';
  }
  return obj;
}

}  // namespace lamplock::model
