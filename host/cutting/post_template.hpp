// Filled templates of a post-processor, and the numbers in them.
//
// In:  the templates of one controller, values. Out: lines of a program.
// Who: the writer of programs (post.cpp).
//
// Templates are taken to pieces once, because programs have up to millions of lines.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host/cutting/post.hpp"

namespace lamplock::cutting {

/// A number without trailing zeros.
std::string post_number(double value, int decimals);

/// Fills templates, and knows which values have changed.
class PostTemplates {
 public:
  /// The templates must have no faults (template_fault()).
  explicit PostTemplates(const Post& post);

  void set(PostValue value, std::string text) { values_[at(value)] = std::move(text); }
  const std::string& value(PostValue value) const { return values_[at(value)]; }
  /// True if a line has this value.
  bool uses(PostValue value) const { return (used_ & bit(at(value))) != 0; }

  /// Appends the lines of an event, without those that are empty; returns their number.
  std::size_t append(PostEvent event, std::string& program);

 private:
  static constexpr std::size_t value_count = post_value_names.size();

  enum class PieceKind : std::uint8_t { text, value, part_begin, part_end };
  struct Piece {
    PieceKind kind;
    std::string text{};     ///< of a text
    std::size_t value = 0;  ///< number of a value
  };
  struct Template {
    std::vector<Piece> pieces{};
    /// Values whose words the line has with a number of its own: after S0 a part [ S{power}] must
    /// be written again.
    std::uint32_t fixed = 0;
  };

  static std::size_t at(PostValue value) { return static_cast<std::size_t>(value); }
  static std::uint32_t bit(std::size_t value) { return std::uint32_t{1} << value; }
  Template template_of(const std::string& text);
  void fill(const Template& line, std::string& program);

  std::array<std::vector<Template>, post_event_names.size()> lines_;
  std::uint32_t used_ = 0;  ///< a bit for each value
  /// Values now, and in the last line with each of them.
  std::array<std::string, value_count> values_{}, written_{};
};

}  // namespace lamplock::cutting
