#include "query/verify/verify_pages.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace talus {
namespace {

class PageChecks {
 public:
  PageChecks(const StoredPages& pages, DecodedPages& decoded, Findings& findings, VerifyReport& report,
             const std::function<void()>& told)
      : pages_(pages), decoded_(decoded), findings_(findings), report_(report), told_(told) {}

  CheckedPages run() {
    CheckedPages of_band_1;
    for (int band = 0; band < manifest_.bands; ++band) {
      CheckedPages here;
      std::vector<PageId> stored;
      pages_.transaction().for_each(
          band, [&](std::uint64_t position) { stored.push_back(page_at(band, position)); },
          [&](std::uint64_t first, const Failure& f) {
            const std::uint64_t pages = band == 0 ? kTilePages : 1;
            if (band == 0) findings_.in(page_square(parent_page(page_at(band, first))), f.what());
            for (std::uint64_t i = 0; i < pages; ++i) here[first + i].is_readable = false;
          });
      for (const PageId id : stored) visit(id, here);
      for (const auto& [position, page] : below_) {
        const PageId id = page_at(band - 1, position);
        if (band > 0 && page.entry.present && !here.contains(curve_position(parent_page(id))))
          findings_.in(id, "the page above it is missing");
      }
      if (band == 1) of_band_1 = here;
      below_ = std::move(here);
    }
    check_tops();
    for (int band = manifest_.bands; band < kRecordTable; ++band) {
      pages_.transaction().for_each(
          band,
          [&](std::uint64_t position) {
            findings_.in(page_at(band, position),
                         fmt::format("a database of {} bands has no such page", manifest_.bands));
          },
          [](std::uint64_t, const Failure&) {});
    }
    return of_band_1;
  }

 private:
  void visit(PageId id, CheckedPages& here) {
    ++report_.pages;
    told_();
    if (!overlap(page_square(id), extent_)) return findings_.in(id, "lies outside the extent");
    const DecodedPages::Found found = decoded_.get(id);
    CheckedPage& checked = here[curve_position(id)];
    checked.entry.present = true;
    if (!found.page) {
      checked.is_readable = false;
      return findings_.in(page_square(id), found.is_damaged() ? found.damage : name_of(id) + ": missing");
    }
    if (found.generation > manifest_.generation) {
      findings_.in(id, fmt::format("written by update {}, but the database has had only {}", found.generation,
                                   manifest_.generation));
    }
    check_own(*found.page);
    check_against_above(*found.page);
    checked.entry = with_children(*found.page);
    if (found.page->is_dense && pages_.distance().is_whole()) find_largest(*found.page, checked);
    checked.entry.generation = found.generation;
  }

  /// Checks the errors of own vertices. Reports each kind of finding once per page.
  void check_own(const Page& page) {
    if (page.is_sliced() && !drops_)
      findings_.in(page.id, "heights were left out, but the header says that all were kept");
    any_sample(page.grid, [&](std::size_t i, GridPoint p) {
      if (!page.is_own(p) || spacing(p) == kRootSpacing) return false;
      return page.error(i, pages_.distance()) > dropped_ &&
             !are_parents_above(page, p, page.error_m(i, pages_.distance()));
    });
  }
  static void find_largest(const Page& page, CheckedPage& checked) {
    const SquareBits implied = implied_places(data_samples(page));
    for (std::size_t i = 0; i < page.grid.size(); ++i) {
      std::int32_t& largest = has(implied, page.in_square(i)) ? checked.largest_implied : checked.largest_stored;
      largest = std::max(largest, page.dense_error(i));
    }
  }
  /// Whether a code is the largest error of a page. A dense page has stored errors rounded up from their codes.
  [[nodiscard]] bool is_largest(ErrorCode said, const CheckedPage& checked) const {
    if (checked.largest_implied < 0 && checked.largest_stored < 0) return said == checked.entry.largest;
    const CodeDistance& distance = pages_.distance();
    const ErrorCode implied =
        checked.largest_implied < 0 ? ErrorCode{0} : error_code(distance.metres(checked.largest_implied / 8.0));
    const std::int32_t eighths = distance.eighths(error_of(said));
    return said == implied ? checked.largest_stored <= eighths : said > implied && checked.largest_stored == eighths;
  }

  [[nodiscard]] bool are_parents_above(const Page& page, GridPoint p, double own_m) {
    for (const GridPoint parent : diamond(p).apexes) {
      if (!extent_.contains(parent)) continue;
      const PageId id = page_of(parent, band_of(parent, manifest_.bands));
      std::shared_ptr<const Page> other;
      const Page* there = &page;
      if (!(id == page.id)) {
        const DecodedPages::Found found = decoded_.get(id);
        if (found.is_damaged()) continue;  // already reported
        other = found.page;
        there = other.get();
      }
      const double above_m = there == nullptr ? 0 : there->error_m(there->index(parent), pages_.distance());
      if (above_m >= own_m) continue;
      findings_.in(page_square(id),
                   fmt::format("{}: the error at column {}, row {} is {} m, which is below the {} m of a vertex in {} "
                               "that depends on it",
                               name_of(id), parent.col, parent.row, above_m, own_m, name_of(page.id)));
      return false;
    }
    return true;
  }

  /// Compares the samples that the page above has, too.
  void check_against_above(const Page& page) {
    if (page.id.band + 1 >= manifest_.bands) return;
    const DecodedPages::Found found = decoded_.get(parent_page(page.id));
    if (!found.page) return;  // already reported
    const Page& above = *found.page;
    any_sample(page.grid, [&](std::size_t here, GridPoint p) {
      if (page.is_own(p)) return false;
      const std::size_t there = above.index(p);
      const bool is_data = page.is_data(here), is_data_above = above.is_data(there);
      if (is_data == is_data_above && (!is_data || page.is_dropped(here) || above.is_dropped(there) ||
                                       is_same(page.height(here), above.height(there))))
        return false;
      const auto text = [&](const Page& of, std::size_t i) {
        return of.is_data(i) ? fmt::format("{}", manifest_.description.step.value(of.height(i))) : std::string("void");
      };
      findings_.in(page.id, fmt::format("the sample at column {}, row {} is {}, but {} says {}", p.col, p.row,
                                        text(page, here), name_of(above.id), text(above, there)));
      return true;
    });
  }

  /// The entry that the page above should have of this one. Also checks the page's own entries of pages below.
  [[nodiscard]] ChildEntry with_children(const Page& page) {
    ChildEntry entry = range_of(page, manifest_.description.step);
    for_each_sample(page.grid, [&](std::size_t i, GridPoint p) {
      if (page.is_own(p)) entry.largest = std::max(entry.largest, page.error(i, pages_.distance()));
    });
    for (std::size_t i = 0; i < page.children.size(); ++i) {
      const PageId below = child_page(page.id, i);
      const auto found = below_.find(curve_position(below));
      const bool is_there = found != below_.end();
      const ChildEntry& said = page.children[i];
      if (is_there && !found->second.is_readable) {
        if (said.present) entry = joined(entry, said);
        continue;
      }
      if (is_there != said.present) {
        findings_.in(below, is_there ? "unknown to the page above it" : "missing");
      } else if (is_there) {
        compare(below, said, found->second);
      } else if (has_data_in(page, page_square(below))) {
        findings_.in(below, fmt::format("not stored, but {} has samples there", name_of(page.id)));
      }
      if (said.present) entry = joined(entry, said);
    }
    return entry;
  }

  void compare(PageId below, const ChildEntry& said, const CheckedPage& checked) {
    const ChildEntry& found = checked.entry;
    if (!is_largest(said.largest, checked)) {
      findings_.in(below, fmt::format("largest error {} m, but the page above it says {} m", error_of(found.largest),
                                      error_of(said.largest)));
    } else if (said.generation != found.generation) {
      findings_.in(
          below, fmt::format("written by update {}, but the page above it says {}", found.generation, said.generation));
    } else if (!is_range_of(said, found)) {
      findings_.in(below, fmt::format("heights {} to {}, but the page above it says {} to {}", found.lowest,
                                      found.highest, said.lowest, said.highest));
    }
  }

  [[nodiscard]] static bool has_data_in(const Page& page, GridRect square) {
    bool any = false;
    for_each_in(page.grid, square, [&](std::size_t i, GridPoint) { any = any || page.is_data(i); });
    return any;
  }

  /// Whether the ranges agree. If not all samples were kept, the stated range may be wider.
  [[nodiscard]] bool is_range_of(const ChildEntry& said, const ChildEntry& found) const {
    if (drops_) return said.lowest <= found.lowest && said.highest >= found.highest;
    return said.lowest == found.lowest && said.highest == found.highest;
  }

  /// Checks all pages of the last band, where every query begins.
  void check_tops() {
    const auto tops = pages_of_band(manifest_.bands - 1, extent_);
    for (std::size_t i = 0; i < tops.size(); ++i) {
      const auto found = below_.find(curve_position(tops[i]));
      if (found == below_.end()) {
        findings_.in(tops[i], "missing");
      } else if (found->second.is_readable && found->second.entry.generation != manifest_.top_generations[i]) {
        findings_.in(tops[i], fmt::format("written by update {}, but the header says {}",
                                          found->second.entry.generation, manifest_.top_generations[i]));
      }
    }
  }

  const StoredPages& pages_;
  const Manifest& manifest_ = pages_.manifest();
  GridRect extent_ = manifest_.description.extent;
  bool drops_ = manifest_.description.kept_above().value > 0;  ///< whether not all samples were kept
  /// Pages may store errors up to this one as 0.
  ErrorCode dropped_ = drops_ ? largest_code_within(manifest_.description.kept_above().value) : ErrorCode{0};
  DecodedPages& decoded_;
  Findings& findings_;
  VerifyReport& report_;
  const std::function<void()>& told_;
  CheckedPages below_;
};

}  // namespace

CheckedPages check_pages(const StoredPages& pages, DecodedPages& decoded, Findings& findings, VerifyReport& report,
                         const std::function<void()>& told) {
  return PageChecks(pages, decoded, findings, report, told).run();
}

}  // namespace talus
