// Fuzz target of the readers of drawings, pictures and point lists (libFuzzer), built with the
// sanitizers only:
//   build-sanitize/fuzz_input CORPUS -max_len=20000 -timeout=5 -rss_limit_mb=2048
// In: a byte that selects the format, then the bytes of a file. Every file must be read or refused.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <string>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/model/input.hpp"

// The name is libFuzzer's.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string base =
      (std::filesystem::temp_directory_path() / ("fuzz_input_" + std::to_string(::getpid())))
          .string();
  constexpr const char* formats[] = {".svg", ".dxf", ".png", ".jpg", ".bmp",
                                     ".xyz", ".csv", ".cad", ".ply"};
  if (size == 0) return 0;
  const std::filesystem::path file = base + formats[data[0] % std::size(formats)];
  try {
    lamplock::write_file(file, std::string(reinterpret_cast<const char*>(data + 1), size - 1));
    lamplock::model::read_input(file);
  } catch (const lamplock::Error&) {
  }
  return 0;
}
