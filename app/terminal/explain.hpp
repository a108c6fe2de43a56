#pragma once
// What an answer read, what it left out and why, and its time.

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "app/terminal/report.hpp"
#include "talus/cost.hpp"

namespace talus::app {

/// Times of stages that follow each other.
class Stages {
 public:
  /// Measures `work`, and returns what it returns.
  template <class Work>
  decltype(auto) time(const char* name, Work&& work) {
    const Stage stage(*this, name);
    return work();
  }
  void add(const char* name, double seconds) { done_.emplace_back(name, seconds); }
  /// Adds the stages of a question.
  void add(const QueryCost& cost);
  /// Adds the search for the tolerance of a budget.
  void add_search(const QueryCost& cost);

  [[nodiscard]] const std::vector<std::pair<std::string, double>>& done() const { return done_; }
  [[nodiscard]] const QueryCost& search() const { return search_; }

 private:
  struct Stage {
    Stage(Stages& of, const char* name) : stages(of), what(name) {}
    ~Stage() { stages.add(what, std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count()); }
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;
    Stages& stages;
    const char* what;
    std::chrono::steady_clock::time_point started = std::chrono::steady_clock::now();
  };
  std::vector<std::pair<std::string, double>> done_;
  QueryCost search_;
};

[[nodiscard]] Json explained(const QueryCost& cost, const Stages& stages);
/// Two tables, coarse pages first.
[[nodiscard]] std::string explained_text(const QueryCost& cost, const Stages& stages);

}  // namespace talus::app
