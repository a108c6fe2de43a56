#pragma once
// The table of things that one question cannot combine. docs/questions.md shows it, and a test compares both.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "talus/question.hpp"

namespace talus {

/// Something that a question asks for.
enum class Feature : std::uint8_t {
  region,
  rectangle,
  tolerance,
  budget,
  field,
  from,
  border,
  exact,
  bounded_alone,
  fitted,
  dense,
  rounded,
  quantum,
  max_level,
  points,
  neighbours,
  together,
};

struct FeatureWords {
  Feature feature;
  std::string_view field;    ///< as a field of the library
  std::string_view meaning;  ///< when a question asks for it
};

inline constexpr std::array<FeatureWords, 17> kFeatures{{
    {Feature::region, "Question::region", "a region in samples"},
    {Feature::rectangle, "Question::rectangle", "a rectangle in CRS coordinates"},
    {Feature::tolerance, "Question::tolerance", "a tolerance above 0"},
    {Feature::budget, "Question::budget", "most vertices or triangles"},
    {Feature::field, "Question::field", "a tolerance that varies"},
    {Feature::from, "Question::from", "an increment"},
    {Feature::border, "Question::border", "another border than constrain"},
    {Feature::exact, "Question::heights exact", "the source's heights"},
    {Feature::bounded_alone, "Question::heights bounded", "bounded heights without a quantum"},
    {Feature::fitted, "Question::heights fitted", "fitted heights"},
    {Feature::dense, "Question::heights dense", "dense heights"},
    {Feature::rounded, "Question::heights", "bounded, fitted or dense heights"},
    {Feature::quantum, "Heights::quantum", "a quantum"},
    {Feature::max_level, "Question::max_level", "a finest level"},
    {Feature::points, "Question::points", "points, places or lines"},
    {Feature::neighbours, "Question::neighbours", "answers to meet"},
    {Feature::together, "Snapshot::ask_together", "several questions at once"},
}};

[[nodiscard]] constexpr const FeatureWords& words_of(Feature feature) {
  return kFeatures[static_cast<std::size_t>(feature)];
}

/// Two things that do not go together, and the message for a caller who asks for both.
struct Combination {
  Feature one, other;
  std::string_view sentence;
};

inline constexpr std::array<Combination, 29> kRefused{{
    {Feature::region, Feature::rectangle, "Question::region and Question::rectangle both say where: give one of them"},
    {Feature::budget, Feature::tolerance,
     "Question::budget and Question::tolerance both say how exact: give one of them"},
    {Feature::budget, Feature::field, "Question::budget and Question::field both say how exact: give one of them"},
    {Feature::budget, Feature::border,
     "Question::budget cannot go with Question::border cover or clip: it counts the vertices of a constrained "
     "border"},
    {Feature::budget, Feature::max_level,
     "Question::budget cannot go with Question::max_level: it counts the vertices of all levels"},
    {Feature::budget, Feature::points,
     "Question::budget cannot go with Question::points: it does not count vertices for points"},
    {Feature::budget, Feature::neighbours,
     "Question::budget cannot go with Question::neighbours: it does not count vertices for neighbours"},
    {Feature::from, Feature::field,
     "Question::from cannot go with Question::field: it continues an answer of one tolerance"},
    {Feature::from, Feature::border,
     "Question::from cannot go with Question::border cover or clip: it continues an answer with a constrained "
     "border"},
    {Feature::from, Feature::max_level,
     "Question::from cannot go with Question::max_level: it continues an answer of all levels"},
    {Feature::from, Feature::points,
     "Question::from cannot go with Question::points: it continues an answer without points"},
    {Feature::from, Feature::neighbours,
     "Question::from cannot go with Question::neighbours: it continues an answer without neighbours"},
    {Feature::from, Feature::bounded_alone,
     "Question::from with Question::heights bounded needs the Heights::quantum of the answer that it continues: "
     "name it"},
    {Feature::from, Feature::fitted,
     "Question::from cannot go with Question::heights fitted: fitted heights differ at each tolerance"},
    {Feature::from, Feature::dense,
     "Question::from cannot go with Question::heights dense: dense heights differ at each tolerance"},
    {Feature::rounded, Feature::field,
     "Question::heights bounded, fitted or dense cannot go with Question::field: one tolerance is needed"},
    {Feature::rounded, Feature::border,
     "Question::heights bounded, fitted or dense cannot go with Question::border cover or clip: the border must be "
     "constrained"},
    {Feature::rounded, Feature::max_level,
     "Question::heights bounded, fitted or dense cannot go with Question::max_level: all levels are needed"},
    {Feature::rounded, Feature::points,
     "Question::heights bounded, fitted or dense cannot go with Question::points: the heights decide which "
     "vertices there are"},
    {Feature::rounded, Feature::neighbours,
     "Question::heights bounded, fitted or dense cannot go with Question::neighbours: the heights decide which "
     "vertices there are"},
    {Feature::quantum, Feature::exact,
     "Heights::quantum cannot go with Question::heights exact: it goes with bounded and fitted"},
    {Feature::quantum, Feature::dense,
     "Heights::quantum cannot go with Question::heights dense: it goes with bounded and fitted"},
    {Feature::border, Feature::field,
     "Question::field cannot go with Question::border cover or clip: the border must be constrained"},
    {Feature::border, Feature::points,
     "Question::points cannot go with Question::border cover or clip: the border must be constrained"},
    {Feature::border, Feature::neighbours,
     "Question::neighbours cannot go with Question::border cover or clip: the border must be constrained"},
    {Feature::together, Feature::border,
     "Snapshot::ask_together cannot go with Question::border cover or clip: answers meet in vertices of "
     "constrained borders"},
    {Feature::together, Feature::budget,
     "Snapshot::ask_together cannot go with Question::budget: answers get vertices from each other"},
    {Feature::together, Feature::from,
     "Snapshot::ask_together cannot go with Question::from: answers get vertices from each other"},
    {Feature::together, Feature::rounded,
     "Snapshot::ask_together cannot go with Question::heights bounded, fitted or dense: answers get vertices from "
     "each other"},
}};

/// Whether a question asks for something.
///
/// together  the question is one of several
[[nodiscard]] bool asks_for(const Question& question, Feature feature, bool together);

}  // namespace talus
