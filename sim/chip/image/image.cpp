#include "sim/chip/image/image.hpp"

#include <cxxabi.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "sim/chip/fabric/hex.hpp"

namespace lamplock::sim::chip {

namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint32_t flash_base = 0x1000'0000, flash_limit = 0x1100'0000;
constexpr std::uint32_t sram_base = 0x2000'0000, sram_limit = 0x2004'2000;

[[noreturn]] void fail(const std::string& where, const std::string& what,
                       const std::string& remedy) {
  throw std::runtime_error(where + ": " + what + "; " + remedy);
}

// Little-endian fields; the callers have checked the bounds.
std::uint32_t half(Bytes file, std::size_t at) {
  return file[at] | static_cast<std::uint32_t>(file[at + 1]) << 8;
}
std::uint32_t word(Bytes file, std::size_t at) { return half(file, at) | half(file, at + 2) << 16; }
bool inside(Bytes file, std::uint64_t at, std::uint64_t size) {
  return at <= file.size() && size <= file.size() - at;
}

bool in_memory(std::uint32_t address, std::uint64_t size) {
  const auto within = [&](std::uint32_t from, std::uint32_t to) {
    return address >= from && address < to && size <= to - address;
  };
  return within(flash_base, flash_limit) || within(sram_base, sram_limit);
}

void finish(Image& image, const std::string& where) {
  std::stable_sort(image.parts.begin(), image.parts.end(),
                   [](const ImagePart& a, const ImagePart& b) { return a.address < b.address; });
  for (std::size_t i = 1; i < image.parts.size(); ++i) {
    const ImagePart& before = image.parts[i - 1];
    if (before.address + before.bytes.size() > image.parts[i].address)
      fail(where, "two parts overlap at " + hex(image.parts[i].address), "build the image again");
  }
  std::stable_sort(
      image.symbols.begin(), image.symbols.end(),
      [](const ImageSymbol& a, const ImageSymbol& b) { return a.address < b.address; });
}

std::string demangled(const std::string& name) {
  // Only names mangled by a C++ compiler; a C name such as "i" is a mangled type, too.
  if (name.rfind("_Z", 0) != 0 || name.size() > 4096) return name;
  int status = 0;
  const std::unique_ptr<char, decltype(&std::free)> text(
      abi::__cxa_demangle(name.c_str(), nullptr, nullptr, &status), &std::free);
  return status == 0 && text != nullptr ? std::string(text.get()) : name;
}

// Sections' and symbols' fields: ELF specification (Tool Interface Standard 1.2), figures 1-3 ff.
void read_symbols(Bytes file, Image& image, const std::string& where) {
  constexpr std::size_t section_size = 40, symbol_size = 16;
  constexpr std::uint32_t symbol_table = 2, string_table = 3;
  const std::uint32_t sections = word(file, 32), count = half(file, 48);
  if (sections == 0 || count == 0) return;
  const char* const remedy = "build the image again";
  if (half(file, 46) != section_size ||
      !inside(file, sections, std::uint64_t{count} * section_size))
    fail(where, "section headers lie outside the file", remedy);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t header = sections + i * section_size;
    if (word(file, header + 4) != symbol_table) continue;
    const std::uint32_t from = word(file, header + 16), size = word(file, header + 20);
    const std::uint32_t link = word(file, header + 24);
    if (!inside(file, from, size) || link >= count)
      fail(where, "the symbol table lies outside the file", remedy);
    const std::size_t strings = sections + link * section_size;
    const std::uint32_t text = word(file, strings + 16), text_size = word(file, strings + 20);
    if (word(file, strings + 4) != string_table || !inside(file, text, text_size))
      fail(where, "the symbols' names lie outside the file", remedy);
    for (std::size_t at = from; at + symbol_size <= std::size_t{from} + size; at += symbol_size) {
      const std::uint32_t name = word(file, at), section = half(file, at + 14);
      const std::uint32_t type = file[at + 12] & 15u;
      if (section == 0 || type > 2 || name == 0 || name >= text_size) continue;
      const auto* const first = reinterpret_cast<const char*>(file.data()) + text + name;
      const std::string spelled(first, std::find(first, first + (text_size - name), '\0'));
      if (spelled.empty() || spelled[0] == '$') continue;  // mapping symbols
      const bool function = type == 2;
      const std::uint32_t value = word(file, at + 4);
      image.symbols.push_back(
          {demangled(spelled), function ? value & ~1u : value, word(file, at + 8), function});
    }
  }
}

}  // namespace

std::size_t Image::size() const {
  std::size_t total = 0;
  for (const ImagePart& part : parts) total += part.bytes.size();
  return total;
}

const ImageSymbol* Image::find(std::string_view name) const {
  const auto found = std::find_if(symbols.begin(), symbols.end(),
                                  [&](const ImageSymbol& symbol) { return symbol.name == name; });
  return found == symbols.end() ? nullptr : &*found;
}

Image parse_elf(Bytes file, const std::string& where) {
  constexpr std::size_t header_size = 52, program_header_size = 32;
  constexpr std::uint32_t arm = 40, load = 1;
  const char* const remedy = "give an ELF file built for the RP2040";
  if (file.size() < header_size || word(file, 0) != 0x464c'457f)
    fail(where, "not an ELF file", remedy);
  if (file[4] != 1 || file[5] != 1 || half(file, 18) != arm)
    fail(where, "not a 32-bit little-endian Arm program", remedy);
  const std::uint32_t headers = word(file, 28), count = half(file, 44);
  if (half(file, 42) != program_header_size ||
      !inside(file, headers, std::uint64_t{count} * program_header_size))
    fail(where, "program headers lie outside the file", "build the image again");
  Image image;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t header = headers + i * program_header_size;
    const std::uint32_t offset = word(file, header + 4), address = word(file, header + 12);
    const std::uint32_t size = word(file, header + 16);
    if (word(file, header) != load || size == 0) continue;
    if (!inside(file, offset, size))
      fail(where, "the part for " + hex(address) + " lies outside the file",
           "build the image again");
    if (!in_memory(address, size))
      fail(where, "the part for " + hex(address) + " lies neither in flash nor in SRAM",
           "check the linker script");
    const Bytes bytes = file.subspan(offset, size);
    image.parts.push_back({address, {bytes.begin(), bytes.end()}});
  }
  if (image.parts.empty()) fail(where, "contains nothing to load", remedy);
  read_symbols(file, image, where);
  finish(image, where);
  return image;
}

Image parse_uf2(Bytes file, const std::string& where) {
  // Fields of a block: the UF2 file format specification; limits of the ROM: RP2040
  // datasheet 2.8.4.
  constexpr std::size_t block_size = 512, payload_at = 32, payload_size = 256;
  constexpr std::uint32_t rp2040_family = 0xe48b'ff56;
  constexpr std::uint32_t not_main_flash = 1, has_family = 0x2000;
  const char* const remedy = "copy or build the file again";
  if (file.empty() || file.size() % block_size != 0)
    fail(where, "not a whole number of UF2 blocks of 512 bytes", remedy);
  Image image;
  std::vector<bool> seen;
  std::size_t missing = 0;
  for (std::size_t at = 0; at < file.size(); at += block_size) {
    const Bytes block = file.subspan(at, block_size);
    const std::string here = where + ": block " + std::to_string(at / block_size);
    if (word(block, 0) != 0x0a32'4655 || word(block, 4) != 0x9e5d'5157 ||
        word(block, 508) != 0x0ab1'6f30)
      fail(here, "has no UF2 magic numbers", remedy);
    const std::uint32_t flags = word(block, 8), address = word(block, 12);
    const std::uint32_t size = word(block, 16), number = word(block, 20), count = word(block, 24);
    // As in the ROM, blocks for another chip are skipped.
    if ((flags & not_main_flash) != 0 || (flags & has_family) == 0 ||
        word(block, 28) != rp2040_family)
      continue;
    if (size != payload_size || address % payload_size != 0 || !in_memory(address, size))
      fail(here, "does not hold 256 bytes for flash or SRAM", remedy);
    if (seen.empty()) {
      if (count == 0 || count > file.size() / block_size)
        fail(where,
             std::to_string(count) + " blocks announced, " +
                 std::to_string(file.size() / block_size) + " there",
             remedy);
      seen.assign(count, false);
      missing = count;
    }
    if (count != seen.size() || number >= count || seen[number])
      fail(here, "is out of its sequence", remedy);
    seen[number] = true;
    --missing;
    const Bytes bytes = block.subspan(payload_at, payload_size);
    image.parts.push_back({address, {bytes.begin(), bytes.end()}});
  }
  if (seen.empty())
    fail(where, "no block is for the RP2040 (family " + hex(rp2040_family) + ")",
         "give a file built for the RP2040");
  if (missing != 0) fail(where, std::to_string(missing) + " blocks are missing", remedy);
  finish(image, where);
  return image;
}

Image parse_bin(Bytes file, const std::string& where) {
  if (file.empty() || file.size() > flash_limit - flash_base)
    fail(where, std::to_string(file.size()) + " bytes cannot be an image of the flash",
         "give a binary of 1 byte to 16 MiB");
  Image image;
  image.parts.push_back({flash_base, {file.begin(), file.end()}});
  return image;
}

Image load_image(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(path, "cannot be opened", "give a .elf, .uf2 or .bin file");
  // read() turns an error (a folder) into a bad stream; iterators throw.
  std::vector<std::uint8_t> file;
  std::array<char, 4096> block{};
  while (stream.read(block.data(), block.size()), stream.gcount() > 0)
    file.insert(file.end(), block.data(), block.data() + stream.gcount());
  if (stream.bad()) fail(path, "cannot be read", "check the file");
  const std::uint32_t magic = file.size() >= 4 ? word(file, 0) : 0;
  if (magic == 0x464c'457f) return parse_elf(file, path);
  if (magic == 0x0a32'4655) return parse_uf2(file, path);
  if (path.size() >= 4 && path.substr(path.size() - 4) == ".bin") return parse_bin(file, path);
  fail(path, "neither ELF nor UF2", "give a .elf, .uf2 or .bin file");
}

}  // namespace lamplock::sim::chip
