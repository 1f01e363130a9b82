#include "firmware/machine/console/persistent_state.hpp"

#include "shared/wire/bytes.hpp"

namespace lamplock::machine {
namespace {

constexpr std::uint8_t version = 1;
/// Kinds of pieces; those of places are the numbers of their rows (program::ParameterRow).
constexpr std::uint8_t kind_g28 = static_cast<std::uint8_t>(program::ParameterRow::home_g28),
                       kind_g30 = static_cast<std::uint8_t>(program::ParameterRow::home_g30),
                       kind_tool_length =
                           static_cast<std::uint8_t>(program::ParameterRow::tool_length),
                       kind_rotation = 16, kind_start_up = 32, kind_build_text = 48,
                       kind_tools = 64;
static_assert(kind_g30 + 1 == PersistentStateRecord::pieces);

/// The place of this kind, null if the kind has none; const if `kept` is.
template <class Kept>
auto* kept_place(Kept& kept, std::uint8_t kind) {
  if (kind == kind_g28) return &kept.parameters.home_g28_e7;
  if (kind == kind_g30) return &kept.parameters.home_g30_e7;
  return kind < program::coordinate_systems ? &kept.parameters.systems_e7[kind] : nullptr;
}
template <class Kept>
auto* text_of(Kept& kept, std::uint8_t kind) {
  if (kind == kind_build_text) return &kept.build_text;
  const bool start_up = kind >= kind_start_up && kind < kind_start_up + start_up_lines;
  return start_up ? &kept.start_up[kind - kind_start_up] : nullptr;
}

/// Range of the coordinates of a place: the machine is within its own range, and the origin of a
/// program whose range overlaps it may be twice as far away.
std::int64_t range_of(std::uint8_t kind) {
  return kind < program::coordinate_systems ? 2 * program::max_position_e7
                                            : program::max_position_e7;
}

void put_place(wire::ByteWriter& out, std::uint8_t kind, const program::Place& place) {
  if (program::same_place(place, program::Place{})) return;
  out.put(kind);
  out.put(static_cast<std::uint8_t>(PersistentStateRecord::place_size));
  for (const std::int64_t value : place) out.put(value);
}

bool take_place(wire::ByteReader& in, std::size_t size, std::uint8_t kind, program::Place& place) {
  if (size != PersistentStateRecord::place_size) return false;
  program::Place read{};
  for (std::int64_t& value : read) {
    value = in.take<std::int64_t>();
    if (value > range_of(kind) || value < -range_of(kind)) return false;
  }
  place = read;
  return true;
}

/// A piece of one number: the tool length, a rotation; null if the kind has none.
template <class Kept>
auto* number_of(Kept& kept, std::uint8_t kind) {
  if (kind == kind_tool_length) return &kept.parameters.tool_length_e7;
  const bool rotation = kind >= kind_rotation && kind < kind_rotation + program::coordinate_systems;
  return rotation ? &kept.parameters.rotations_e7[kind - kind_rotation] : nullptr;
}

/// The numbers that words can have: 10^9 degrees.
constexpr std::int64_t max_rotation_e7 = 1'000'000'000 * program::one_e7;

void put_number(wire::ByteWriter& out, std::uint8_t kind, std::int64_t e7) {
  if (e7 == 0) return;
  out.put(kind);
  out.put(static_cast<std::uint8_t>(sizeof e7));
  out.put(e7);
}

bool take_number(std::span<const std::uint8_t> bytes, std::uint8_t kind, std::int64_t& e7) {
  const std::int64_t most = kind == kind_tool_length ? program::max_position_e7 : max_rotation_e7;
  wire::ByteReader in(bytes);
  const auto read = in.take<std::int64_t>();
  if (bytes.size() != sizeof read || read > most || read < -most) return false;
  e7 = read;
  return true;
}

void put_tools(wire::ByteWriter& out, const program::ToolTable& tools) {
  std::size_t count = 0;
  while (count < program::ToolTable::capacity && tools.entry(count).number() != 0) ++count;
  if (count == 0) return;
  out.put(kind_tools);
  out.put(static_cast<std::uint8_t>(count * sizeof(program::ToolTable::Entry)));
  for (std::size_t i = 0; i < count; ++i) {
    out.put(tools.entry(i).length_nm);
    out.put(tools.entry(i).diameter_and_number);
  }
}

bool take_tools(std::span<const std::uint8_t> bytes, program::ToolTable& tools) {
  wire::ByteReader in(bytes);
  if (bytes.size() > sizeof tools || bytes.size() % sizeof(program::ToolTable::Entry) != 0)
    return false;
  program::ToolTable read;
  while (in.left() != 0) {
    program::ToolTable::Entry entry;
    entry.length_nm = in.take<std::int32_t>();
    entry.diameter_and_number = in.take<std::uint32_t>();
    if (!entry.is_valid() || !read.set(entry)) return false;
  }
  tools = read;
  return true;
}

void put_text(wire::ByteWriter& out, std::uint8_t kind, const KeptText& text) {
  const std::string_view view = text.view();
  if (view.empty()) return;
  out.put(kind);
  out.put(static_cast<std::uint8_t>(view.size()));
  for (const char c : view) out.put(static_cast<std::uint8_t>(c));
}

bool take_text(std::span<const std::uint8_t> bytes, KeptText& text) {
  std::array<char, KeptText::capacity> read;
  if (bytes.size() > read.size()) return false;
  for (std::size_t i = 0; i < bytes.size(); ++i) read[i] = static_cast<char>(bytes[i]);
  return text.set({read.data(), bytes.size()});
}

/// False, without a change, if the piece is not understood.
bool take_piece(PersistentState& kept, std::uint8_t kind, std::span<const std::uint8_t> bytes) {
  if (program::Place* place = kept_place(kept, kind)) {
    wire::ByteReader in(bytes);
    return take_place(in, bytes.size(), kind, *place);
  }
  if (kind == kind_tools) return take_tools(bytes, kept.parameters.tools);
  if (std::int64_t* number = number_of(kept, kind)) return take_number(bytes, kind, *number);
  KeptText* text = text_of(kept, kind);
  return text != nullptr && take_text(bytes, *text);
}

}  // namespace

bool KeptText::set(std::string_view text) {
  if (text.size() > capacity) return false;
  for (const char c : text)
    if (c < ' ' || c > '~') return false;
  for (std::size_t i = 0; i < text.size(); ++i) text_[i] = text[i];
  size_ = static_cast<std::uint8_t>(text.size());
  return true;
}

bool KeptText::same(const KeptText& other) const {
  if (size_ != other.size_) return false;
  for (std::size_t i = 0; i < size_; ++i)
    if (text_[i] != other.text_[i]) return false;
  return true;
}

void PersistentState::clear_places() {
  parameters.systems_e7 = {};
  parameters.rotations_e7 = {};
  parameters.home_g28_e7 = parameters.home_g30_e7 = {};
  parameters.tools = {};
}

bool PersistentState::same(const PersistentState& other) const {
  for (std::uint8_t kind = 0; kind < PersistentStateRecord::pieces; ++kind)
    if (!program::same_place(*kept_place(*this, kind), *kept_place(other, kind))) return false;
  for (std::size_t i = 0; i < start_up_lines; ++i)
    if (!(start_up[i] == other.start_up[i])) return false;
  if (parameters.tool_length_e7 != other.parameters.tool_length_e7 ||
      parameters.rotations_e7 != other.parameters.rotations_e7)
    return false;
  return parameters.tools == other.parameters.tools && build_text == other.build_text;
}

std::uint32_t PersistentStateRecord::put(const PersistentState& kept,
                                         std::span<std::uint8_t> items) {
  wire::ByteWriter out(items);
  out.put(version);
  for (std::uint8_t kind = 0; kind < pieces; ++kind) put_place(out, kind, *kept_place(kept, kind));
  put_number(out, kind_tool_length, kept.parameters.tool_length_e7);
  for (std::uint8_t i = 0; i < program::coordinate_systems; ++i)
    put_number(out, static_cast<std::uint8_t>(kind_rotation + i), kept.parameters.rotations_e7[i]);
  for (std::uint8_t i = 0; i < start_up_lines; ++i)
    put_text(out, static_cast<std::uint8_t>(kind_start_up + i), kept.start_up[i]);
  put_text(out, kind_build_text, kept.build_text);
  put_tools(out, kept.parameters.tools);
  return static_cast<std::uint32_t>(out.size());
}

std::uint32_t PersistentStateRecord::take(PersistentState& kept,
                                          std::span<const std::uint8_t> items) {
  wire::ByteReader in(items);
  if (in.take<std::uint8_t>() != version) return 1;
  std::uint32_t unknown = 0;
  while (in.left() != 0) {
    const auto kind = in.take<std::uint8_t>();
    const std::size_t size = in.take<std::uint8_t>();
    if (!in.ok() || size > in.left()) return unknown + 1;
    if (!take_piece(kept, kind, in.rest().first(size))) ++unknown;
    in = wire::ByteReader(in.rest().subspan(size));
  }
  return unknown;
}

}  // namespace lamplock::machine
