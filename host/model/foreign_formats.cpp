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
    {".step", "a STEP solid", as_mesh},
    {".stp", "a STEP solid", as_mesh},
    {".iges", "an IGES solid", as_mesh},
    {".igs", "an IGES solid", as_mesh},
    {".f3d", "a design of Fusion", as_mesh},
    {".f3z", "a design of Fusion", as_mesh},
    {".sldprt", "a part of SolidWorks", as_mesh},
    {".sldasm", "an assembly of SolidWorks", as_mesh},
    {".ipt", "a part of Inventor", as_mesh},
    {".iam", "an assembly of Inventor", as_mesh},
    {".prt", "a CAD part", as_mesh},
    {".x_t", "a Parasolid", as_mesh},
    {".x_b", "a Parasolid", as_mesh},
    {".sat", "an ACIS solid", as_mesh},
    {".brep", "a solid of Open CASCADE", as_mesh},
    {".fcstd", "a document of FreeCAD", as_mesh},
    {".scad", "a script of OpenSCAD", as_mesh},
    {".3dm", "a model of Rhino", as_mesh},
    {".skp", "a model of SketchUp", as_mesh},
    {".blend", "a scene of Blender", as_plain_mesh},
    {".fbx", "an FBX scene", as_plain_mesh},
    {".dae", "a COLLADA scene", as_plain_mesh},
    {".3ds", "a scene of 3D Studio", as_plain_mesh},
    {".gltf", "a glTF scene of several files", "export it as GLB, one file"},
    {".amf", "an AMF mesh", as_plain_mesh},
    {".off", "an OFF mesh", as_plain_mesh},
    {".wrl", "a VRML scene", as_plain_mesh},
    {".x3d", "an X3D scene", as_plain_mesh},
    {".usdz", "a USD scene", as_plain_mesh},
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
