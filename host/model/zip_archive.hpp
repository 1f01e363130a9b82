// ZIP archives of 3MF files. In: a file. Out: its parts by name, and the bytes of a part after a
// check that they do not fill the memory. Called by the 3MF reader (threemf_package.hpp).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

struct zip;  // of libzip

namespace lamplock::model {

/// Maximum bytes of all parts of an archive: a mesh of about three million triangles, for which the
/// reader needs 2 GB.
inline constexpr std::uint64_t max_unpacked_bytes = 256u << 20;

/// A file in an archive.
struct ZipPart {
  std::string name;
  std::uint64_t bytes = 0, packed_bytes = 0;  ///< by the directory
  std::uint64_t index = 0;                    ///< in the directory
  unsigned method = 0;                        ///< of compression, its number in the directory
  bool is_encrypted = false;
};

class ZipArchive {
 public:
  /// Reads the directory. Throws Error (bad_input, naming `file`): no archive, cut off, names that
  /// occur twice or that two programs could read differently, more bytes than above, a part with an
  /// impossible compression ratio.
  explicit ZipArchive(const std::filesystem::path& file);

  /// The bytes of a part; upper and lower case are equal (ECMA-376 part 2, 9.1.1) unless a part has
  /// exactly this name. Throws Error (bad_input) if there is none of that name, if it is
  /// encrypted, compressed by another method than Deflate or damaged (CRC).
  std::string unpacked(const std::string& name) const;

  /// True if unpacked() finds a part of that name.
  bool has(const std::string& name) const { return find(name) != parts_.end(); }

 private:
  struct Close {
    void operator()(zip* archive) const;
  };
  void read_directory();
  std::vector<ZipPart>::const_iterator find(const std::string& name) const;
  void check(const ZipPart& part) const;

  std::filesystem::path file_;
  std::unique_ptr<zip, Close> archive_;
  std::vector<ZipPart> parts_;
};

}  // namespace lamplock::model
