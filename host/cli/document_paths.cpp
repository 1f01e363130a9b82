#include "host/cli/document_paths.hpp"

#include <array>
#include <filesystem>

#include "host/run/image_path.hpp"

namespace lamplock::cli {
namespace {

/// A file that every installation has.
constexpr const char* known_document = "README.md";
constexpr std::array<std::string_view, 2> document_folders{"docs/", "examples/"};

/// True if a path may begin after this text.
bool begins_path(std::string_view before) {
  constexpr std::string_view separators = " (\n'\"";
  return before.empty() || separators.find(before.back()) != std::string_view::npos;
}

}  // namespace

std::string installed_documents() {
  const std::string file = run::document_of_program(known_document);
  return file.empty() ? "" : std::filesystem::path(file).parent_path().string();
}

std::string with_documents_in(const std::string& folder, std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (begins_path(text.substr(0, i)))
      for (const std::string_view name : document_folders)
        if (text.substr(i).starts_with(name)) result += folder + "/";
    result += text[i];
  }
  return result;
}

void name_documents(Command& command, const std::string& folder) {
  if (folder.empty()) return;
  command.footer(with_documents_in(folder, command.footer()));
  for (Option& option : command.options()) option.help(with_documents_in(folder, option.help()));
  for (Command& inner : command.commands()) name_documents(inner, folder);
}

}  // namespace lamplock::cli
