// The texts of the page and of the server in one table, so that a translation is one file
// (docs/page.md).
//
// In:  page/texts.json, the settings, and a file with the same names in another language. Out: a
//      text for each name. Who: the document of the page, refusals of the server; `serve --texts`,
//      `serve --write-texts`.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace lamplock::serve {

/// Texts by name, UTF-8. {value} in a text is replaced by a value of the page.
using PageTexts = std::map<std::string, std::string>;

const PageTexts& english_texts();

/// The texts without untranslated descriptions of settings, because `settings.get` sends those.
PageTexts texts_of_document(const PageTexts& texts);

/// The texts of a translation, and the English ones that it does not have. Throws
/// Error(bad_input): the file is not JSON, a name is not in the English table, a text is not a
/// string, is empty, or has a {value} that the English text does not have.
PageTexts read_texts(const std::filesystem::path& file);

/// Writes the English table, to be translated.
void write_texts(const std::filesystem::path& file);

}  // namespace lamplock::serve
