#include "host/model/threemf_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "host/file.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// As for GLB: deeper ones would overflow the stack of the mesh library.
constexpr int max_object_depth = 100;
/// The mesh library needs more than a kilobyte for each.
constexpr std::uint64_t max_objects = 100'000;
/// 72 bytes each: 1.4 GB.
constexpr std::uint64_t max_triangles = 20'000'000;

/// Size of an object with all objects inside.
struct Whole {
  int depth = 0;
  std::uint64_t objects = 1, triangles = 0;
};

class Placed {
 public:
  Placed(const path& file, const ThreemfObjects& objects) : file_(file), objects_(objects) {}

  void add(int item) { add_to(all_, whole(item, 0)); }

 private:
  /// Never deeper than `max_object_depth`, so that the check itself does not overflow the stack.
  const Whole& whole(int id, int depth) {
    const auto [known, is_new] = wholes_.try_emplace(id);
    if (!is_new) {
      if (!known->second)
        refuse(file_, fmt::format("object {} contains itself", id), "repair the model");
      require_depth(id, depth + known->second->depth);
      return *known->second;
    }
    require_depth(id, depth);
    const ThreemfObject& object = at(id);
    Whole sum{0, 1, object.triangles};
    for (const int inner : object.inside) add_to(sum, whole(inner, depth + 1));
    return known->second.emplace(sum);
  }

  const ThreemfObject& at(int id) const {
    const auto found = objects_.find(id);
    if (found == objects_.end())
      refuse(file_, fmt::format("object {} is placed but does not exist", id), "repair the model");
    return found->second;
  }

  /// Both numbers are limited, so that they cannot overflow.
  void add_to(Whole& sum, const Whole& one) const {
    sum.depth = std::max(sum.depth, one.depth + 1);
    sum.objects += one.objects;
    sum.triangles += one.triangles;
    if (sum.objects > max_objects)
      refuse(file_, fmt::format("more than {} placed objects", max_objects), "place fewer");
    if (sum.triangles > max_triangles)
      refuse(file_, fmt::format("more than {} placed triangles", max_triangles),
             "place fewer objects, or reduce their meshes");
  }

  void require_depth(int id, int depth) const {
    if (depth > max_object_depth)
      refuse(file_,
             fmt::format("object {} is nested in others, deeper than {}", id, max_object_depth),
             "join some of them");
  }

  const path& file_;
  const ThreemfObjects& objects_;
  std::map<int, std::optional<Whole>> wholes_;  // empty: its sum is being computed
  Whole all_{0, 0, 0};
};

}  // namespace

void check_placed(const path& file, const ThreemfObjects& objects, const std::vector<int>& items) {
  Placed placed(file, objects);
  for (const int item : items) placed.add(item);
}

}  // namespace lamplock::model
