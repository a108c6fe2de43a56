#include "engine/geo/crs_text.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace talus {
namespace {

/// KEYWORD[value, value, ...]: a value is a text, a number, a word or another node.
struct Node {
  std::string keyword;              ///< in capitals
  std::vector<std::string> values;  ///< values that are not nodes, in order, without quotes
  std::vector<Node> nodes;

  template <std::size_t N>
  [[nodiscard]] const Node* child(const std::array<std::string_view, N>& keywords) const {
    for (const Node& node : nodes) {
      for (const std::string_view wanted : keywords) {
        if (node.keyword == wanted) return &node;
      }
    }
    return nullptr;
  }
  /// The same at any depth: a node's children first, then the first branch.
  template <std::size_t N>
  [[nodiscard]] const Node* descendant(const std::array<std::string_view, N>& keywords) const {
    if (const Node* found = child(keywords)) return found;
    for (const Node& node : nodes) {
      if (const Node* found = node.descendant(keywords)) return found;
    }
    return nullptr;
  }
  [[nodiscard]] std::optional<double> number(std::size_t i) const {
    if (i >= values.size()) return std::nullopt;
    const std::string& text = values[i];
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
  }
};

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) {}

  [[nodiscard]] std::optional<Node> node(int depth = 0) {
    constexpr int kDeepest = 64;
    Node node;
    node.keyword = word();
    if (node.keyword.empty() || depth > kDeepest || !(skip('[') || skip('('))) return std::nullopt;
    do {
      space();
      if (at_ < text_.size() && text_[at_] == '"') {
        const std::optional<std::string> text = quoted();
        if (!text) return std::nullopt;
        node.values.push_back(*text);
        continue;
      }
      const std::size_t begin = at_;
      std::string bare = word();
      space();
      if (at_ < text_.size() && (text_[at_] == '[' || text_[at_] == '(')) {
        at_ = begin;
        std::optional<Node> inner = this->node(depth + 1);
        if (!inner) return std::nullopt;
        node.nodes.push_back(std::move(*inner));
      } else {
        node.values.push_back(std::move(bare));
      }
    } while (skip(','));
    if (!(skip(']') || skip(')'))) return std::nullopt;
    return node;
  }

 private:
  void space() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  [[nodiscard]] bool skip(char c) {
    space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  /// Reads a keyword or a number.
  [[nodiscard]] std::string word() {
    space();
    std::string out;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_' && c != '.' && c != '-' && c != '+') break;
      out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      ++at_;
    }
    return out;
  }
  /// Reads a text in quotes; two quotes inside stand for one.
  [[nodiscard]] std::optional<std::string> quoted() {
    std::string out;
    for (++at_; at_ < text_.size(); ++at_) {
      if (text_[at_] != '"') {
        out += text_[at_];
      } else if (at_ + 1 < text_.size() && text_[at_ + 1] == '"') {
        out += text_[++at_];
      } else {
        ++at_;
        return out;
      }
    }
    return std::nullopt;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

using Words3 = std::array<std::string_view, 3>;
constexpr std::array<std::string_view, 2> kCompound{"COMPOUNDCRS", "COMPD_CS"};
constexpr Words3 kProjected{"PROJCRS", "PROJCS", "PROJECTEDCRS"};
constexpr std::array<std::string_view, 5> kGeodetic{"GEOGCRS", "GEOGCS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"};
constexpr std::array<std::string_view, 2> kEllipsoid{"ELLIPSOID", "SPHEROID"};
constexpr std::array<std::string_view, 2> kIdentifier{"ID", "AUTHORITY"};

template <std::size_t N>
bool is_one_of(const std::string& word, const std::array<std::string_view, N>& words) {
  for (const std::string_view w : words) {
    if (word == w) return true;
  }
  return false;
}

/// The node that defines x and y.
const Node* horizontal_part(const Node& root) {
  const Node* part = &root;
  for (int i = 0; i < 4; ++i) {
    if (part->keyword == "BOUNDCRS") {
      const Node* source = part->child(std::array<std::string_view, 1>{"SOURCECRS"});
      if (source == nullptr || source->nodes.empty()) return part;
      part = &source->nodes.front();
    } else if (is_one_of(part->keyword, kCompound)) {
      const Node* first = part->child(kProjected);
      if (first == nullptr) first = part->child(kGeodetic);
      if (first == nullptr) first = part->child(std::array<std::string_view, 1>{"BOUNDCRS"});
      if (first == nullptr) return part;
      part = first;
    }
  }
  return part;
}

/// The unit of the first axis, in the standard's unit: radians or metres.
std::optional<double> unit_of(const Node& part, std::string_view kind) {
  const std::array<std::string_view, 2> units{kind, "UNIT"};
  const Node* unit = part.child(units);
  if (unit == nullptr) {
    const Node* axis = part.child(std::array<std::string_view, 1>{"AXIS"});
    if (axis != nullptr) unit = axis->child(units);
  }
  const std::optional<double> factor = unit == nullptr ? std::nullopt : unit->number(1);
  return factor && *factor > 0 ? factor : std::nullopt;
}

bool is_cartesian(const Node& part) {
  const Node* system = part.child(std::array<std::string_view, 1>{"CS"});
  return system != nullptr && !system->values.empty() && system->values.front() == "CARTESIAN";
}

}  // namespace

CrsFacts facts_of_wkt(std::string_view wkt) {
  CrsFacts facts;
  const std::optional<Node> root = Parser(wkt).node();
  if (!root) return facts;
  if (!root->values.empty()) facts.name = root->values.front();
  const Node& part = *horizontal_part(*root);
  for (const Node* named : {&*root, &part}) {
    const Node* id = named->child(kIdentifier);
    if (facts.epsg != 0 || id == nullptr || id->values.empty() || id->values.front() != "EPSG") continue;
    if (const auto code = id->number(1); code && *code >= 1 && *code < 1e6) facts.epsg = static_cast<int>(*code);
  }
  if (is_one_of(part.keyword, kGeodetic) && !is_cartesian(part)) {
    const Node* ellipsoid = part.descendant(kEllipsoid);
    if (ellipsoid == nullptr) return facts;
    const auto radius = ellipsoid->number(1), inverse = ellipsoid->number(2);
    const Node* unit = ellipsoid->child(std::array<std::string_view, 1>{"LENGTHUNIT"});
    const double metres = unit == nullptr ? 1 : unit->number(1).value_or(1);
    if (!radius || !inverse || !(*radius * metres > 0)) return facts;
    facts.is_geographic = true;
    facts.equatorial_radius = *radius * metres;
    facts.flattening = *inverse == 0 ? 0 : 1 / *inverse;
    facts.degrees_per_unit = unit_of(part, "ANGLEUNIT").value_or(std::numbers::pi / 180) * 180 / std::numbers::pi;
  } else {
    facts.metres_per_unit = unit_of(part, "LENGTHUNIT").value_or(1);
  }
  return facts;
}

}  // namespace talus
