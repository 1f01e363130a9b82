#include "host/material/card.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/error.hpp"
#include "host/material/label_strokes.hpp"

namespace lamplock::material {
namespace {

/// The test piece of the depth model's source.
constexpr double depth_width_mm = 60, depth_height_mm = 20, depth_radius_mm = 3;
constexpr double card_gap_mm = 3, grid_gap_mm = 2;
constexpr double depth_label_mm = 4, grid_label_mm = 2.5, label_margin_mm = 1.5;

constexpr const char* card_place_name = "test card";

std::string text_of_cut(const CardCut& cut) {
  return fmt::format("F{:g} P{:g} N{}", cut.feed_mm_min, cut.power_w, cut.passes);
}

/// A label that is not wider than its place.
CardLabel fitted_label(std::string text, double x_mm, double y_mm, double height_mm,
                       double max_width_mm) {
  const double width_mm = label_width_mm(text, height_mm);
  return {std::move(text), x_mm, y_mm, height_mm * std::min(1.0, max_width_mm / width_mm)};
}

void lay_out_depth(const CardRequest& request, CardLayout& layout) {
  std::vector<CardCut> cuts;
  for (const int passes : request.passes)
    for (const double power_w : request.powers_w)
      for (const double feed_mm_min : request.feeds_mm_min)
        cuts.push_back({feed_mm_min, power_w, passes});
  const double pitch_mm = depth_height_mm + card_gap_mm;
  const auto max_rows = static_cast<std::size_t>(
      std::max(1.0, std::floor((request.max_height_mm + card_gap_mm) / pitch_mm)));
  const std::size_t rows = std::min(max_rows, cuts.size());
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const std::size_t column = i / rows;
    const double x_mm = static_cast<double>(column) * (depth_width_mm + card_gap_mm);
    const double y_mm = static_cast<double>(i % rows) * pitch_mm;
    layout.places.push_back({cuts[i], x_mm, y_mm});
    const double inside_mm = depth_width_mm - 2 * depth_radius_mm;
    layout.labels.push_back(fitted_label(text_of_cut(cuts[i]), x_mm + depth_radius_mm,
                                         y_mm + (depth_height_mm - depth_label_mm) / 2,
                                         depth_label_mm, inside_mm));
    layout.width_mm = std::max(layout.width_mm, x_mm + depth_width_mm);
    layout.height_mm = std::max(layout.height_mm, y_mm + depth_height_mm);
  }
}

void lay_out_grid(const CardRequest& request, CardLayout& layout) {
  const double pitch_mm = request.cell_mm + grid_gap_mm;
  const double label_row_mm = grid_label_mm + label_margin_mm;
  double left_mm = 0;
  for (const double power_w : request.powers_w)
    left_mm = std::max(left_mm, label_width_mm(fmt::format("P{:g}", power_w), grid_label_mm));
  left_mm += label_margin_mm;
  const auto columns = static_cast<double>(request.feeds_mm_min.size());
  layout.width_mm = left_mm + columns * pitch_mm - grid_gap_mm;
  double y_mm = 0;
  for (const int passes : request.passes) {
    for (std::size_t column = 0; column < request.feeds_mm_min.size(); ++column)
      layout.labels.push_back(fitted_label(fmt::format("F{:g}", request.feeds_mm_min[column]),
                                           left_mm + static_cast<double>(column) * pitch_mm, y_mm,
                                           grid_label_mm, request.cell_mm));
    layout.labels.push_back(fitted_label(fmt::format("N{}", passes), 0, y_mm, grid_label_mm,
                                         left_mm - label_margin_mm));
    y_mm += label_row_mm;
    for (const double power_w : request.powers_w) {
      layout.labels.push_back({fmt::format("P{:g}", power_w), 0,
                               y_mm + (request.cell_mm - grid_label_mm) / 2, grid_label_mm});
      for (std::size_t column = 0; column < request.feeds_mm_min.size(); ++column)
        layout.places.push_back({{request.feeds_mm_min[column], power_w, passes},
                                 left_mm + static_cast<double>(column) * pitch_mm,
                                 y_mm});
      y_mm += pitch_mm;
    }
    y_mm += card_gap_mm;
  }
  layout.height_mm = y_mm - card_gap_mm - grid_gap_mm;
}

void lay_out_kerf(const CardRequest& request, CardLayout& layout) {
  const CardCut cut{request.feeds_mm_min[0], request.powers_w[0], request.passes[0]};
  layout.width_mm = request.slats * request.pitch_mm;
  layout.height_mm = request.slat_length_mm + label_margin_mm + grid_label_mm;
  layout.places.push_back({cut, 0, 0});
  layout.labels.push_back(fitted_label(text_of_cut(cut), 0,
                                       request.slat_length_mm + label_margin_mm, grid_label_mm,
                                       layout.width_mm));
}

/// Writes lines of G-code. Coordinates are those of the card, moved to its place.
class CardWriter {
 public:
  CardWriter(const CardRequest& request, double x_mm, double y_mm)
      : request_(request), x_mm_(x_mm), y_mm_(y_mm) {}

  void line(const std::string& text) { (text_ += text) += '\n'; }
  void rapid(double x_mm, double y_mm) {
    line(fmt::format("G0 X{:.3f} Y{:.3f}", x_mm_ + x_mm, y_mm_ + y_mm));
  }
  /// The next move sets feed and power.
  void set(double feed_mm_min, double power_w) {
    words_ = fmt::format(" F{:.3f} S{:.3f}", feed_mm_min,
                         request_.laser.share_of(power_w) * request_.full_power_s);
  }
  void cut(double x_mm, double y_mm) {
    line(
        fmt::format("G1 X{:.3f} Y{:.3f}{}", x_mm_ + x_mm, y_mm_ + y_mm, std::exchange(words_, {})));
  }
  /// Counterclockwise, with the centre from its start.
  void arc(double x_mm, double y_mm, double i_mm, double j_mm) {
    line(fmt::format("G3 X{:.3f} Y{:.3f} I{:.3f} J{:.3f}", x_mm_ + x_mm, y_mm_ + y_mm, i_mm, j_mm));
  }
  std::string take() { return std::move(text_); }

 private:
  const CardRequest& request_;
  double x_mm_, y_mm_;
  std::string text_, words_;
};

void write_label(CardWriter& writer, const CardLabel& label) {
  for (const Stroke& stroke : label_strokes(label.text, label.height_mm)) {
    writer.rapid(label.x_mm + stroke[0].x_mm, label.y_mm + stroke[0].y_mm);
    for (std::size_t i = 1; i < stroke.size(); ++i)
      writer.cut(label.x_mm + stroke[i].x_mm, label.y_mm + stroke[i].y_mm);
  }
}

void write_rounded_rectangle(CardWriter& writer, const CardPlace& place) {
  const double left = place.x_mm, right = left + depth_width_mm, low = place.y_mm,
               high = low + depth_height_mm, r = depth_radius_mm;
  writer.rapid(left + r, low);
  for (int pass = 0; pass < place.cut.passes; ++pass) {
    writer.cut(right - r, low);
    writer.arc(right, low + r, 0, r);
    writer.cut(right, high - r);
    writer.arc(right - r, high, -r, 0);
    writer.cut(left + r, high);
    writer.arc(left, high - r, 0, -r);
    writer.cut(left, low + r);
    writer.arc(left + r, low, r, 0);
  }
}

void write_square(CardWriter& writer, const CardPlace& place, double side_mm) {
  const double left = place.x_mm, right = left + side_mm, low = place.y_mm, high = low + side_mm;
  writer.rapid(left, low);
  for (int pass = 0; pass < place.cut.passes; ++pass) {
    writer.cut(right, low);
    writer.cut(right, high);
    writer.cut(left, high);
    writer.cut(left, low);
  }
}

/// One line at all passes, back and forth.
void write_line(CardWriter& writer, const CardPlace& place, double x0, double y0, double x1,
                double y1) {
  writer.rapid(x0, y0);
  for (int pass = 0; pass < place.cut.passes; ++pass) {
    writer.cut(x1, y1);
    std::swap(x0, x1);
    std::swap(y0, y1);
  }
}

/// The slats are held at both ends until the last two cuts.
void write_comb(CardWriter& writer, const CardPlace& place, const CardRequest& request) {
  const double width_mm = request.slats * request.pitch_mm;
  for (int cut = 0; cut <= request.slats; ++cut) {
    const double x_mm = cut * request.pitch_mm;
    write_line(writer, place, x_mm, 0, x_mm, request.slat_length_mm);
  }
  write_line(writer, place, 0, 0, width_mm, 0);
  write_line(writer, place, width_mm, request.slat_length_mm, 0, request.slat_length_mm);
}

}  // namespace

CardLayout lay_out_card(const CardRequest& request) {
  const std::size_t cuts =
      request.feeds_mm_min.size() * request.powers_w.size() * request.passes.size();
  if (request.kind == CardKind::kerf && cuts != 1)
    throw Error(
        Exit::bad_input, card_place_name,
        fmt::format(
            "a comb has one feed, one power and one number of passes; {} combinations are given",
            cuts),
        "give one of each");
  if (cuts > max_card_cuts)
    throw Error(Exit::bad_input, card_place_name,
                fmt::format("it would have {} cuts, more than {}", cuts, max_card_cuts),
                "give fewer feeds, powers or passes");
  CardLayout layout;
  if (request.kind == CardKind::depth) lay_out_depth(request, layout);
  if (request.kind == CardKind::grid) lay_out_grid(request, layout);
  if (request.kind == CardKind::kerf) lay_out_kerf(request, layout);
  if (layout.width_mm > request.max_width_mm || layout.height_mm > request.max_height_mm)
    throw Error(Exit::bad_input, card_place_name,
                fmt::format("it is {:g} x {:g} mm, the work space {:g} x {:g} mm", layout.width_mm,
                            layout.height_mm, request.max_width_mm, request.max_height_mm),
                "give fewer feeds, powers or passes, or the profile of a larger machine");
  return layout;
}

std::string card_program(const CardRequest& request, const CardLayout& layout, double x_mm,
                         double y_mm) {
  CardWriter writer(request, x_mm, y_mm);
  // Bytes outside of ASCII are commands of the user to the board.
  std::string title = request.title;
  std::ranges::replace_if(
      title, [](char c) { return c < ' ' || c > '~' || c == '(' || c == ')'; }, '_');
  writer.line(fmt::format("({})", title));
  writer.line("G21 G90 G94 G17");
  writer.line("G0 X" + fmt::format("{:.3f} Y{:.3f}", x_mm, y_mm));
  writer.line("M4 S0");
  writer.line("(labels)");
  writer.set(request.label_feed_mm_min, request.label_power_w);
  for (const CardLabel& label : layout.labels) write_label(writer, label);
  if (request.air) writer.line("M8");
  for (const CardPlace& place : layout.places) {
    writer.line(fmt::format("({})", text_of_cut(place.cut)));
    writer.set(place.cut.feed_mm_min, place.cut.power_w);
    if (request.kind == CardKind::depth) write_rounded_rectangle(writer, place);
    if (request.kind == CardKind::grid) write_square(writer, place, request.cell_mm);
    if (request.kind == CardKind::kerf) write_comb(writer, place, request);
  }
  writer.line(request.air ? "M5 M9" : "M5");
  writer.line("G0 X" + fmt::format("{:.3f} Y{:.3f}", x_mm, y_mm));
  writer.line("M2");
  return writer.take();
}

}  // namespace lamplock::material
