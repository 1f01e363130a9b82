#include "firmware/program/variables.hpp"

namespace lamplock::program {

std::string_view Variables::name_of(Key key) const {
  const std::size_t place = key ^ name_bit;
  return {names_.data() + place + 1, static_cast<unsigned char>(names_[place])};
}

/// The key of a name that is in force or new in this line; none without one.
Variables::Key Variables::key_of(std::string_view name) const {
  for (std::size_t place = 0; place < line_names_size_;) {
    const Key key = static_cast<Key>(place | name_bit);
    const std::string_view other = name_of(key);
    if (other == name) return key;
    place += other.size() + 1;
  }
  return none;
}

/// Index of a key among the first values; their number if it is not there.
std::uint32_t Variables::place_of(Key key, std::uint32_t size) const {
  std::uint32_t i = 0;
  while (i < size && keys_[i] != key) ++i;
  return i;
}

std::int64_t Variables::value_e9(std::uint32_t number) const {
  const std::uint32_t i = place_of(static_cast<Key>(number), size_);
  return i < size_ ? values_e9_[i] : 0;
}

bool Variables::find(std::string_view name, std::int64_t& value_e9) const {
  const Key key = key_of(name);
  if (key == none) return false;
  const std::uint32_t i = place_of(key, size_);
  if (i == size_) return false;
  value_e9 = values_e9_[i];
  return true;
}

GcodeError Variables::add(Key key, std::int64_t value_e9) {
  const std::uint32_t i = std::uint32_t{size_} + assignments_;
  if (i == capacity) return GcodeError::no_room;
  keys_[i] = key;
  values_e9_[i] = value_e9;
  ++assignments_;
  return GcodeError::none;
}

GcodeError Variables::assign(std::uint32_t number, std::int64_t value_e9) {
  return add(static_cast<Key>(number), value_e9);
}

GcodeError Variables::assign(std::string_view name, std::int64_t value_e9) {
  if (const Key key = key_of(name); key != none) return add(key, value_e9);
  if (line_names_size_ + name.size() + 1 > name_characters) return GcodeError::no_room;
  const Key key = static_cast<Key>(line_names_size_ | name_bit);
  if (const GcodeError error = add(key, value_e9); error != GcodeError::none) return error;
  names_[line_names_size_++] = static_cast<char>(name.size());
  for (const char c : name) names_[line_names_size_++] = c;
  return GcodeError::none;
}

void Variables::commit() {
  const std::uint32_t first = size_, end = std::uint32_t{size_} + assignments_;
  for (std::uint32_t from = first; from < end; ++from) {
    const Key key = keys_[from];
    const std::int64_t value_e9 = values_e9_[from];
    std::uint32_t to = place_of(key, size_);
    const bool is_unset = value_e9 == 0 && !is_name(key);
    if (is_unset && to == size_) continue;
    if (is_unset) {
      --size_;
      keys_[to] = keys_[size_];
      values_e9_[to] = values_e9_[size_];
      continue;
    }
    if (to == size_) ++size_;
    keys_[to] = key;
    values_e9_[to] = value_e9;
  }
  assignments_ = 0;
  names_size_ = line_names_size_;
}

void Variables::drop() {
  assignments_ = 0;
  line_names_size_ = names_size_;
}

void Variables::clear() { size_ = assignments_ = names_size_ = line_names_size_ = 0; }

}  // namespace lamplock::program
