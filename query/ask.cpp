#include "query/ask.hpp"

#include <deque>
#include <utility>

#include "engine/machine/parallel.hpp"
#include "query/bounded/bounded_heights.hpp"
#include "query/pages/watch.hpp"
#include "query/selection/budget.hpp"
#include "query/selection/range_query.hpp"
#include "query/selection/refusals.hpp"
#include "query/selection/selection.hpp"

namespace talus {
namespace {

/// Whether a question has only a region, a tolerance and a constrained border. One pass over the pages is then enough.
bool is_plain(const Question& q, GridRect extent) {
  return q.border == Border::constrain && !q.field && q.points.empty() && q.neighbours.empty() &&
         (!q.max_level || *q.max_level >= finest_level(extent));
}

Answer answer_of(const StoredPages& pages, const Question& q, int threads, std::deque<Watch>& watches) {
  Watch& watch = watches.front();
  watch.stage("choosing vertices", 0, 1);
  if (q.heights.kind != HeightKind::exact)
    return rounded_answer({pages, q.region, q.tolerance, q.from, threads, watch}, q.heights);
  if (is_plain(q, pages.manifest().description.extent))
    return range_query(pages, q.region, q.tolerance, threads, q.from, watch);
  return std::move(select_and_gather(pages, {&q, 1}, watches).front());
}

}  // namespace

Answer answer_to(const StoredPages& pages, const Question& asked, int threads) {
  Question question = accepted(pages, asked, false);
  std::deque<Watch> watches;
  Watch& watch = watches.emplace_back(question);
  watch.look();
  QueryCost search;
  if (question.budget.vertices > 0 || question.budget.triangles > 0) {
    watch.stage("searching for the tolerance", 0, 0.3);
    question.tolerance = tolerance_for(pages, question.region, question.budget, search, watch);
    if (question.from) require_finer(*question.from, question.tolerance);
  }
  Answer answer =
      answer_of(pages, question, question.threads == 0 ? threads : threads_or_all(question.threads), watches);
  answer.search = std::move(search);
  watch.look();
  watch.stage("done", 1, 1);
  return answer;
}

std::vector<Answer> answers_to(const StoredPages& pages, std::span<const Question> asked) {
  std::vector<Question> questions;
  std::deque<Watch> watches;
  for (const Question& question : asked) {
    questions.push_back(accepted(pages, question, true));
    watches.emplace_back(questions.back());
  }
  return select_and_gather(pages, questions, watches);
}

}  // namespace talus
