#include "app/terminal/fields.hpp"

#include <utility>

namespace talus::app {
namespace {

// Fields that sentences of the library name, and the options that set them.
// Where the name of one field begins with the name of another, the longer one comes first.
constexpr std::pair<const char*, const char*> kOptions[] = {
    {"IngestOptions::overwrite", "--overwrite"},
    {"IngestOptions::resume", "--resume"},
    {"IngestOptions::void_weight", "--void-weight"},
    {"IngestOptions::finest_tolerance", "--tolerance"},
    {"IngestOptions::error_metric", "--metric"},
    {"InputOptions::allow_drivers", "--allow-driver"},
    {"InputOptions::allow_outside", "--allow-outside"},
    {"InputOptions::recursive", "--recursive"},
    {"InputOptions::skip_broken", "--skip-broken"},
    {"InputOptions::band", "--band"},
    {"InputOptions::variable", "--variable"},
    {"InputOptions::nodata", "--nodata"},
    {"InputOptions::decode", "--decode"},
    {"InputOptions::srs", "--srs"},
    {"InputOptions::vertical_unit", "--vertical-unit"},
    {"InputOptions::target_srs", "--t-srs"},
    {"InputOptions::target_dx", "--tr"},
    {"InputOptions::resampling", "--resampling"},
    {"InputOptions::grid", "--grid-of"},
    {"InputOptions::priority_resolution", "--priority resolution"},
    {"InputOptions::height_step", "--height-step"},
    {"Question::rectangle", "--bbox"},
    {"Question::region", "--bbox"},
    {"Question::tolerance", "--tolerance"},
    {"Question::budget", "a budget (--max-vertices or --max-triangles)"},
    {"Question::field", "--focus or --tolerance-raster"},
    {"Question::from", "--from"},
    {"Question::border", "--border"},
    {"Question::heights", "--heights"},
    {"Heights::quantum", "--quantum"},
    {"Question::max_level", "--max-level"},
    {"Question::points", "points and lines"},
    {"Question::neighbours", "--match"},
    {"Question::threads", "--threads"},
    {"snapped()", "--snap 16"},
};

}  // namespace

std::string with_options(std::string sentence) {
  for (const auto& [field, option] : kOptions) {
    const std::string name = field;
    for (std::size_t at = 0; (at = sentence.find(name, at)) != std::string::npos;)
      sentence.replace(at, name.size(), option);
  }
  return sentence;
}

std::vector<std::string> with_options(std::vector<std::string> sentences) {
  for (std::string& sentence : sentences) sentence = with_options(std::move(sentence));
  return sentences;
}

}  // namespace talus::app
