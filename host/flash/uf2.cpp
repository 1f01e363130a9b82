#include "host/flash/uf2.hpp"

#include <fmt/format.h>

#include <set>

#include "host/bytes.hpp"

namespace lamplock::flash {
namespace {

constexpr std::uint32_t first_magic = 0x0a32'4655, second_magic = 0x9e5d'5157,
                        last_magic = 0x0ab1'6f30;
constexpr std::size_t payload_at = 32, last_magic_at = 508;
/// Flags: the field of the file size holds a family; a checksum or tags, which the ROM ignores,
/// follow the payload.
constexpr std::uint32_t has_family = 0x2000, has_checksum = 0x4000, has_tags = 0x8000;
/// End of a serial flash with addresses of 24 bits.
constexpr std::uint32_t flash_limit = flash_base + (16u << 20);

/// One block with unchecked fields.
struct Block {
  explicit Block(std::string_view bytes)
      : begins(load<std::uint32_t>(bytes.data()) == first_magic &&
               load<std::uint32_t>(bytes.data() + 4) == second_magic),
        ends(load<std::uint32_t>(bytes.data() + last_magic_at) == last_magic),
        flags(load<std::uint32_t>(bytes.data() + 8)),
        address(load<std::uint32_t>(bytes.data() + 12)),
        size(load<std::uint32_t>(bytes.data() + 16)),
        number(load<std::uint32_t>(bytes.data() + 20)),
        count(load<std::uint32_t>(bytes.data() + 24)),
        family(load<std::uint32_t>(bytes.data() + 28)),
        payload(bytes.substr(payload_at, page_size)) {}
  bool begins, ends;
  std::uint32_t flags, address, size, number, count, family;
  std::string_view payload;
};

/// Reads blocks in order and remembers their numbers and addresses.
class Reader {
 public:
  Reader(std::size_t blocks, const std::string& where) : blocks_(blocks), where_(where) {}

  Part read(const Block& block) {
    check_kind(block);
    check_place(block);
    check_sequence(block);
    ++index_;
    return {block.address, {block.payload.begin(), block.payload.end()}};
  }

 private:
  static constexpr const char* damaged = "copy or build the file again";
  static constexpr const char* other_chip = "give an image that was built for the RP2040";

  [[noreturn]] void fail(Uf2Fault fault, const std::string& what, const char* remedy) const {
    throw Uf2Error(fault, index_, fmt::format("{}: block {}", where_, index_), what, remedy);
  }

  void check_kind(const Block& block) const {
    if (!block.begins || !block.ends) fail(Uf2Fault::magic, "has no UF2 magic numbers", damaged);
    if ((block.flags & ~(has_family | has_checksum | has_tags)) != 0)
      fail(Uf2Fault::flags,
           fmt::format("is not for the flash of a chip (flags 0x{:x})", block.flags), other_chip);
    if ((block.flags & has_family) == 0)
      fail(Uf2Fault::family, "does not say which chip it is for", other_chip);
    if (block.family != rp2040_family)
      fail(Uf2Fault::family, fmt::format("is for another chip (family 0x{:08x})", block.family),
           other_chip);
  }

  void check_place(const Block& block) {
    if (block.size != page_size)
      fail(Uf2Fault::payload, fmt::format("holds {} bytes, not {}", block.size, page_size),
           damaged);
    if (block.address % page_size != 0)
      fail(Uf2Fault::alignment, fmt::format("begins inside a page, at 0x{:08x}", block.address),
           damaged);
    if (block.address < flash_base || block.address >= flash_limit)
      fail(Uf2Fault::address, fmt::format("is for 0x{:08x}, which is not flash", block.address),
           "give an image that runs from flash");
    if (!places_.insert(block.address).second)
      fail(Uf2Fault::repeated_place,
           fmt::format("is for 0x{:08x} like an earlier block", block.address), damaged);
  }

  void check_sequence(const Block& block) {
    if (block.count != blocks_)
      fail(Uf2Fault::count, fmt::format("announces {} blocks, there are {}", block.count, blocks_),
           damaged);
    if (block.number >= blocks_)
      fail(Uf2Fault::number, fmt::format("has number {} of {}", block.number, blocks_), damaged);
    if (!numbers_.insert(block.number).second)
      fail(Uf2Fault::repeated, fmt::format("has number {} like an earlier block", block.number),
           damaged);
  }

  std::size_t blocks_;
  const std::string& where_;
  std::size_t index_ = 0;
  std::set<std::uint32_t> numbers_, places_;
};

}  // namespace

bool is_uf2(std::string_view file) {
  return file.size() >= 4 && load<std::uint32_t>(file.data()) == first_magic;
}

std::vector<Part> read_uf2(std::string_view file, const std::string& where) {
  if (file.empty() || file.size() % uf2_block_size != 0)
    throw Uf2Error(
        Uf2Fault::size, file.size() / uf2_block_size, where,
        fmt::format("{} bytes are not whole UF2 blocks of {}", file.size(), uf2_block_size),
        "copy or build the file again");
  const std::size_t blocks = file.size() / uf2_block_size;
  Reader reader(blocks, where);
  std::vector<Part> parts;
  parts.reserve(blocks);
  for (std::size_t i = 0; i < blocks; ++i)
    parts.push_back(reader.read(Block(file.substr(i * uf2_block_size, uf2_block_size))));
  return parts;
}

std::string write_uf2(const FlashImage& image) {
  constexpr std::size_t pages = sector_size / page_size;
  const auto count = static_cast<std::uint32_t>(image.sectors.size() * pages);
  std::string file;
  std::uint32_t number = 0;
  for (const Sector& sector : image.sectors)
    for (std::size_t page = 0; page < pages; ++page) {
      const std::size_t begin = file.size(), within = page * page_size;
      const auto address = sector.address + static_cast<std::uint32_t>(within);
      for (const std::uint32_t field : {first_magic, second_magic, has_family, address,
                                        std::uint32_t{page_size}, number++, count, rp2040_family})
        append(file, field);
      const auto from = sector.bytes.begin() + static_cast<std::ptrdiff_t>(within);
      file.append(from, from + page_size);
      file.resize(begin + last_magic_at, '\0');
      append(file, last_magic);
    }
  return file;
}

}  // namespace lamplock::flash
