// ZIP archives of 3MF files. In: a file. Out: its parts by name, and the bytes of a part after a
// check that they do not fill the memory. Called by the check of 3MF files (threemf_check.hpp).
//
// Archives are read with minizip, like in the mesh library, so that it reads the same data that
// were checked here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lamplock::model {

/// Maximum bytes of all parts of an archive: a mesh of about three million triangles, for which the
/// mesh library needs 2 GB.
inline constexpr std::uint64_t max_unpacked_bytes = 256u << 20;

/// A file in an archive.
struct ZipPart {
  std::string name;
  std::uint64_t bytes = 0, packed_bytes = 0;  ///< by the directory
};

class ZipArchive {
 public:
  /// Reads the directory. Throws Error (bad_input, naming `file`): no archive, cut off, names that
  /// occur twice or that two programs could read differently, more bytes than above, a part with an
  /// impossible compression ratio.
  explicit ZipArchive(const std::filesystem::path& file);

  /// The bytes of a part. Throws Error (bad_input) if there is none of that name, if it is
  /// encrypted, packed by a method unknown to minizip or damaged (CRC).
  std::string unpacked(const std::string& name) const;

 private:
  struct Close {
    void operator()(void* archive) const;
  };
  void read_directory();
  void check(const ZipPart& part) const;

  std::filesystem::path file_;
  std::unique_ptr<void, Close> archive_;
  std::vector<ZipPart> parts_;
};

}  // namespace lamplock::model
