#include "host/material/records.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "host/error.hpp"
#include "host/material/fields.hpp"
#include "host/printable.hpp"
#include "host/suggestion.hpp"

namespace lamplock::material {
namespace {

constexpr std::size_t max_name_bytes = 64, max_text_bytes = 1000;

[[noreturn]] void refuse_field(const std::string& where, std::string_view key,
                               const std::string& what, const std::string& remedy) {
  throw Error(Exit::bad_input, where, fmt::format("'{}' {}", key, what), remedy);
}

/// A name is one word of a command line that no shell changes.
bool is_name(std::string_view text) {
  const auto is_part = [](char c) {
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    const bool is_of_utf8 = (static_cast<unsigned char>(c) & 0x80u) != 0;
    return is_letter || is_of_utf8 || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.' ||
           c == '+';
  };
  return !text.empty() && text.front() != '-' && std::ranges::all_of(text, is_part);
}

void check_text(const Field& field, const std::string& text, const std::string& where) {
  if (text.empty()) {
    if (field.is_required) refuse_field(where, field.key, "is missing", "give a name");
    return;
  }
  if (printable(text) != text)
    refuse_field(where, field.key, "has characters that cannot be printed",
                 "write one line of text in UTF-8");
  if (text.size() > (field.is_name ? max_name_bytes : max_text_bytes))
    refuse_field(where, field.key, fmt::format("has {} bytes", text.size()),
                 fmt::format("use at most {}", field.is_name ? max_name_bytes : max_text_bytes));
  if (field.is_name && !is_name(text))
    refuse_field(where, field.key, fmt::format("is '{}'", text),
                 "use letters, digits, '-', '_', '.' and '+', no '-' at the beginning");
  if (!field.names.empty() && std::ranges::find(field.names, text) == field.names.end())
    refuse_field(
        where, field.key, fmt::format("is '{}'", text),
        did_you_mean(text, field.names, fmt::format("give {}", fmt::join(field.names, ", "))));
}

void check_number(const Field& field, double value, const std::string& where) {
  if (std::isfinite(value) && field.range.has(value)) return;
  if (field.is_required && value == 0)
    refuse_field(where, field.key, "is missing or 0", "give " + field.range.text());
  refuse_field(where, field.key, fmt::format("is {}", value), "give " + field.range.text());
}

/// Each field by itself.
struct FieldCheck {
  const Field& field;
  const std::string& where;

  void operator()(const double* value) const { check_number(field, *value, where); }
  void operator()(const std::optional<double>* value) const {
    if (*value) check_number(field, **value, where);
  }
  void operator()(const int* value) const { check_number(field, *value, where); }
  void operator()(const bool* /*value*/) const {}
  void operator()(const std::string* value) const { check_text(field, *value, where); }
};

template <class Record>
void check_fields(Record record, const std::string& where) {
  for (const Field& field : fields(record)) std::visit(FieldCheck{field, where}, field.place);
}

}  // namespace

cutting::BeamShape Laser::beam() const {
  const double height_mm = beam_height_mm.value_or(beam_width_mm);
  if (beam_shape == "round") return cutting::RoundBeam{beam_width_mm / 2};
  if (beam_shape == "ellipse") return cutting::EllipticBeam{beam_width_mm / 2, height_mm / 2};
  return cutting::RectangularBeam{beam_width_mm, height_mm};
}

void check_record(const Laser& laser, const std::string& where) {
  check_fields(laser, where);
  if (laser.beam_shape == "round" &&
      laser.beam_height_mm.value_or(laser.beam_width_mm) != laser.beam_width_mm)
    refuse_field(where, "beam_height_mm", "differs from the width of a round beam",
                 "leave it out, or use beam_shape ellipse");
}

void check_record(const Material& material, const std::string& where) {
  check_fields(material, where);
}

void check_record(const Setting& setting, const std::string& where) {
  check_fields(setting, where);
  if (setting.min_feed_mm_min.value_or(setting.feed_mm_min) > setting.feed_mm_min)
    refuse_field(where, "min_feed_mm_min", "is more than feed_mm_min", "give the slowest feed");
  if (setting.max_feed_mm_min.value_or(setting.feed_mm_min) < setting.feed_mm_min)
    refuse_field(where, "max_feed_mm_min", "is less than feed_mm_min", "give the fastest feed");
}

void check_record(const Measurement& measurement, const std::string& where) {
  check_fields(measurement, where);
  if (!measurement.depth_mm && measurement.result.empty())
    refuse_field(where, "depth_mm", "is missing", "give the measured depth, or result");
  if (measurement.depth_mm && measurement.result == "cut")
    refuse_field(where, "depth_mm", "is given for a cut that came through",
                 "leave it out, or the result");
  if (measurement.depth_mm && measurement.thickness_mm &&
      *measurement.depth_mm > *measurement.thickness_mm)
    refuse_field(where, "depth_mm", "is more than thickness_mm",
                 "give the depth of the groove; result = cut if the cut came through");
}

}  // namespace lamplock::material
