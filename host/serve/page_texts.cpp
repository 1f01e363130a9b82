#include "host/serve/page_texts.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/file/staged_file.hpp"
#include "host/serve/page_files.hpp"
#include "shared/settings_table.hpp"

namespace lamplock::serve {
namespace {

constexpr std::string_view setting_prefix = "setting.";

/// Names in braces.
std::set<std::string> values_of(const std::string& text) {
  std::set<std::string> values;
  for (std::size_t at = text.find('{'); at != std::string::npos; at = text.find('{', at + 1)) {
    const std::size_t end = text.find('}', at);
    if (end == std::string::npos) break;
    values.insert(text.substr(at + 1, end - at - 1));
  }
  return values;
}

void check_text(const std::string& file, const std::string& name, const nlohmann::json& text) {
  const std::string where = fmt::format("{}: {}", file, name);
  const auto english = english_texts().find(name);
  if (english == english_texts().end())
    throw Error(Exit::bad_input, where, "is not the name of a text of the page",
                "remove it; lamplock serve --write-texts writes all names");
  if (!text.is_string() || text.get_ref<const std::string&>().empty())
    throw Error(Exit::bad_input, where, "is not a text",
                "write the text in quotation marks, or remove the name to have the English text");
  const auto known = values_of(english->second);
  for (const std::string& value : values_of(text.get<std::string>()))
    if (known.count(value) == 0)
      throw Error(Exit::bad_input, where, fmt::format("{{{}}} has no value", value),
                  "use the names in braces of the English text: " + english->second);
}

/// texts.json, then `setting.NAME` with the description of each setting.
nlohmann::ordered_json english_table() {
  auto english = nlohmann::ordered_json::parse(page_texts_json());
  for (std::size_t i = 0; i < settings::setting_count; ++i) {
    const settings::Row& row = settings::row(static_cast<settings::Id>(i));
    english[fmt::format("{}{}", setting_prefix, row.name)] = row.description;
  }
  return english;
}

}  // namespace

const PageTexts& english_texts() {
  static const PageTexts texts = english_table().get<PageTexts>();
  return texts;
}

PageTexts texts_of_document(const PageTexts& texts) {
  PageTexts needed = texts;
  std::erase_if(needed, [](const auto& text) {
    return text.first.starts_with(setting_prefix) && text.second == english_texts().at(text.first);
  });
  return needed;
}

PageTexts read_texts(const std::filesystem::path& file) {
  nlohmann::json given;
  try {
    given = nlohmann::json::parse(read_file(file.string()));
  } catch (const nlohmann::json::parse_error& error) {
    throw Error(Exit::bad_input, file.string(), fmt::format("is not JSON at byte {}", error.byte),
                "lamplock serve --write-texts writes a table to be translated");
  }
  if (!given.is_object())
    throw Error(Exit::bad_input, file.string(), "is not an object of names and texts",
                "lamplock serve --write-texts writes a table to be translated");
  PageTexts texts = english_texts();
  for (const auto& [name, text] : given.items()) {
    check_text(file.string(), name, text);
    texts[name] = text.get<std::string>();
  }
  return texts;
}

void write_texts(const std::filesystem::path& file) {
  write_whole(file.string(), english_table().dump(2) + "\n");
}

}  // namespace lamplock::serve
