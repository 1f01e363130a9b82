#include "host/report/picture.hpp"

#include <png.h>

#include <cerrno>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/output_error.hpp"
#include "host/report/camera.hpp"
#include "host/report/cloud_light.hpp"
#include "host/report/glass_scene.hpp"
#include "host/report/image.hpp"

namespace lamplock::report {
namespace {

/// Glass round the cloud, relative to its longest side.
constexpr float margin = 0.1f;
constexpr unsigned threads = 2;

/// Points moved so that their middle is the origin: so floats have enough resolution.
struct CentredCloud {
  std::vector<Vec> points, grey, before;
  Vec half;  ///< half the size
};

CentredCloud centred(const geometry::PointCloud& fired, const geometry::PointCloud& not_fired,
                     const geometry::PointCloud& fired_before) {
  constexpr double far = std::numeric_limits<double>::max();
  geometry::Point low{far, far, far}, high{-far, -far, -far};
  for (const geometry::PointCloud* part : {&fired, &not_fired, &fired_before})
    for (const geometry::Point& p : *part) {
      if (!is_finite(p)) continue;
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  CentredCloud result;
  if (low.x > high.x) return result;
  const geometry::Point middle{low.x / 2 + high.x / 2, low.y / 2 + high.y / 2,
                               low.z / 2 + high.z / 2};
  const auto relative = [&middle](const geometry::Point& p) {
    return Vec{static_cast<float>(p.x - middle.x), static_cast<float>(p.y - middle.y),
               static_cast<float>(p.z - middle.z)};
  };
  const auto move = [&relative](const geometry::PointCloud& cloud, std::vector<Vec>& to) {
    to.reserve(cloud.size());
    for (const geometry::Point& p : cloud)
      if (is_finite(p)) to.push_back(relative(p));
  };
  move(fired, result.points);
  move(not_fired, result.grey);
  move(fired_before, result.before);
  result.half = relative(high);
  return result;
}

/// The glass round the cloud; flat clouds get a slab.
Box block_round(const CentredCloud& cloud) {
  const float longest = std::max({cloud.half.x, cloud.half.y, cloud.half.z});
  if (!(longest > 0)) return {{-1, -1, -1}, {1, 1, 1}};
  const float glass = 2 * margin * longest;
  const auto thick = [&](float half) { return std::max(half + glass, 0.25f * longest); };
  const Vec half{thick(cloud.half.x), thick(cloud.half.y), thick(cloud.half.z)};
  return {half * -1.0f, half};
}

/// Height of a block against its width: 1 for a cube.
float relative_height(const Box& block) {
  const Vec size = block.size();
  return size.z / std::max(size.x, size.y);
}

/// Slightly from above; the flatter the block, the more from above, so that it is visible.
float natural_elevation(const Box& block) {
  return std::clamp(66 - 60 * relative_height(block), 14.0f, 52.0f);
}

float natural_yaw(const Box& block) { return std::clamp(40 * relative_height(block), 8.0f, 28.0f); }

/// Transfer function of sRGB (IEC 61966-2-1).
std::uint8_t to_srgb(float linear, float noise) {
  const float v = std::clamp(linear, 0.0f, 1.0f);
  const float s = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::clamp(255 * s + noise, 0.0f, 255.0f));
}

/// 0..1, a hash of the pixel: without it dark gradients would show bands.
float dither(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return static_cast<float>(x >> 8) * 0x1p-24f;
}

/// Keeps dark values and compresses values above `knee` towards 1.
float soft_clip(float v) {
  constexpr float knee = 0.7f;
  return v <= knee ? v : knee + (1 - knee) * (1 - std::exp(-(v - knee) / (1 - knee)));
}

std::vector<std::uint8_t> developed(const Image& scene, const Image& cloud) {
  std::vector<std::uint8_t> bytes(scene.pixels.size() * 3);
  for_rows(scene.height, threads, [&](int y) {
    for (int x = 0; x < scene.width; ++x) {
      const std::size_t i = scene.index(x, y);
      const Vec light = scene.pixels[i] + cloud.pixels[i];
      const float noise = dither(static_cast<std::uint32_t>(i));
      bytes[3 * i] = to_srgb(soft_clip(light.x), noise);
      bytes[3 * i + 1] = to_srgb(soft_clip(light.y), noise);
      bytes[3 * i + 2] = to_srgb(soft_clip(light.z), noise);
    }
  });
  return bytes;
}

void write_png(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes, int width,
               int height) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = PNG_FORMAT_RGB;
  png.flags = PNG_IMAGE_FLAG_FAST;
  errno = 0;
  if (png_image_write_to_file(&png, path.c_str(), 0, bytes.data(), 0, nullptr) != 0) return;
  if (errno != 0) throw OutputError(path, errno);
  throw OutputError(path, std::string("cannot be written (") + png.message + ")");
}

}  // namespace

void write_cloud_picture(const std::filesystem::path& path, const geometry::PointCloud& cloud,
                         const PictureSize& size) {
  write_cloud_picture(path, cloud, {}, size);
}

void write_cloud_picture(const std::filesystem::path& path, const geometry::PointCloud& fired,
                         const geometry::PointCloud& not_fired, const PictureSize& size) {
  write_cloud_picture(path, fired, not_fired, {}, size);
}

void write_cloud_picture(const std::filesystem::path& path, const geometry::PointCloud& fired,
                         const geometry::PointCloud& not_fired,
                         const geometry::PointCloud& fired_before, const PictureSize& size) {
  constexpr Vec grey{0.105f, 0.11f, 0.115f}, sand{0.20f, 0.15f, 0.08f};
  const CentredCloud cloud = centred(fired, not_fired, fired_before);
  const Box block = block_round(cloud);
  const Box plinth = plinth_under(block);
  const Box stage{plinth.low, {plinth.high.x, plinth.high.y, block.high.z}};
  const Camera camera(stage, natural_yaw(block), natural_elevation(block), size.width, size.height);
  Image scene(size.width, size.height);
  paint_glass_scene(scene, block, camera, threads);
  Image light = cloud_light(cloud.points, block, camera, size.width, size.height);
  add_dots(light, cloud.grey, grey, camera);
  add_dots(light, cloud.before, sand, camera);
  write_png(path, developed(scene, light), size.width, size.height);
}

}  // namespace lamplock::report
