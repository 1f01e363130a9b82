// Fuzz target of the mesh readers (libFuzzer), built with the sanitizers only:
//   build-sanitize/fuzz_mesh CORPUS -max_len=20000 -timeout=5 -rss_limit_mb=2048
// In: a byte that selects the format, then the bytes of a file. Every file must be read or refused.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/model/read_mesh.hpp"

// The name is libFuzzer's.
// NOLINTNEXTLINE(readability-identifier-naming)
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string base =
      (std::filesystem::temp_directory_path() / ("fuzz_mesh_" + std::to_string(::getpid())))
          .string();
  constexpr const char* formats[] = {".stl", ".obj", ".ply", ".glb", ".3mf"};
  if (size == 0) return 0;
  const std::filesystem::path file = base + formats[data[0] % std::size(formats)];
  const std::string bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  try {
    // The reader of packages opens the file itself.
    if (file.extension() == ".3mf") lamplock::write_file(file, bytes);
    const lamplock::model::Mesh mesh = lamplock::model::decode_mesh(file, bytes);
    if (mesh.triangles.empty()) std::abort();
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t vertex : triangle)
        if (vertex >= mesh.vertices.size()) std::abort();
  } catch (const lamplock::Error&) {
  }
  return 0;
}
