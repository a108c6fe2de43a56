#pragma once
// Answers questions. Every question of a snapshot passes through here.

#include <span>
#include <vector>

#include "query/pages/stored_pages.hpp"
#include "talus/question.hpp"

namespace talus {

/// See Snapshot::ask.
///
/// threads  number of threads, unless the question has its own
[[nodiscard]] Answer answer_to(const StoredPages& pages, const Question& question, int threads);

/// See Snapshot::ask_together.
[[nodiscard]] std::vector<Answer> answers_to(const StoredPages& pages, std::span<const Question> questions);

}  // namespace talus
