#include "app/options/shared_options.hpp"

#include <utility>

namespace talus::app {
namespace {

const Names<Border>& borders() {
  static const Names<Border> names{{"constrain", Border::constrain}, {"cover", Border::cover}, {"clip", Border::clip}};
  return names;
}

}  // namespace

void add_input_options(Command& command, InputOptions& inputs) {
  command.group("Reading the rasters");
  command.option("--srs", inputs.srs, "CRS", "CRS of all inputs, whatever they state: EPSG:2056, WKT or PROJ");
  Names<VerticalUnit> units;
  for (const VerticalUnit unit :
       {VerticalUnit::metre, VerticalUnit::foot, VerticalUnit::us_survey_foot, VerticalUnit::kilometre,
        VerticalUnit::decimetre, VerticalUnit::centimetre, VerticalUnit::millimetre})
    units.emplace_back(name_of(unit), unit);
  command.choice("--vertical-unit", inputs.vertical_unit, std::move(units),
                 "Unit of the heights, for inputs that state none: metre, foot, us-survey-foot, km, dm, cm or mm");
  command.options("--nodata", inputs.nodata, kNodata, "VALUE",
                  "Value that means no data, for inputs that declare none. With --decode it is a height. Can be "
                  "repeated");
  command.number("--band", inputs.band, "N", "Band with the heights. Default: the first that is not alpha", 1, 65535);
  command.choice(
      "--decode", inputs.decode,
      Names<ColourCode>{
          {"none", ColourCode::none}, {"terrain-rgb", ColourCode::terrain_rgb}, {"terrarium", ColourCode::terrarium}},
      "Read heights from colours.\n"
      "terrain-rgb: Mapbox Terrain-RGB\n"
      "terrarium: terrarium tiles\n"
      "none (default): refuse colours");
  command.option("--variable", inputs.variable, "NAME", "Raster to read from a file with several, such as netCDF");
  command.flag("--recursive", inputs.recursive, "Read the subfolders of folders too");
  command.flag("--skip-broken", inputs.skip_broken, "Skip files that cannot be opened, and list them");
  command.files("--allow-outside", inputs.allow_outside, "FOLDER",
                "Trust the files in this folder when a virtual raster or a link leads there. Can be repeated");
  command.files("--allow-driver", inputs.allow_drivers, "NAME",
                "Let this GDAL driver open files too, for example netCDF or XYZ. Can be repeated");
}

void add_stream_options(Command& command, StreamOptions& options) {
  command.number(
      "--bands", options.stripes, "N",
      "Cut each level of an .rqt file into N pieces, so that N threads can read it. 0, the default: one piece "
      "for each 65,536 vertices",
      0, 4096);
}

void add_height_options(Command& command, Heights& heights) {
  command.choice(
      "--heights", heights.kind,
      Names<HeightKind>{{"exact", HeightKind::exact},
                        {"bounded", HeightKind::bounded},
                        {"fitted", HeightKind::fitted},
                        {"dense", HeightKind::dense}},
      "Heights of the vertices. The bound holds for each. Keep exact unless size matters.\n"
      "exact (default): as in the source\n"
      "bounded: rounded to multiples of a quantum, for smaller .rqt files\n"
      "fitted: moved within the tolerance, for the fewest vertices\n"
      "dense: nearly all samples, rounded as far as the tolerance allows. The smallest .rqt file where a mesh "
      "needs most samples");
  command.option("--quantum", heights.quantum, kMetresAboveZero, "M",
                 "With --heights bounded: the quantum in metres. Increments with the same quantum then fit the answer. "
                 "Without it Talus chooses one, and no increment fits. With --heights fitted: a smaller quantum mostly "
                 "needs fewer vertices and more bytes; the default is half the tolerance");
}

void add_border_option(Command& command, Border& border) {
  command.choice("--border", border, borders(),
                 "How the mesh ends at the rectangle.\n"
                 "constrain (default): its sides are edges\n"
                 "cover: whole triangles reach beyond\n"
                 "clip: whole triangles, then cut at the rectangle");
}

const char* name_of(Border border) { return name_in(borders(), border); }

}  // namespace talus::app
