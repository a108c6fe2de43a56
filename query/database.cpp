#include "talus/database.hpp"

#include <utility>

#include "engine/geo/longitude.hpp"
#include "engine/machine/fail.hpp"
#include "engine/machine/parallel.hpp"
#include "query/ask.hpp"
#include "query/pages/nearby_pages.hpp"
#include "query/pages/placed_rectangle.hpp"
#include "query/selection/refusals.hpp"
#include "query/snapshot_view.hpp"
#include "query/surface/heights.hpp"

namespace talus {

struct Database::Opened {
  PageStore store;
  std::shared_ptr<PageCache> cache;  ///< shared with snapshots, which may outlive this
  std::filesystem::path file;        ///< the path that it was opened by
  OpenOptions options;
};

Database::Database(std::shared_ptr<Opened> opened) : opened_(std::move(opened)) {}

Database Database::open(const std::filesystem::path& file, const OpenOptions& options) {
  return within_memory([&] {
    return blaming(file, [&] {
      Database database(std::make_shared<Opened>(
          Opened{PageStore::open(file), std::make_shared<PageCache>(options.cache_bytes), file, options}));
      (void)database.snapshot();  // fails here, not at the first question, if the header cannot be read
      return database;
    });
  });
}

bool Database::is_current() const { return opened_->store.is_file(opened_->file); }

Database Database::reopen() const { return is_current() ? *this : open(opened_->file, opened_->options); }

Snapshot Database::snapshot() const {
  return within_memory([&] {
    return Snapshot(std::make_unique<Snapshot::View>(
        Snapshot::View{StoredPages(opened_->store, opened_->cache), threads_or_all(opened_->options.threads)}));
  });
}

Snapshot::Snapshot(std::unique_ptr<View> view) : view_(std::move(view)) {}
Snapshot::~Snapshot() = default;
Snapshot::Snapshot(Snapshot&&) noexcept = default;
Snapshot& Snapshot::operator=(Snapshot&&) noexcept = default;

const Description& Snapshot::description() const { return view_->pages.manifest().description; }

const StoredPages& pages_of(const Snapshot& snapshot) { return snapshot.view_->pages; }

StorageSummary Snapshot::storage() const {
  const Manifest& manifest = view_->pages.manifest();
  const ReadTxn& txn = view_->pages.transaction();
  StorageSummary summary;
  summary.format_version = kFormatVersion;
  summary.file_bytes = txn.file_bytes();
  for (int band = 0; band < manifest.bands; ++band) {
    const TableSummary table = txn.summary(band);
    summary.bands.push_back({band_spacing(band), table.pages, table.bytes});
    summary.pages += table.pages;
    summary.page_bytes += table.bytes;
  }
  const TableSummary slices = txn.summary(kSliceTable);
  summary.slices = slices.pages;
  summary.slice_bytes = slices.bytes;
  return summary;
}

Provenance Snapshot::provenance() const {
  return within_memory([&] {
    const auto stored = view_->pages.transaction().find({kHeaderTable, kProvenancePosition});
    Provenance provenance = stored ? decode_provenance(stored->content) : Provenance{};
    provenance.identity = view_->pages.identity();
    return provenance;
  });
}

PlacedRectangle Snapshot::region(const Rectangle& rectangle) const {
  return within_memory([&] { return placed(rectangle, description(), view_->pages.longitudes()); });
}

Answer Snapshot::ask(const Question& question) const {
  return within_memory([&] { return answer_to(view_->pages, question, view_->threads); });
}

std::vector<Answer> Snapshot::ask_together(std::span<const Question> questions) const {
  return within_memory([&] { return answers_to(view_->pages, questions); });
}

Mesh Snapshot::mesh(Metres tolerance) const {
  Question question;
  question.tolerance = tolerance;
  return triangulate(ask(question).quadtree, view_->threads);
}

Mesh Snapshot::mesh(const Rectangle& rectangle, Metres tolerance) const {
  Question question;
  question.rectangle = rectangle;
  question.tolerance = tolerance;
  return triangulate(ask(question).quadtree, view_->threads);
}

std::optional<double> Snapshot::height(double x, double y, std::optional<Metres> surface) const {
  const Position point{x, y};
  std::optional<double> height;
  heights({&point, 1}, {&height, 1}, surface);
  return height;
}

QueryCost Snapshot::heights(std::span<const Position> points, std::span<std::optional<double>> out,
                            std::optional<Metres> surface) const {
  if (points.size() != out.size()) {
    refuse("{} points, but {} heights: expected one height for each point", points.size(), out.size());
  }
  return within_memory([&] {
    if (!surface) return sampled_heights(view_->pages, points, out);
    return surface_heights(view_->pages, view_->pages.extent_border(), *surface, points, out);
  });
}

Profile Snapshot::profile(std::span<const Position> line, Metres tolerance) const {
  return within_memory([&] { return talus::profile(view_->pages, view_->pages.extent_border(), line, tolerance); });
}

SampleWindow Snapshot::samples(GridRect region) const {
  return within_memory([&] { return all_samples(view_->pages, region); });
}

Increment increment_of(Answer answer) {
  if (!answer.from)
    throw Failure(Cause::invalid_argument, "the answer is not an increment: ask for one with Question::from");
  return {std::move(answer.quadtree), *answer.from, std::move(answer.cost)};
}

std::vector<double> errors_of(const Snapshot& now, const RestrictedQuadtree& answer) {
  return within_memory([&] {
    std::vector<double> errors;
    if (answer.vertices.size() == 0) return errors;
    const StoredPages& pages = pages_of(now);
    require_inside(pages, answer.vertices.region());
    errors.reserve(answer.vertices.size());
    QueryCost unused;
    NearbyPages nearby(pages, unused);  // rows of vertices come back to the same pages: the cache has them
    answer.vertices.for_each([&](GridPoint p) {
      const Page* page = nearby.page_of_vertex(p);
      if (page == nullptr) {
        fail_in(pages.file(), Cause::corrupt, "corrupt: {}: no page has the error of the vertex at column {}, row {}",
                pages.file().string(), p.col, p.row);
      }
      errors.push_back(page->error_m(page->index(p), pages.distance()));
    });
    return errors;
  });
}

bool is_inside(const Snapshot& now, Position point) {
  const GridRect& extent = now.description().extent;
  return contains(extent, grid_place(now.description().mapping, pages_of(now).longitudes().among(point, extent)));
}

}  // namespace talus
