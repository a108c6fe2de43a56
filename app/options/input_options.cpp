#include "app/options/input_options.hpp"

#include <utility>

namespace talus::app {

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

}  // namespace talus::app
