// Finds the kind of an input file before it is read. Called by the command line to choose reader
// and discretiser.
#pragma once

#include <string>

namespace lamplock::model {

enum class InputKind { mesh, bitmap, points, curves };

/// By extension: .stl .obj .3mf .glb mesh; .png .bmp .jpg .jpeg bitmap; .svg curves; .xyz .txt .csv
/// .asc .cad points; .ply is a mesh if its header has faces, otherwise points; .dxf is points if it
/// has only points, otherwise curves. Throws Error (bad_input) for any other extension, a missing
/// file, a damaged PLY header or DXF.
InputKind classify(const std::string& file);

}  // namespace lamplock::model
