#include "host/file.hpp"

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "host/error.hpp"
#include "host/output_error.hpp"
#include "host/similar_files.hpp"

namespace lamplock {

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
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  return extension;
}

}  // namespace lamplock
