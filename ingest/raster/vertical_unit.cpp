#include "ingest/raster/vertical_unit.hpp"

#include <algorithm>

#include "talus/ingest.hpp"

namespace talus {
namespace {

struct NamedUnit {
  std::string_view name;
  double metres;
};
constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937;
constexpr NamedUnit kVerticalUnits[] = {{"", 1},
                                        {"m", 1},
                                        {"metre", 1},
                                        {"metres", 1},
                                        {"meter", 1},
                                        {"meters", 1},
                                        {"km", 1000},
                                        {"kilometre", 1000},
                                        {"dm", 0.1},
                                        {"decimetre", 0.1},
                                        {"cm", 0.01},
                                        {"centimetre", 0.01},
                                        {"mm", 0.001},
                                        {"millimetre", 0.001},
                                        {"ft", kFoot},
                                        {"foot", kFoot},
                                        {"feet", kFoot},
                                        {"international foot", kFoot},
                                        {"us-ft", kSurveyFoot},
                                        {"ft-us", kSurveyFoot},
                                        {"ftus", kSurveyFoot},
                                        {"us-survey-foot", kSurveyFoot},
                                        {"us_survey_foot", kSurveyFoot},
                                        {"us survey foot", kSurveyFoot},
                                        {"us survey feet", kSurveyFoot},
                                        {"foot_us", kSurveyFoot}};

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

const char* name_of(VerticalUnit unit) {
  switch (unit) {
    case VerticalUnit::kilometre: return "km";
    case VerticalUnit::decimetre: return "dm";
    case VerticalUnit::centimetre: return "cm";
    case VerticalUnit::millimetre: return "mm";
    case VerticalUnit::foot: return "foot";
    case VerticalUnit::us_survey_foot: return "us-survey-foot";
    case VerticalUnit::metre: break;
  }
  return "metre";
}

std::optional<double> metres_in(std::string_view unit) {
  for (const NamedUnit& known : kVerticalUnits) {
    if (std::equal(unit.begin(), unit.end(), known.name.begin(), known.name.end(),
                   [](char a, char b) { return lower(a) == b; })) {
      return known.metres;
    }
  }
  return std::nullopt;
}

}  // namespace talus
