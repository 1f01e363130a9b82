#include "host/lettering/font.hpp"

#include <fmt/format.h>
#include <fontconfig/fontconfig.h>
#include <hb-ot.h>
#include <hb.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/error.hpp"
#include "host/file.hpp"
#include "host/letter_case.hpp"

namespace lamplock::lettering {

/// Frees an object of a C library. Not in the namespace below, because Font::Shaper contains it.
template <class Type, void (*destroy)(Type*)>
struct Destroy {
  void operator()(Type* object) const { destroy(object); }
};
template <class Type, void (*destroy)(Type*)>
using Owned = std::unique_ptr<Type, Destroy<Type, destroy>>;

namespace {

namespace fs = std::filesystem;
using geometry::Point;

/// The outline of one glyph, built by the callbacks of HarfBuzz.
class Pen {
 public:
  Pen(std::vector<model::Path>& paths, Point origin, double scale)
      : paths_(paths), origin_(origin), scale_(scale) {}

  void move_to(double x, double y) {
    close();
    path_ = {};
    begin_ = at_ = place(x, y);
  }
  void line_to(double x, double y) { append({place(x, y)}); }
  void curve_to(std::vector<Point> poles) {
    for (Point& pole : poles) pole = place(pole.x, pole.y);
    append(poles);
  }
  void close() {
    if (path_.pieces.empty()) return;
    if (at_ != begin_) path_.pieces.emplace_back(model::Line{at_, begin_});
    path_.closed = true;
    paths_.push_back(std::exchange(path_, {}));
  }

 private:
  Point place(double x, double y) const {
    return {origin_.x + x * scale_, origin_.y + y * scale_, 0};
  }
  /// A line or a Bezier curve from the present place.
  void append(const std::vector<Point>& poles) {
    if (poles.size() == 1) {
      if (poles[0] != at_) path_.pieces.emplace_back(model::Line{at_, poles[0]});
    } else {
      model::Spline spline;
      spline.degree = static_cast<int>(poles.size());
      spline.poles = {at_};
      spline.poles.insert(spline.poles.end(), poles.begin(), poles.end());
      spline.knots.assign(spline.poles.size(), 0);
      spline.knots.resize(2 * spline.poles.size(), 1);
      path_.pieces.emplace_back(std::move(spline));
    }
    at_ = poles.back();
  }

  std::vector<model::Path>& paths_;
  Point origin_;
  double scale_;
  model::Path path_;
  Point begin_, at_;
};

Pen& pen_of(void* data) { return *static_cast<Pen*>(data); }

hb_draw_funcs_t* new_draw_functions() {
  hb_draw_funcs_t* functions = hb_draw_funcs_create();
  hb_draw_funcs_set_move_to_func(
      functions,
      [](hb_draw_funcs_t*, void* pen, hb_draw_state_t*, float x, float y, void*) {
        pen_of(pen).move_to(x, y);
      },
      nullptr, nullptr);
  hb_draw_funcs_set_line_to_func(
      functions,
      [](hb_draw_funcs_t*, void* pen, hb_draw_state_t*, float x, float y, void*) {
        pen_of(pen).line_to(x, y);
      },
      nullptr, nullptr);
  hb_draw_funcs_set_quadratic_to_func(
      functions,
      [](hb_draw_funcs_t*, void* pen, hb_draw_state_t*, float cx, float cy, float x, float y,
         void*) {
        pen_of(pen).curve_to({{cx, cy, 0}, {x, y, 0}});
      },
      nullptr, nullptr);
  hb_draw_funcs_set_cubic_to_func(
      functions,
      [](hb_draw_funcs_t*, void* pen, hb_draw_state_t*, float ax, float ay, float bx, float by,
         float x, float y, void*) {
        pen_of(pen).curve_to({{ax, ay, 0}, {bx, by, 0}, {x, y, 0}});
      },
      nullptr, nullptr);
  hb_draw_funcs_set_close_path_func(
      functions, [](hb_draw_funcs_t*, void* pen, hb_draw_state_t*, void*) { pen_of(pen).close(); },
      nullptr, nullptr);
  return functions;
}

}  // namespace

struct Font::Shaper {
  Owned<hb_font_t, hb_font_destroy> font;
  Owned<hb_draw_funcs_t, hb_draw_funcs_destroy> functions;
  double size = 1;  ///< of the font in its units
};

Font::Font(const fs::path& file, unsigned index)
    : file_(file), shaper_(std::make_unique<Shaper>()) {
  const std::string bytes = read_file(file);
  Owned<hb_blob_t, hb_blob_destroy> blob(
      hb_blob_create(bytes.data(), static_cast<unsigned>(bytes.size()), HB_MEMORY_MODE_DUPLICATE,
                     nullptr, nullptr));
  Owned<hb_face_t, hb_face_destroy> face(hb_face_create(blob.get(), index));
  if (hb_face_get_glyph_count(face.get()) == 0)
    throw Error(Exit::bad_input, file.string(), "is not a TrueType or OpenType font",
                "give a font file (ttf, otf) or the name of a font");
  shaper_->font.reset(hb_font_create(face.get()));
  shaper_->functions.reset(new_draw_functions());
  shaper_->size = hb_face_get_upem(face.get());
  hb_font_t* font = shaper_->font.get();
  // Of a font that does not say it: as of common fonts.
  constexpr double usual_descent = 0.2;
  hb_position_t down = 0;
  const bool has_descent =
      hb_ot_metrics_get_position(font, HB_OT_METRICS_TAG_HORIZONTAL_DESCENDER, &down) != 0;
  descent_ = has_descent ? std::abs(down / shaper_->size) : usual_descent;
  model::Curves letter;
  letter.paths = line("H").paths;
  capital_ = bounds(letter).high.y;
  if (!(capital_ > 0))
    throw Error(Exit::bad_input, file.string(), "the font has no outlines of Latin letters",
                "give another font");
}

Font::~Font() = default;

LetteredLine Font::line(const std::string& text) const {
  Owned<hb_buffer_t, hb_buffer_destroy> buffer(hb_buffer_create());
  hb_buffer_add_utf8(buffer.get(), text.data(), static_cast<int>(text.size()), 0, -1);
  hb_buffer_guess_segment_properties(buffer.get());
  hb_shape(shaper_->font.get(), buffer.get(), nullptr, 0);
  unsigned count = 0;
  const hb_glyph_info_t* glyphs = hb_buffer_get_glyph_infos(buffer.get(), &count);
  const hb_glyph_position_t* places = hb_buffer_get_glyph_positions(buffer.get(), &count);
  LetteredLine line;
  const double scale = 1 / shaper_->size;
  for (unsigned i = 0; i < count; ++i) {
    if (glyphs[i].codepoint == 0) {
      ++line.missing;
    } else {
      Pen pen(line.paths, {line.width + places[i].x_offset * scale, places[i].y_offset * scale, 0},
              scale);
      hb_font_get_glyph_shape(shaper_->font.get(), glyphs[i].codepoint, shaper_->functions.get(),
                              &pen);
      pen.close();
    }
    line.width += places[i].x_advance * scale;
  }
  return line;
}

namespace {

using Pattern = Owned<FcPattern, FcPatternDestroy>;

FcChar8* text_for_fontconfig(const std::string& text) {
  return const_cast<FcChar8*>(reinterpret_cast<const FcChar8*>(text.c_str()));
}

/// The families of a pattern, as fontconfig compares them: without blanks and cases.
std::vector<std::string> families_of(const FcPattern* pattern) {
  std::vector<std::string> families;
  FcChar8* name = nullptr;
  for (int i = 0; FcPatternGetString(pattern, FC_FAMILY, i, &name) == FcResultMatch; ++i) {
    std::string plain = in_lower_case(reinterpret_cast<const char*>(name));
    std::erase(plain, ' ');
    families.push_back(std::move(plain));
  }
  return families;
}

bool has_common(const std::vector<std::string>& some, const std::vector<std::string>& others) {
  return std::any_of(some.begin(), some.end(), [&](const std::string& one) {
    return std::find(others.begin(), others.end(), one) != others.end();
  });
}

/// The families that the configuration of the computer permits for a pattern, in their order.
std::vector<std::string> substitutes_of(FcPattern* pattern) {
  FcConfigSubstitute(nullptr, pattern, FcMatchPattern);
  return families_of(pattern);
}

/// fontconfig has a font for every name. This one is meant if its family was asked for, if the name
/// is one of the generic ones, or if the configuration has an alias: a family beyond those that it
/// permits for any unknown name.
bool is_meant(const std::vector<std::string>& asked, std::vector<std::string> substitutes,
              const std::vector<std::string>& found) {
  static const std::vector<std::string> generic{
      "sans",    "sans-serif", "sansserif", "serif",         "mono",     "monospace",
      "cursive", "fantasy",    "system-ui", "ui-sans-serif", "ui-serif", "ui-monospace"};
  if (asked.empty() || has_common(asked, found) || has_common(asked, generic)) return true;
  const std::string unknown = "lamplock has no such font";
  const Pattern any(FcNameParse(text_for_fontconfig(unknown)));
  if (!any) return true;
  const std::vector<std::string> of_any = substitutes_of(any.get());
  std::erase_if(substitutes, [&](const std::string& family) {
    return std::find(of_any.begin(), of_any.end(), family) != of_any.end();
  });
  return has_common(substitutes, found);
}

/// The file of a font and its number in it.
struct FontPlace {
  fs::path file;
  unsigned index = 0;
};

std::optional<FontPlace> place_of_font(const std::string& name) {
  const Pattern wanted(FcNameParse(text_for_fontconfig(name)));
  if (!wanted || FcInit() != FcTrue) return std::nullopt;
  const std::vector<std::string> asked = families_of(wanted.get());
  FcPatternAddBool(wanted.get(), FC_SCALABLE, FcTrue);
  const std::vector<std::string> substitutes = substitutes_of(wanted.get());
  FcDefaultSubstitute(wanted.get());
  FcResult result = FcResultNoMatch;
  const Pattern found(FcFontMatch(nullptr, wanted.get(), &result));
  FcChar8 *file = nullptr, *family = nullptr;
  if (!found || FcPatternGetString(found.get(), FC_FILE, 0, &file) != FcResultMatch)
    return std::nullopt;
  if (!is_meant(asked, substitutes, families_of(found.get()))) {
    FcPatternGetString(found.get(), FC_FAMILY, 0, &family);
    throw Error(Exit::bad_input, name, "this computer has no font of this name",
                fmt::format("give a font file (ttf, otf), sans, serif, mono, or a name that "
                            "fc-list shows, such as '{}'",
                            family == nullptr ? "" : reinterpret_cast<const char*>(family)));
  }
  int index = 0;
  FcPatternGetInteger(found.get(), FC_INDEX, 0, &index);
  return FontPlace{reinterpret_cast<const char*>(file), static_cast<unsigned>(index) & 0xffffU};
}

}  // namespace

std::unique_ptr<Font> font_named(const std::string& name_or_file) {
  std::error_code unknown;
  if (fs::is_regular_file(name_or_file, unknown)) return std::make_unique<Font>(name_or_file);
  const std::string ending = lower_extension(name_or_file);
  if (ending == ".ttf" || ending == ".otf") return std::make_unique<Font>(name_or_file);
  const std::optional<FontPlace> place = place_of_font(name_or_file);
  if (!place)
    throw Error(Exit::bad_input, name_or_file, "this computer has no font for the name",
                "give a font file (ttf, otf)");
  return std::make_unique<Font>(place->file, place->index);
}

}  // namespace lamplock::lettering
