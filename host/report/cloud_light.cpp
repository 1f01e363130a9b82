#include "host/report/cloud_light.hpp"

#include <array>
#include <cstdint>

namespace lamplock::report {
namespace {

/// Signed arithmetic as an index; the result is not negative.
std::size_t index_of(int i) { return static_cast<std::size_t>(i); }

constexpr Vec near_colour{1.0f, 0.98f, 0.95f};
constexpr Vec far_colour{0.42f, 0.66f, 1.0f};

constexpr float min_sigma = 0.62f;  ///< pixels, before perspective
constexpr float min_size = 0.55f;   ///< pixels, after
constexpr float max_sigma = 2.4f;
constexpr int max_radius = 12;

/// Share of light that the polished bottom of the block reflects.
constexpr float bottom_reflection = 0.07f;

/// True if the mirror image of a point below the bottom of the block is visible in that bottom.
bool seen_in_bottom(Vec mirrored, const Box& block, Vec eye) {
  const float t = (block.low.z - eye.z) / (mirrored.z - eye.z);
  const Vec p = eye + (mirrored - eye) * t;
  return p.x > block.low.x && p.x < block.high.x && p.y > block.low.y && p.y < block.high.y;
}

/// Area of the picture that the cloud covers, in pixels, by a coarse grid.
float covered_pixels(const std::vector<Camera::Projected>& places, int width, int height) {
  constexpr int cell = 8;
  const int columns = (width + cell - 1) / cell, rows = (height + cell - 1) / cell;
  std::vector<bool> covered(index_of(columns) * index_of(rows));
  std::size_t count = 0;
  for (const Camera::Projected& p : places) {
    const int x = static_cast<int>(p.x) / cell, y = static_cast<int>(p.y) / cell;
    if (x < 0 || y < 0 || x >= columns || y >= rows) continue;
    const std::size_t i = index_of(y) * index_of(columns) + index_of(x);
    if (!covered[i]) ++count;
    covered[i] = true;
  }
  return static_cast<float>(count * cell * cell);
}

/// Adds one Gaussian sprite of total light `light`.
void add_sprite(Image& image, const Camera::Projected& place, float sigma, Vec light) {
  const int radius = std::min(max_radius, static_cast<int>(std::ceil(2.6f * sigma)));
  const int cx = static_cast<int>(std::floor(place.x)), cy = static_cast<int>(std::floor(place.y));
  if (cx < radius || cy < radius || cx + radius >= image.width || cy + radius >= image.height)
    return;
  std::array<float, 2 * max_radius + 1> wx{}, wy{};
  float sum_x = 0, sum_y = 0;
  const float narrow = 0.5f / (sigma * sigma);
  for (int i = -radius; i <= radius; ++i) {
    const float dx = static_cast<float>(cx + i) + 0.5f - place.x;
    const float dy = static_cast<float>(cy + i) + 0.5f - place.y;
    const auto k = index_of(i + radius);
    sum_x += wx[k] = std::exp(-dx * dx * narrow);
    sum_y += wy[k] = std::exp(-dy * dy * narrow);
  }
  const Vec each = light * (1 / (sum_x * sum_y));
  for (int y = -radius; y <= radius; ++y) {
    const Vec row = each * wy[index_of(y + radius)];
    Vec* pixel = &image.at(cx - radius, cy + y);
    for (int x = 0; x <= 2 * radius; ++x) pixel[x] += row * wx[index_of(x)];
  }
}

/// Brightness of the brighter part of the cloud: `share` of the lit pixels are darker than this.
float percentile_brightness(const Image& image, float share) {
  std::vector<float> values;
  for (const Vec& pixel : image.pixels)
    if (pixel.y > 0) values.push_back(luminance(pixel));
  if (values.empty()) return 1;
  const float largest = *std::max_element(values.begin(), values.end());
  std::erase_if(values, [largest](float v) { return v < 1e-3f * largest; });
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<float>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

/// One pass of a box blur along rows or columns, edges black.
void box_blur(std::vector<Vec>& line, std::vector<Vec>& result, int radius) {
  const int n = static_cast<int>(line.size());
  const float scale = 1 / static_cast<float>(2 * radius + 1);
  Vec sum;
  for (int i = 0; i < std::min(radius, n); ++i) sum += line[index_of(i)];
  for (int i = 0; i < n; ++i) {
    if (i + radius < n) sum += line[index_of(i + radius)];
    if (i - radius - 1 >= 0) sum += line[index_of(i - radius - 1)] * -1.0f;
    result[index_of(i)] = sum * scale;
  }
  line.swap(result);
}

/// Three box blurs make nearly a Gaussian.
Image blurred(const Image& image, int radius) {
  Image result = image;
  std::vector<Vec> line(static_cast<std::size_t>(image.width)), spare(line.size());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) line[index_of(x)] = result.at(x, y);
    for (int pass = 0; pass < 3; ++pass) box_blur(line, spare, radius);
    for (int x = 0; x < image.width; ++x) result.at(x, y) = line[index_of(x)];
  }
  line.resize(static_cast<std::size_t>(image.height));
  spare.resize(line.size());
  for (int x = 0; x < image.width; ++x) {
    for (int y = 0; y < image.height; ++y) line[index_of(y)] = result.at(x, y);
    for (int pass = 0; pass < 3; ++pass) box_blur(line, spare, radius);
    for (int y = 0; y < image.height; ++y) result.at(x, y) = line[index_of(y)];
  }
  return result;
}

/// Half the size, for the bloom.
Image halved(const Image& image) {
  Image result(image.width / 2, image.height / 2);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      result.at(x, y) = (image.at(2 * x, 2 * y) + image.at(2 * x + 1, 2 * y) +
                         image.at(2 * x, 2 * y + 1) + image.at(2 * x + 1, 2 * y + 1)) *
                        0.25f;
  return result;
}

void add_bloom(Image& image) {
  const Image half = halved(image);
  if (half.width == 0 || half.height == 0) return;
  const Image fine = blurred(half, std::max(1, image.width / 400));
  const Image wide = blurred(half, std::max(2, image.width / 70));
  for (int y = 0; y < 2 * half.height; ++y)
    for (int x = 0; x < 2 * half.width; ++x)
      image.at(x, y) += fine.at(x / 2, y / 2) * 0.22f + wide.at(x / 2, y / 2) * 0.16f;
}

/// Compresses brightness, keeps colour: fine shades in the thin parts, no white patches in the
/// dense ones.
void expose(Image& image) {
  const float reference = percentile_brightness(image, 0.93f);
  for (Vec& pixel : image.pixels) {
    const float value = luminance(pixel) / reference;
    if (value <= 0) continue;
    const float shown = 1 - std::exp(-1.25f * std::pow(value, 0.85f));
    pixel = pixel * (shown / (value * reference));
  }
}

}  // namespace

Image cloud_light(const std::vector<Vec>& points, const Box& block, const Camera& camera, int width,
                  int height) {
  Image image(width, height);
  std::vector<Camera::Projected> places;
  places.reserve(points.size());
  for (const Vec& point : points) places.push_back(camera.project(point));
  if (places.empty()) return image;
  const auto by_depth = [](const auto& a, const auto& b) { return a.depth < b.depth; };
  const auto [nearest, farthest] = std::minmax_element(places.begin(), places.end(), by_depth);
  const float near = nearest->depth, range = std::max(farthest->depth - near, 1e-3f * near);
  const float area = covered_pixels(places, width, height);
  const float resolution = static_cast<float>(std::min(width, height)) / 1200;
  const float sigma = std::clamp(0.30f * std::sqrt(area / static_cast<float>(points.size())),
                                 min_sigma, std::max(min_sigma, max_sigma * resolution));
  const float middle = camera.project(block.centre()).depth;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float back = (places[i].depth - near) / range;
    const float height_share = (points[i].z - block.low.z) / (block.high.z - block.low.z);
    const float lit = 0.75f + 0.35f * std::exp(-3 * height_share);
    const float strength = lit * (1.25f - 0.85f * back);
    const float size = sigma * (1.15f - 0.3f * back) * middle / places[i].depth;
    const Vec light = mix(near_colour, far_colour, back) * strength;
    add_sprite(image, places[i], std::max(size, min_size), light);
    const Vec mirrored{points[i].x, points[i].y, 2 * block.low.z - points[i].z};
    if (seen_in_bottom(mirrored, block, camera.eye()))
      add_sprite(image, camera.project(mirrored), size + 1,
                 light * far_colour * (bottom_reflection * std::exp(-2 * height_share)));
  }
  expose(image);
  add_bloom(image);
  return image;
}

void add_dots(Image& image, const std::vector<Vec>& points, const Vec& colour,
              const Camera& camera) {
  if (points.empty()) return;
  // The fewer the points, the larger: in pixels of a picture of 1200.
  constexpr float min_size = 2, max_size = 6, size_of_one = 120;
  const float scale = static_cast<float>(std::min(image.width, image.height)) / 1200;
  const float size =
      std::clamp(size_of_one / std::sqrt(static_cast<float>(points.size())), min_size, max_size);
  const float radius = std::max(0.75f, 0.5f * size * scale);  // one pixel at least
  for (const Vec& point : points) {
    const Camera::Projected place = camera.project(point);
    const auto low = [&](float at) { return std::max(0, static_cast<int>(at - radius)); };
    const auto high = [&](float at, int end) {
      return std::min(end, static_cast<int>(std::ceil(at + radius)));
    };
    for (int y = low(place.y); y < high(place.y, image.height); ++y)
      for (int x = low(place.x); x < high(place.x, image.width); ++x) {
        const float dx = static_cast<float>(x) + 0.5f - place.x;
        const float dy = static_cast<float>(y) + 0.5f - place.y;
        if (dx * dx + dy * dy > radius * radius) continue;
        Vec& pixel = image.at(x, y);
        pixel = {std::max(pixel.x, colour.x), std::max(pixel.y, colour.y),
                 std::max(pixel.z, colour.z)};
      }
  }
}

}  // namespace lamplock::report
