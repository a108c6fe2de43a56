#include "app/options/input_options.hpp"

#include "app/options/arguments.hpp"
#include "talus/failure.hpp"

namespace talus::app {
namespace {

void repeat(CLI::Option* option) {
  option->type_size(1)
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group("Inputs");
}

}  // namespace

InputOptions InputWords::read() const {
  InputOptions read = options;
  for (const std::string& word : nodata) read.nodata.push_back(parse_nodata(word));
  read.decode = parse_decode(decode);
  return read;
}

void add_input_options(CLI::App& command, InputWords& words) {
  InputOptions& inputs = words.options;
  const std::string group = "Inputs";
  command.add_option("--srs", inputs.srs, "CRS of all inputs, whatever they state: EPSG:2056, WKT or PROJ")
      ->option_text("CRS")
      ->group(group);
  command
      .add_option("--vertical-unit", inputs.vertical_unit,
                  "Unit of heights, where the inputs do not say: metre, foot …")
      ->option_text("UNIT")
      ->group(group);
  repeat(
      command
          .add_option("--nodata", words.nodata,
                      "Sample that means no data, as it stands in inputs that declare none (with --decode a height);\n"
                      "repeat it for more than one")
          ->option_text("VALUE"));
  command.add_option("--band", inputs.band, "Band that holds the heights; without it the first that is not alpha")
      ->check(CLI::Range(1, 65535))
      ->option_text("N")
      ->group(group);
  command
      .add_option(
          "--decode", words.decode,
          "Read heights that are written as colours, red, green and blue: Mapbox's code or that of terrarium tiles")
      ->option_text("terrain-rgb|terrarium")
      ->group(group);
  command.add_option("--variable", inputs.variable, "Raster to read from files that hold several, such as netCDF")
      ->option_text("NAME")
      ->group(group);
  command.add_flag("--recursive", inputs.recursive, "Look into the subfolders of folders, too")->group(group);
  command
      .add_flag("--skip-broken", inputs.skip_broken,
                "Leave out files that cannot be opened, and list them; without it one ends the work")
      ->group(group);
  repeat(command
             .add_option(
                 "--allow-outside", inputs.allow_outside,
                 "Folder whose files virtual rasters and links may lead to, beside their own folder; may be repeated")
             ->option_text("FOLDER"));
  repeat(command
             .add_option("--allow-driver", inputs.allow_drivers,
                         "GDAL driver that may open files, too, such as netCDF or XYZ; may be repeated")
             ->option_text("NAME"));
}

}  // namespace talus::app
