#include "host/file.hpp"

#include <cerrno>
#include <fstream>

#include "host/error.hpp"
#include "host/letter_case.hpp"
#include "host/output_error.hpp"
#include "host/similar_files.hpp"

namespace lamplock {
namespace {

/// UTF-16 with its mark, or two characters of ASCII in it.
bool is_utf16(std::string_view text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
  if (text.size() < 4) return false;
  const auto is_character = [](char c) { return c >= '\t' && c <= '~'; };
  const bool low_first = text[1] == 0 && text[3] == 0;
  const bool high_first = text[0] == 0 && text[2] == 0;
  return (low_first && is_character(text[0]) && is_character(text[2])) ||
         (high_first && is_character(text[1]) && is_character(text[3]));
}

}  // namespace

void refuse(const std::filesystem::path& path, const std::string& what, const std::string& remedy) {
  throw Error(Exit::bad_input, path.string(), what, remedy);
}

void check_is_file(const std::filesystem::path& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure))
    refuse(path, "no such file", missing_path_remedy(path));
  if (!std::filesystem::is_regular_file(path, failure))
    refuse(path, "not a file", "give a file, not a folder or device");
}

void refuse_utf16(const std::filesystem::path& path, std::string_view text) {
  if (is_utf16(text)) refuse(path, "the text is UTF-16", "save it as UTF-8");
}

std::string read_text_file(const std::filesystem::path& path) {
  std::string text = read_file(path);
  refuse_utf16(path, text);
  return text;
}

std::string read_file(const std::filesystem::path& path) {
  check_is_file(path);
  std::error_code failure;
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse(path, "cannot be read", "check its permissions");
  std::string bytes(std::filesystem::file_size(path, failure), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file) refuse(path, "cannot be read", "check its permissions");
  if (bytes.empty()) refuse(path, "the file is empty", "make it again");
  return bytes;
}

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.close();
  if (!file) throw OutputError(path, errno);
}

std::string lower_extension(const std::filesystem::path& path) {
  return in_lower_case(path.extension().string());
}

}  // namespace lamplock
