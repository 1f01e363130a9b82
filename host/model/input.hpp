// What kind of input a file is, before it is read. Called by the command line to choose reader and
// discretiser.
#pragma once

#include <string>

namespace lamplock::model {

enum class InputKind { mesh, bitmap, points, curves };

/// By extension: .stl .obj .3mf .glb mesh; .png .bmp .jpg .jpeg bitmap; .svg curves; .xyz .txt .csv
/// .asc .cad points; .ply is a mesh if its header has faces, .dxf curves if it has anything but
/// points, points otherwise. Throws Error (bad_input) for any other extension, a missing file, a
/// broken PLY header or DXF.
InputKind classify(const std::string& file);

}  // namespace lamplock::model
