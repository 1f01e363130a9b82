// Moves a field from one grid to another so that the energy remains.
//
// In:  a value per volume, two grids with the same ends. Out: values on the
//      second grid. Who: HeatSolver::change_grid().
//
// Along x, then y, then z: in each old volume the field is a straight line whose slope is limited
// so that no new extreme appears (van Leer, J. Comput. Phys. 32, 1979); its integral over each new
// volume is exact.
#pragma once

#include <vector>

#include "host/thermal/grid.hpp"

namespace lamplock::thermal {

std::vector<double> remapped(const std::vector<double>& values, const Grid& from, const Grid& to);

}  // namespace lamplock::thermal
