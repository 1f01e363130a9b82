#include "host/model/foreign_formats.hpp"

#include <algorithm>
#include <iterator>

namespace lamplock::model {
namespace {

constexpr std::string_view as_dxf = "save it as DXF in the program that made it";
constexpr std::string_view as_svg = "save it as SVG in the program that made it";
constexpr std::string_view as_mesh = "export a mesh (STL or 3MF, in mm) from the CAD program";
constexpr std::string_view as_plain_mesh = "export it as STL, 3MF or GLB";
constexpr std::string_view as_program = "check and send it with the commands for G-code";

constexpr ForeignFormat foreign_formats[] = {
    {".dwg", "a DWG drawing", as_dxf},
    {".dwt", "a template of DWG drawings", as_dxf},
    {".dgn", "a drawing of MicroStation", as_dxf},
    {".ai", "a drawing of Illustrator", as_svg},
    {".cdr", "a drawing of CorelDRAW", as_svg},
    {".eps", "an EPS drawing", as_svg},
    {".ps", "a PostScript drawing", as_svg},
    {".pdf", "a PDF document", "open it in a drawing program and save it as SVG"},
    {".emf", "a drawing of Windows", as_svg},
    {".wmf", "a drawing of Windows", as_svg},
    {".afdesign", "a drawing of Affinity Designer", as_svg},
    {".lbrn", "a project of LightBurn", "export its drawing as SVG or DXF"},
    {".lbrn2", "a project of LightBurn", "export its drawing as SVG or DXF"},
    {".step", "a STEP solid", as_mesh, true},
    {".stp", "a STEP solid", as_mesh, true},
    {".iges", "an IGES solid", as_mesh, true},
    {".igs", "an IGES solid", as_mesh, true},
    {".f3d", "a design of Fusion", as_mesh, true},
    {".f3z", "a design of Fusion", as_mesh, true},
    {".sldprt", "a part of SolidWorks", as_mesh, true},
    {".sldasm", "an assembly of SolidWorks", as_mesh, true},
    {".ipt", "a part of Inventor", as_mesh, true},
    {".iam", "an assembly of Inventor", as_mesh, true},
    {".prt", "a CAD part", as_mesh, true},
    {".x_t", "a Parasolid", as_mesh, true},
    {".x_b", "a Parasolid", as_mesh, true},
    {".sat", "an ACIS solid", as_mesh, true},
    {".brep", "a solid of Open CASCADE", as_mesh, true},
    {".fcstd", "a document of FreeCAD", as_mesh, true},
    {".scad", "a script of OpenSCAD", as_mesh, true},
    {".3dm", "a model of Rhino", as_mesh, true},
    {".skp", "a model of SketchUp", as_mesh, true},
    {".blend", "a scene of Blender", as_plain_mesh, true},
    {".fbx", "an FBX scene", as_plain_mesh, true},
    {".dae", "a COLLADA scene", as_plain_mesh, true},
    {".3ds", "a scene of 3D Studio", as_plain_mesh, true},
    {".gltf", "a glTF scene of several files", "export it as GLB, one file", true},
    {".amf", "an AMF mesh", as_plain_mesh, true},
    {".off", "an OFF mesh", as_plain_mesh, true},
    {".wrl", "a VRML scene", as_plain_mesh, true},
    {".x3d", "an X3D scene", as_plain_mesh, true},
    {".usdz", "a USD scene", as_plain_mesh, true},
    {".zip", "an archive", "unpack it and give the file in it"},
    {".gz", "an archive", "unpack it and give the file in it"},
    {".gcode", "a G-code program", as_program},
    {".nc", "a G-code program", as_program},
    {".ngc", "a G-code program", as_program},
};

}  // namespace

const ForeignFormat* find_foreign_format(std::string_view extension) {
  const auto* const found =
      std::ranges::find(foreign_formats, extension, &ForeignFormat::extension);
  return found == std::end(foreign_formats) ? nullptr : found;
}

}  // namespace lamplock::model
