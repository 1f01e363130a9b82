#include "host/model/example.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "host/bytes.hpp"
#include "host/file.hpp"
#include "host/model/transform.hpp"

namespace lamplock::model {
namespace {

using std::numbers::pi;

// Shape, chosen by eye. Angles are along the spiral, 0 at the aperture, negative inwards.
constexpr double growth_per_turn = 3.0;
constexpr double apex = -2.9 * 2 * pi;
constexpr double chamber = -0.36 * 2 * pi;  // inner end of the open chamber
constexpr double septum_distance = 0.36;    // from septum to septum
constexpr double septum_depth = 0.42;       // inward bulge of a septum
constexpr double septum_thickness = 0.012;
constexpr int septa = 22;
constexpr double wall = 0.93;  // inner radius of the open chamber against the outer one
constexpr double ribs_per_turn = 30, rib_height = 0.03;
constexpr double max_side_mm = 60;
// Whorls touch if the tube's radius is (g - 1)/(g + 1) of the spiral's; a little less separates
// them.
constexpr double tube_radius = 0.985 * (growth_per_turn - 1) / (growth_per_turn + 1);
constexpr double tube_width = 1.12;  // across the plane of the spiral
constexpr double tilt = -0.5;        // turns the aperture to the upper right

/// A place on a surface: angle along the spiral, distance from the tube's middle (1: outer wall).
struct Profile {
  double angle, radius;
};

/// The surface point at `around` (0: away from the spiral's axis).
geometry::Point tube_point(const Profile& place, double around) {
  const double spiral = std::pow(growth_per_turn, place.angle / (2 * pi));
  const double outside = 0.5 + 0.5 * std::cos(around);  // ribs fade where whorls meet
  const double rib = rib_height * outside * place.radius * place.radius *
                     std::pow(std::cos(place.angle * ribs_per_turn / 2), 2);
  const double radius = tube_radius * spiral * (place.radius + rib);
  const double from_axis = spiral + radius * std::cos(around);
  return {from_axis * std::cos(place.angle + tilt), tube_width * radius * std::sin(around),
          from_axis * std::sin(place.angle + tilt)};
}

/// Adds the closed surface of a profile turned round the tube's middle. The profile begins and ends
/// in the middle (radius 0): there one vertex closes the surface.
void add_surface(Mesh& mesh, const std::vector<Profile>& profile, std::uint32_t around) {
  const auto ring = [&, base = static_cast<std::uint32_t>(mesh.vertices.size())](std::size_t i,
                                                                                 std::uint32_t k) {
    if (i == 0) return base;
    const auto before = base + 1 + static_cast<std::uint32_t>(i - 1) * around;
    return i + 1 == profile.size() ? before : before + k % around;
  };
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const bool pole = i == 0 || i + 1 == profile.size();
    for (std::uint32_t k = 0; k < (pole ? 1 : around); ++k) {
      mesh.vertices.push_back(tube_point(profile[i], 2 * pi * k / around));
    }
  }
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t a = ring(i, k), b = ring(i, k + 1), c = ring(i + 1, k),
                          d = ring(i + 1, k + 1);
      if (a != b) mesh.triangles.push_back({a, b, d});
      if (c != d) mesh.triangles.push_back({a, d, c});
    }
  }
}

/// The inward bulge of a septum at a radius.
Profile septum_place(double angle, double radius) {
  return {angle - septum_depth * (1 - radius * radius), radius};
}

/// From the apex along the outside to the aperture, over the lip and back inside to the last
/// septum.
std::vector<Profile> shell_profile() {
  constexpr int outside = 640, inside = 90, cap = 24;
  std::vector<Profile> profile{{apex, 0}};
  for (int i = 0; i <= outside; ++i) profile.push_back({apex * (1 - i / double{outside}), 1});
  for (int i = 0; i <= inside; ++i) profile.push_back({chamber * i / double{inside}, wall});
  for (int i = cap - 1; i >= 0; --i) {
    profile.push_back(septum_place(chamber, wall * i / double{cap}));
    profile.back().angle += septum_depth * (1 - wall * wall);
  }
  return profile;
}

/// A thin bowl: the inner side from its middle to the rim and the outer side back.
std::vector<Profile> septum_profile(double angle) {
  constexpr int steps = 24;
  constexpr double rim = 0.96;
  std::vector<Profile> profile;
  for (int i = 0; i <= steps; ++i) profile.push_back(septum_place(angle, rim * i / double{steps}));
  for (int i = steps; i >= 0; --i) {
    profile.push_back(septum_place(angle + septum_thickness, rim * i / double{steps}));
  }
  return profile;
}

}  // namespace

Mesh example_model() {
  constexpr std::uint32_t round_shell = 96, round_septum = 64;
  Mesh mesh;
  add_surface(mesh, shell_profile(), round_shell);
  for (int i = 1; i <= septa; ++i) {
    add_surface(mesh, septum_profile(chamber - i * septum_distance), round_septum);
  }
  return centred_and_scaled(std::move(mesh), max_side_mm);
}

void write_stl(const std::filesystem::path& path, const Mesh& mesh) {
  constexpr std::size_t header_bytes = 80;
  std::string bytes(header_bytes, ' ');
  bytes.replace(0, 13, "lamplock, mm ");
  append(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    // Normals may be zero: readers compute them from the order of the corners.
    for (int axis = 0; axis < 3; ++axis) append(bytes, 0.0f);
    for (const std::uint32_t corner : triangle) {
      const geometry::Point& p = mesh.vertices[corner];
      for (const double coordinate : {p.x, p.y, p.z}) append(bytes, static_cast<float>(coordinate));
    }
    bytes.append(2, '\0');
  }
  write_file(path, bytes);
}

}  // namespace lamplock::model
