#include "host/model/zip_archive.hpp"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <set>
#include <string_view>

#include "host/file.hpp"
#include "host/letter_case.hpp"

namespace lamplock::model {
namespace {

/// Longer than any name that programs write.
constexpr std::size_t max_name_bytes = 255;
/// Text of models is compressed to a tenth, with equal numbers at most to a thirtieth; zeros to a
/// thousandth. Small parts are not limited.
constexpr std::uint64_t max_packed = 200, small_bytes = 1u << 20;

constexpr const char* damaged_archive = "the file is cut off or damaged: export it again";

/// False for names that lead out of the archive, or that two programs could read differently.
bool is_plain(std::string_view name) {
  return !name.starts_with('.') && !name.starts_with('/') &&
         name.find('\\') == std::string_view::npos && name.find("/..") == std::string_view::npos &&
         name.find('\0') == std::string_view::npos;
}

bool equal_names(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, lower_case, lower_case);
}

/// Names of compression methods that archives of other programs have (APPNOTE.TXT, 4.4.5).
std::string method_name(unsigned method) {
  switch (method) {
    case ZIP_CM_SHRINK:
      return "Shrink";
    case ZIP_CM_IMPLODE:
      return "Implode";
    case ZIP_CM_DEFLATE64:
      return "Deflate64";
    case ZIP_CM_BZIP2:
      return "BZIP2";
    case ZIP_CM_LZMA:
      return "LZMA";
    case 93:
      return "Zstandard";
    case ZIP_CM_XZ:
      return "XZ";
    case ZIP_CM_PPMD:
      return "PPMd";
    default:
      return fmt::format("method {}", method);
  }
}

}  // namespace

void ZipArchive::Close::operator()(zip* archive) const { zip_discard(archive); }

ZipArchive::ZipArchive(const std::filesystem::path& file)
    : file_(file), archive_(zip_open(file.c_str(), ZIP_RDONLY, nullptr)) {
  if (!archive_) refuse(file_, "not a ZIP archive, as a 3MF must be", damaged_archive);
  read_directory();
}

void ZipArchive::read_directory() {
  std::set<std::string_view> names;
  std::uint64_t bytes = 0;
  const zip_int64_t count = zip_get_num_entries(archive_.get(), 0);
  for (zip_int64_t i = 0; i < count; ++i) {
    const auto index = static_cast<zip_uint64_t>(i);
    zip_stat_t info{};
    constexpr zip_uint64_t needed = ZIP_STAT_NAME | ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE |
                                    ZIP_STAT_COMP_METHOD | ZIP_STAT_ENCRYPTION_METHOD;
    if (zip_stat_index(archive_.get(), index, ZIP_FL_ENC_RAW, &info) != 0 ||
        (info.valid & needed) != needed)
      refuse(file_, "its directory cannot be read", damaged_archive);
    const std::string_view name = info.name;
    if (name.size() > max_name_bytes)
      refuse(file_, fmt::format("a part has a name of {} letters", name.size()),
             "export it with shorter names");
    const ZipPart part{std::string(name), info.size,
                       info.comp_size,    index,
                       info.comp_method,  info.encryption_method != ZIP_EM_NONE};
    check(part);
    bytes += part.bytes;
    parts_.push_back(part);
  }
  for (const ZipPart& part : parts_)
    if (!names.insert(part.name).second)
      refuse(file_, fmt::format("two parts are named '{}'", part.name), "export it again");
  if (bytes > max_unpacked_bytes)
    refuse(file_,
           fmt::format("unpacks to {} MB, more than {}", bytes >> 20, max_unpacked_bytes >> 20),
           "reduce the mesh, or export it as binary STL");
}

void ZipArchive::check(const ZipPart& part) const {
  if (!is_plain(part.name))
    refuse(file_, fmt::format("a part has the unsafe name '{}'", part.name), "export it again");
  // Written so that no sum overflows for any values in the directory.
  if (part.bytes > max_unpacked_bytes)
    refuse(file_,
           fmt::format("part '{}' unpacks to {} MB, more than {}", part.name, part.bytes >> 20,
                       max_unpacked_bytes >> 20),
           "reduce the mesh, or export it as binary STL");
  if (part.bytes > small_bytes && part.bytes / max_packed > part.packed_bytes)
    refuse(file_,
           fmt::format("part '{}' unpacks to {} times its size, which no model does", part.name,
                       part.bytes / std::max<std::uint64_t>(1, part.packed_bytes)),
           "do not open this file");
}

std::vector<ZipPart>::const_iterator ZipArchive::find(const std::string& name) const {
  const auto part = std::ranges::find(parts_, name, &ZipPart::name);
  if (part != parts_.end()) return part;
  return std::ranges::find_if(parts_,
                              [&](const ZipPart& one) { return equal_names(one.name, name); });
}

std::string ZipArchive::unpacked(const std::string& name) const {
  const auto part = find(name);
  if (part == parts_.end())
    refuse(file_, fmt::format("there is no part '{}'", name), damaged_archive);
  if (part->is_encrypted)
    refuse(file_, fmt::format("part '{}' is encrypted", name),
           "save the model without a password or protection");
  // A 3MF has no other methods (ECMA-376 part 2, annex C.3), and libzip would reserve as much
  // memory as the data of some ask for.
  if (part->method != ZIP_CM_STORE && part->method != ZIP_CM_DEFLATE)
    refuse(file_,
           fmt::format("part '{}' is compressed with {}; a 3MF may use only Deflate", name,
                       method_name(part->method)),
           "export the model again, or pack the archive again with Deflate");
  std::string bytes(part->bytes, '\0');
  zip_file_t* const packed = zip_fopen_index(archive_.get(), part->index, 0);
  // The last read compares the CRC, after the end of the part.
  char beyond = 0;
  const bool sound =
      packed != nullptr &&
      zip_fread(packed, bytes.data(), bytes.size()) == static_cast<zip_int64_t>(bytes.size()) &&
      zip_fread(packed, &beyond, 1) == 0;
  const bool closed = packed != nullptr && zip_fclose(packed) == 0;
  if (!sound || !closed)
    refuse(file_, fmt::format("part '{}' cannot be unpacked", name), damaged_archive);
  return bytes;
}

}  // namespace lamplock::model
