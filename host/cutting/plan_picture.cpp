#include "host/cutting/plan_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host/svg.hpp"

namespace lamplock::cutting {
namespace {

// All lengths are pixels.
constexpr double view_width = 880, max_view_height = 880, min_view_height = 160;
constexpr double left = 64, top = 44, right = 190, below = 52, tick_length = 5;
constexpr double min_stroke = 0.9;
constexpr double max_ticks = 9;
/// Part of the view that stays free on each side.
constexpr double margin = 0.04;

constexpr std::array<const char*, 6> operation_colours{"#c0392b", "#7d3c98", "#117a65",
                                                       "#b9770e", "#1f618d", "#5d6d7e"};
constexpr const char* lead_colour = "#2e86c1";
constexpr const char* tab_colour = "#f39c12";
constexpr const char* overcut_colour = "#145a32";
constexpr const char* rapid_colour = "#8fa8bf";

const char* colour_of(std::size_t operation) {
  return operation_colours[operation % operation_colours.size()];
}

/// Millimetres to pixels, the same for both axes.
class PlanView {
 public:
  explicit PlanView(Box box) {
    const double size = std::max({box.high.x - box.low.x, box.high.y - box.low.y, 1e-3});
    box = box.grown(margin * size);
    const Vec extent = box.high - box.low;
    scale_ = std::min(view_width / extent.x, max_view_height / extent.y);
    height_ = std::clamp(extent.y * scale_, min_view_height, max_view_height);
    const Vec middle = (box.low + box.high) * 0.5;
    const Vec half{view_width / scale_ / 2, height_ / scale_ / 2};
    low_ = middle - half;
    high_ = middle + half;
  }
  double px(double x_mm) const { return left + (x_mm - low_.x) * scale_; }
  double py(double y_mm) const { return top + (high_.y - y_mm) * scale_; }
  double pixels(double mm) const { return mm * scale_; }
  double height() const { return height_; }
  const Vec& low() const { return low_; }
  const Vec& high() const { return high_; }
  /// A command of path data with a place: "M12.50 3.00".
  std::string at(const Vec& place, const char* command = "") const {
    return fmt::format("{}{:.2f} {:.2f}", command, px(place.x), py(place.y));
  }

 private:
  double scale_ = 1, height_ = 0;
  Vec low_, high_;
};

/// The data of an SVG path from the end of the edge before. An arc is at most half a circle there.
void append_edge(std::string& data, const PlanView& view, const Edge& edge) {
  if (edge.is_line()) {
    data += view.at(edge.to, "L");
  } else if (std::abs(edge.sweep) > std::numbers::pi * 0.99) {
    const Vec middle = point_at(edge, 0.5);
    append_edge(data, view, cut_out(edge, 0, 0.5, edge.from, middle));
    append_edge(data, view, cut_out(edge, 0.5, 1, middle, edge.to));
  } else {
    // The picture has y downwards: a turn to the left is one of sweep flag 0.
    const double radius = view.pixels(radius_of(edge));
    data += fmt::format("A{0:.2f} {0:.2f} 0 0 {1} {2}", radius, edge.sweep > 0 ? 0 : 1,
                        view.at(edge.to));
  }
}

std::string path_element(const std::string& data, const std::string& style) {
  return data.empty() ? "" : fmt::format("<path d=\"{}\" fill=\"none\" {}/>\n", data, style);
}

std::string stroke_style(const char* colour, double width, const char* rest = "") {
  return fmt::format("stroke=\"{}\" stroke-width=\"{:.2f}\" {}", colour,
                     std::max(width, min_stroke), rest);
}

class PlanPicture {
 public:
  PlanPicture(const CutPlan& plan, const std::vector<Shape>& shapes,
              const std::vector<Operation>& operations)
      : plan_(plan), shapes_(shapes), operations_(operations), view_(box()) {}

  std::string svg(const std::string& title) const {
    const double width = left + view_width + right, height = top + view_.height() + below;
    std::string out = svg::opening(width, height);
    out += svg::heading(left, 26, title);
    return out + axes() + moves() + drawing() + rapids() + labels() + legend() + "</svg>\n";
  }

 private:
  Box box() const {
    Box box;
    box.add(Vec{0, 0});
    for (const PlannedCut& cut : plan_.cuts)
      for (const Stroke& stroke : cut.strokes)
        for (const CutMove& move : stroke) box.add(box_of(move.edge));
    for (const Shape& shape : shapes_) box.add(box_of(shape.contour));
    return box;
  }

  std::string axes() const {
    const double bottom = top + view_.height();
    std::string out = fmt::format(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{:.1f}\" fill=\"#fff\" stroke=\"#999\"/>\n",
        left, top, view_width, view_.height());
    const double step = svg::nice_step(view_.high().x - view_.low().x, max_ticks);
    const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
    const auto number = [&](double k) { return fmt::format("{:.{}f}", k * step + 0.0, decimals); };
    for (double k = std::ceil(view_.low().x / step); k * step < view_.high().x; ++k) {
      const double x = view_.px(k * step);
      out += svg::line(x, bottom, x, bottom + tick_length, "#999");
      out += svg::text_at(x, bottom + 18, "middle", number(k));
    }
    for (double k = std::ceil(view_.low().y / step); k * step < view_.high().y; ++k) {
      const double y = view_.py(k * step);
      out += svg::line(left - tick_length, y, left, y, "#999");
      out += svg::text_at(left - 8, y + 4, "end", number(k));
    }
    out += svg::text_at(left + view_width / 2, bottom + 38, "middle", "X / mm");
    return out + svg::turned_text(16, top + view_.height() / 2, "Y / mm");
  }

  static const char* colour_of_move(const CutMove& move, std::size_t operation) {
    switch (move.kind) {
      case CutKind::lead_in:
      case CutKind::lead_out:
        return lead_colour;
      case CutKind::tab:
        return tab_colour;
      case CutKind::overcut:
        return overcut_colour;
      case CutKind::cut:
        break;
    }
    return colour_of(operation);
  }

  /// The area that the beam removes, moves of one colour as one path.
  std::string moves() const {
    std::string out;
    for (const PlannedCut& cut : plan_.cuts) {
      const double width = view_.pixels(operations_[cut.operation].kerf_mm);
      std::string data, dark;
      const char* colour = nullptr;
      const auto close = [&] {
        if (data.empty()) return;
        // The ends of the cut are round, also at a tab.
        const std::string ends = colour == tab_colour ? "butt" : "round";
        const std::string style =
            "stroke-opacity=\"0.75\" stroke-linecap=\"" + ends + "\" stroke-linejoin=\"round\"";
        out += path_element(data, stroke_style(colour, width, style.c_str()));
        data.clear();
      };
      for (const Stroke& stroke : cut.strokes) {
        bool is_joined = false;
        for (const CutMove& move : stroke) {
          const bool is_dark = move.power <= 0 && move.kind != CutKind::tab;
          const char* own = colour_of_move(move, cut.operation);
          if (!is_dark && own != colour) {
            close();
            is_joined = false;
          }
          if (!is_dark) colour = own;
          std::string& to = is_dark ? dark : data;
          if (is_dark || !is_joined) to += view_.at(move.edge.from, "M");
          append_edge(to, view_, move.edge);
          is_joined = !is_dark;
        }
      }
      close();
      out += path_element(dark, stroke_style(rapid_colour, 0.8, "stroke-dasharray=\"2 2\""));
    }
    return out;
  }

  /// The contours as drawn.
  std::string drawing() const {
    std::string worked, other;
    for (const Shape& shape : shapes_) {
      const bool is_worked =
          shape.operation && operations_[*shape.operation].kind != OperationKind::ignore;
      std::string& data = is_worked ? worked : other;
      data += view_.at(shape.contour.edges.front().from, "M");
      for (const Edge& edge : shape.contour.edges) append_edge(data, view_, edge);
    }
    return path_element(other, "stroke=\"#bbb\" stroke-width=\"0.6\" stroke-dasharray=\"1 2\"") +
           path_element(worked, "stroke=\"#222\" stroke-width=\"0.4\"");
  }

  std::string rapids() const {
    std::string data;
    Vec at{0, 0};
    for (const PlannedCut& cut : plan_.cuts) {
      for (const Stroke& stroke : cut.strokes) {
        data += view_.at(at, "M") + view_.at(stroke.front().edge.from, "L");
        at = stroke.back().edge.to;
      }
    }
    return path_element(data, stroke_style(rapid_colour, 0.8, "stroke-dasharray=\"4 3\""));
  }

  /// The number of each cut where the beam is switched on, and a dot there.
  std::string labels() const {
    const double count = static_cast<double>(plan_.cuts.size());
    const double size = std::clamp(90 / std::sqrt(std::max(count, 1.0)), 3.0, 12.0);
    std::string out = fmt::format(
        "<g font-size=\"{:.1f}\" font-weight=\"bold\" stroke=\"#fff\" "
        "stroke-width=\"2.5\" paint-order=\"stroke\">\n",
        size);
    std::string dots;
    for (std::size_t i = 0; i < plan_.cuts.size(); ++i) {
      const Vec& at = plan_.cuts[i].strokes.front().front().edge.from;
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>\n",
                          view_.px(at.x), view_.py(at.y), std::max(1.2, size / 5), lead_colour);
      out += svg::text_at(view_.px(at.x) + size / 3, view_.py(at.y) - size / 3, "start",
                          fmt::format("{}", plan_.cuts[i].number));
    }
    return dots + out + "</g>\n";
  }

  std::string legend() const {
    const double x = left + view_width + 16;
    double y = top + 10;
    std::string out;
    const auto row = [&](const char* colour, double width, const char* dashes,
                         const std::string& text) {
      out += fmt::format("<g stroke-width=\"{:.1f}\">{}</g>\n", width,
                         svg::line(x, y, x + 26, y, colour, dashes));
      out += svg::text_at(x + 32, y + 4, "start", text);
      y += 20;
    };
    for (std::size_t i = 0; i < operations_.size(); ++i) {
      if (operations_[i].kind == OperationKind::ignore) continue;
      constexpr std::size_t max_name = 20;
      row(colour_of(i), 4, "", operations_[i].name.substr(0, max_name));
    }
    row("#222", 0.6, "", "drawing");
    row(lead_colour, 4, "", "lead");
    row(tab_colour, 4, "", "tab");
    row(overcut_colour, 4, "", "overcut");
    row(rapid_colour, 1, "4 3", "rapid, dark");
    return out + svg::text_at(x, y + 4, "start", "numbers: order");
  }

  const CutPlan& plan_;
  const std::vector<Shape>& shapes_;
  const std::vector<Operation>& operations_;
  PlanView view_;
};

}  // namespace

std::string plan_svg(const CutPlan& plan, const std::vector<Shape>& shapes,
                     const std::vector<Operation>& operations, const std::string& title) {
  return PlanPicture(plan, shapes, operations).svg(title);
}

}  // namespace lamplock::cutting
