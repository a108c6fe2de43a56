#include "ingest/job/left_work.hpp"

#include <fmt/format.h>

#include "engine/machine/fail.hpp"
#include "engine/page/page_codec.hpp"
#include "engine/page/tile_slice.hpp"
#include "engine/tile/tile_summary.hpp"
#include "ingest/job/plan.hpp"
#include "ingest/job/stored_bytes.hpp"
#include "storage/page_store.hpp"

namespace talus {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& what) { throw Failure(Cause::corrupt, what); }

std::string name(PageId id) { return fmt::format("page {}/{} of band {}", id.x, id.y, id.band); }

StoredPage require(const ReadTxn& txn, PageKey key, const std::string& what) {
  const auto stored = txn.find(key);
  if (!stored) refuse(what + " is missing");
  return *stored;
}

class Check {
 public:
  Check(const ReadTxn& txn, const Description& d, const std::function<void()>& tell)
      : txn_(txn),
        extent_(d.extent),
        bands_(band_count(d.extent)),
        distance_(d),
        keeps_all_(d.kept_above().value == 0),
        tell_(tell) {}

  void run() {
    txn_.for_each(kHeaderTable, [&](std::uint64_t at) {
      require(txn_, {kHeaderTable, at}, fmt::format("part {} of the header", at));
    });
    std::uint64_t known[2] = {0, 0}, stored[2] = {0, 0};  // pages of bands 0 and 1: counted by the records, and stored
    txn_.for_each(kRecordTable, [&](std::uint64_t at) { tile(at, known); });
    for (int band = 0; band < kRecordTable; ++band) {
      txn_.for_each(band, [&](std::uint64_t at) {
        if (band < 2) {
          ++stored[band];
        } else {
          static_cast<void>(decoded(page_at(band, at)));
        }
      });
    }
    for (const int band : {0, 1}) {
      if (stored[band] != known[band])
        refuse(fmt::format("{} pages of band {} are stored; the records of the tiles count {}", stored[band], band,
                           known[band]));
    }
  }

 private:
  struct Found {
    const Page& page;
    std::uint32_t generation;
  };
  Found decoded(PageId id) {
    const StoredPage stored = require(txn_, {id.band, curve_position(id)}, name(id));
    return {decoder_.decode(id, extent_, bands_, distance_, stored.content, content_in(txn_)), stored.generation};
  }

  void tile(std::uint64_t position, std::uint64_t* known) {
    const PageId id = page_at(1, position);
    const StoredPage record =
        require(txn_, {kRecordTable, position}, fmt::format("the record of tile {}/{}", id.x, id.y));
    const TileSummary summary = decode_tile_summary(record.content);
    if (summary.entry.present != txn_.has({1, position}))
      refuse(name(id) + (summary.entry.present ? " is missing" : " is not in the record of its tile"));
    if (!summary.entry.present) return;
    ++known[1];
    const Found found = decoded(id);
    if (found.generation != summary.entry.generation)
      refuse(fmt::format("{} and the record of its tile are from different updates", name(id)));
    if (keeps_all_ || found.page.is_sliced()) slice(id, found.generation);
    const auto children = found.page.children;
    for (std::size_t i = 0; i < children.size(); ++i) {
      const PageId below = child_page(id, i);
      if (children[i].present != txn_.has({below.band, curve_position(below)}))
        refuse(name(below) + (children[i].present ? " is missing" : " is unknown to the page above it"));
      if (!children[i].present) continue;
      ++known[0];
      if (decoded(below).generation != children[i].generation)
        refuse(fmt::format("{} and the page above it are from different updates", name(below)));
    }
    tell_();
  }

  void slice(PageId tile, std::uint32_t generation) {
    const std::string name = fmt::format("the slice of tile {}/{}", tile.x, tile.y);
    const StoredPage stored = require(txn_, {kSliceTable, curve_position(tile)}, name);
    if (stored.generation != generation) refuse(name + " and its pages are from different updates");
    static_cast<void>(slices_.decode({tile.x, tile.y}, extent_, distance_, stored.content));
  }

  const ReadTxn& txn_;
  GridRect extent_;
  int bands_;
  CodeDistance distance_;
  bool keeps_all_;
  const std::function<void()>& tell_;
  PageDecoder decoder_;
  SliceCoder slices_;
};

/// The message without "corrupt: FILE: " at its front.
std::string words_of(const Failure& f, const fs::path& file) {
  std::string words = f.what();
  for (const std::string& front : {std::string("corrupt: "), file.string() + ": "}) {
    if (words.starts_with(front)) words.erase(0, front.size());
  }
  return words;
}

}  // namespace

LeftWork left_work_in(const fs::path& part) {
  LeftWork work;
  const auto damaged = [&](std::string how) {
    work.kind = LeftWork::Kind::damaged;
    work.damage = std::move(how);
    return work;
  };
  try {
    if (const auto findings = check_structure(part); !findings.empty()) return damaged(findings.front());
    const ReadTxn txn(PageStore::open(part));
    work.tiles = txn.summary(kRecordTable).pages;
    const auto plan = txn.find({kHeaderTable, kPlanPosition});
    if (!plan) {
      if (work.tiles > 0) return damaged("it has tiles, but no plan");
      return work;
    }
    work.plan.assign(reinterpret_cast<const char*>(plan->content.data()), plan->content.size());
    work.title = title_of(work.plan);
    if (!work.plan.empty()) {
      work.kind = is_plan_of_ingest(work.plan) ? LeftWork::Kind::ingest : LeftWork::Kind::update;
      return work;
    }
    const auto made = txn.find({kHeaderTable, kProvenancePosition});
    if (!made) return damaged("it has no list of its inputs");
    work.made = decode_provenance(made->content);
    const bool is_update = work.made->generation > 0;
    work.kind = is_update ? LeftWork::Kind::update : LeftWork::Kind::finished;
    if (is_update) work.title = "finished, but not yet in place of the database";
  } catch (const Failure& f) {
    if (f.cause() != Cause::corrupt && f.cause() != Cause::unsupported) throw;
    return damaged(words_of(f, part));
  }
  return work;
}

void verify_left_work(const fs::path& part, const Description& description, const std::function<void()>& tell) {
  try {
    const ReadTxn txn(PageStore::open(part));
    Check(txn, description, tell).run();
  } catch (const Failure& f) {
    if (f.cause() != Cause::corrupt) throw;
    fail_in(part, Cause::corrupt, "{}: is damaged: {}. It cannot be resumed; start again with IngestOptions::overwrite",
            part.string(), words_of(f, part));
  }
}

}  // namespace talus
