// ZIP archives, as far as 3MF files are ones. Comes in: a file. Goes out: its parts by name, and
// the bytes of a part, when it is sure that they do not fill the memory. Called by the check of
// 3MF files (threemf_check.hpp).
//
// Archives are read with minizip, as the mesh library reads them: so nothing that was checked here
// can look different there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lamplock::model {

/// All parts of an archive together, bytes: a mesh of about three million triangles, which the
/// mesh library needs 2 GB for.
inline constexpr std::uint64_t most_unpacked_bytes = 256u << 20;

/// A file in an archive.
struct ZipPart {
  std::string name;
  std::uint64_t bytes = 0, packed_bytes = 0;  ///< as the directory says
};

class ZipArchive {
 public:
  /// Reads the directory. Throws Error (bad_input, naming `file`): no archive, cut off, names that
  /// stand twice or that two programs could read differently, more bytes than above, a part that is
  /// nothing but repetition.
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
