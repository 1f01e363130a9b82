#include "host/points/inside.hpp"

#include <algorithm>
#include <utility>

namespace lamplock::points {
namespace {

std::vector<Triangle> joined(std::vector<Triangle> first, const std::vector<Triangle>& more) {
  first.insert(first.end(), more.begin(), more.end());
  return first;
}

}  // namespace

Inside::Inside(const model::Mesh& mesh) : crossings_(mesh.vertices, {}) {
  Bodies bodies = bodies_of(mesh);
  oriented_ = bodies.oriented.size();
  volume_mm3_ = bodies.volume_mm3;
  triangles_ = joined(std::move(bodies.oriented), bodies.others);
  crossings_ = VerticalCrossings(mesh.vertices, triangles_);
}

void Inside::pass(const Crossing& crossing, Passed& passed) const {
  if (crossing.triangle >= oriented_)
    passed.odd = !passed.odd;
  else
    passed.winding += crossing.normal_up ? 1 : -1;
}

bool Inside::contains(const geometry::Point& place) const {
  Passed passed;
  crossings_.for_each_above(place, [&](const Crossing& crossing) { pass(crossing, passed); });
  return passed.inside();
}

double Inside::filled_above_mm(const geometry::Point& place) const {
  std::vector<Crossing> above;
  crossings_.for_each_above(place, [&](const Crossing& crossing) { above.push_back(crossing); });
  std::sort(above.begin(), above.end(),
            [](const Crossing& p, const Crossing& q) { return p.z > q.z; });
  Passed passed;
  double filled = 0;
  for (std::size_t i = 0; i < above.size(); ++i) {
    pass(above[i], passed);
    const double end = i + 1 < above.size() ? above[i + 1].z : place.z;
    if (passed.inside()) filled += above[i].z - end;
  }
  return filled;
}

}  // namespace lamplock::points
