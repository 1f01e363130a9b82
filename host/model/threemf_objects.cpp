#include "host/model/threemf_objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>

#include "host/file.hpp"

namespace lamplock::model {
namespace {

using std::filesystem::path;

/// Deeper ones would overflow the stack of the reader, which copies them by recursion.
constexpr int max_object_depth = 100;
constexpr std::uint64_t max_objects = 100'000;
/// A triangle takes about 200 bytes while corners are merged: 1.6 GB.
constexpr std::uint64_t max_triangles = 8'000'000;

/// Size of an object with all objects inside.
struct Whole {
  int depth = 0;
  std::uint64_t objects = 1, triangles = 0;
};

class Placed {
 public:
  Placed(const path& file, const ThreemfModel& model) : file_(file), model_(model) {}

  void add(const ThreemfKey& item) { add_to(all_, whole(item, 0)); }

 private:
  /// Never deeper than `max_object_depth`, so that the check itself does not overflow the stack.
  const Whole& whole(const ThreemfKey& key, int depth) {
    const auto [known, is_new] = wholes_.try_emplace(key);
    if (!is_new) {
      if (!known->second)
        refuse(file_, model_.name_of(key) + " contains itself", "repair the model");
      require_depth(key, depth + known->second->depth);
      return *known->second;
    }
    require_depth(key, depth);
    const ThreemfObject& object = at(key);
    Whole sum{0, 1, object.triangles.size()};
    for (const ThreemfComponent& inner : object.inside) add_to(sum, whole(inner.object, depth + 1));
    return known->second.emplace(sum);
  }

  const ThreemfObject& at(const ThreemfKey& key) const {
    const auto found = model_.objects.find(key);
    if (found == model_.objects.end())
      refuse(file_, model_.name_of(key) + " is placed but does not exist", "repair the model");
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

  void require_depth(const ThreemfKey& key, int depth) const {
    if (depth > max_object_depth)
      refuse(file_,
             fmt::format("{} is nested in others, deeper than {}", model_.name_of(key),
                         max_object_depth),
             "join some of them");
  }

  const path& file_;
  const ThreemfModel& model_;
  std::map<ThreemfKey, std::optional<Whole>> wholes_;  // empty: its sum is being computed
  Whole all_{0, 0, 0};
};

}  // namespace

void check_placed(const path& file, const ThreemfModel& model) {
  Placed placed(file, model);
  for (const ThreemfComponent& item : model.items) placed.add(item.object);
}

}  // namespace lamplock::model
