#pragma once
// Every question comes through here.

#include <span>
#include <vector>

#include "query/pages/stored_pages.hpp"
#include "talus/question.hpp"

namespace talus {

/// See Snapshot::ask.
///
/// threads  for a question that does not say how many
[[nodiscard]] Answer answer_to(const StoredPages& pages, const Question& question, int threads);

/// See Snapshot::ask_together.
[[nodiscard]] std::vector<Answer> answers_to(const StoredPages& pages, std::span<const Question> questions);

}  // namespace talus
