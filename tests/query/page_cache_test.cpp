#include "query/pages/page_cache.hpp"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "query/pages/stored_pages.hpp"
#include "talus/ingest.hpp"
#include "talus/talus.hpp"
#include "tests/support/random.hpp"
#include "tests/support/raster_file.hpp"

namespace talus {
namespace {

using namespace support;

Page page_of_number(std::int32_t number) {
  Page page;
  page.id = {0, number, -number};
  page.heights.assign(1000, number);
  page.errors.assign(1000, static_cast<ErrorCode>(number));
  return page;
}
PageCache::Key key_of(std::int32_t number) { return {0, static_cast<std::uint64_t>(number), 0}; }

TEST(PageCache, FindsWhatItKeeps) {
  PageCache cache(1 << 20);
  EXPECT_EQ(cache.find(key_of(7)), nullptr);
  const auto kept = cache.keep(key_of(7), page_of_number(7));
  EXPECT_EQ(kept->heights, page_of_number(7).heights);
  EXPECT_EQ(cache.find(key_of(7)), kept);
  EXPECT_EQ(cache.find(key_of(8)), nullptr);
  EXPECT_EQ(cache.find({1, 7, 0}), nullptr);
  EXPECT_EQ(cache.find({0, 7, 1}), nullptr) << "another update's page";
}

TEST(PageCache, WhatWasNotUsedForLongestGoesFirst) {
  PageCache cache(45000);  // four pages of 10 kB and their shells, one shard
  for (int i = 0; i < 4; ++i) (void)cache.keep(key_of(i), page_of_number(i));
  ASSERT_NE(cache.find(key_of(0)), nullptr);
  (void)cache.keep(key_of(4), page_of_number(4));
  EXPECT_NE(cache.find(key_of(0)), nullptr);
  EXPECT_EQ(cache.find(key_of(1)), nullptr);
  EXPECT_NE(cache.find(key_of(4)), nullptr);
}

TEST(PageCache, APageThatIsHeldStaysWhatItWas) {
  PageCache cache(15000);
  const auto held = cache.keep(key_of(1), page_of_number(1));
  for (int i = 2; i < 100; ++i) {
    const PageCache::BorrowedDecoder decoder = cache.borrow_decoder();  // whoever decodes may use memory again
    (void)cache.keep(key_of(i), page_of_number(i));
  }
  EXPECT_EQ(cache.find(key_of(1)), nullptr);
  EXPECT_EQ(held->heights, page_of_number(1).heights);
}

TEST(PageCache, MayBeGoneBeforeItsPages) {
  auto cache = std::make_unique<PageCache>(1 << 20);
  const auto held = cache->keep(key_of(1), page_of_number(1));
  cache.reset();
  EXPECT_EQ(held->heights, page_of_number(1).heights);
}

TEST(PageCache, OfNoBytesKeepsNothing) {
  PageCache cache(0);
  EXPECT_EQ(cache.keep(key_of(1), page_of_number(1))->heights, page_of_number(1).heights);
  EXPECT_EQ(cache.find(key_of(1)), nullptr);
  EXPECT_EQ(cache.bytes(), 0u);
}

TEST(PageCache, ThreadsThatFightForFewBytesGetTheirOwnPages) {
  for (const std::uint64_t most : {0, 25000, 60000, 400000}) {
    PageCache cache(most);
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (std::uint64_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        Random random(t);
        for (int i = 0; i < 5000; ++i) {
          const std::int32_t number = random.between(0, 60);
          auto page = cache.find(key_of(number));
          if (!page) {
            const PageCache::BorrowedDecoder decoder = cache.borrow_decoder();
            page = cache.keep(key_of(number), page_of_number(number));
          }
          if (page->id.x != number || page->heights.front() != number || page->heights.back() != number) ++wrong;
          if (cache.bytes() > most) ++wrong;
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0) << most << " bytes";
  }
}

class SharedPages : public ::testing::Test {
 protected:
  SharedPages() {
    write_raster(fit(random_voids(fractal(700, 500, 3), 0.01, 4), SampleType::int16), folder_ / "a.tif");
    ingest(folder_ / "a.tif", folder_ / "a.talus");
  }
  TempFolder folder_;
};

TEST_F(SharedPages, AreThoseOfTheFileWhateverTheCache) {
  const PageStore store = PageStore::open(folder_ / "a.talus");
  for (const std::uint64_t most : {0, 1 << 20, 64 << 20}) {
    const auto cache = std::make_shared<PageCache>(most);
    const StoredPages pages(store, cache);
    const auto ids = pages_of_band(0, pages.manifest().description.extent);
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (std::uint64_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        Random random(t);
        PageDecoder decoder;
        QueryCost cost, unused;
        for (int i = 0; i < 60; ++i) {
          const PageId id = ids[static_cast<std::size_t>(random.between(0, static_cast<int>(ids.size()) - 1))];
          const auto shared = pages.shared(id, 0, cost);
          const Page& page = pages.get(id, 0, decoder, unused);
          if (shared->heights != page.heights || shared->errors != page.errors || shared->eighths != page.eighths ||
              shared->valid != page.valid || shared->covers != page.covers) {
            ++wrong;
          }
        }
        if (cost.pages_read + cost.pages_cached != 60 || (most == 0 && cost.pages_cached != 0)) ++wrong;
        if (cache->bytes() > most) ++wrong;
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0) << most << " bytes";
  }
}

TEST_F(SharedPages, OfAnotherGenerationAreRefusedAndNotKept) {
  const auto cache = std::make_shared<PageCache>(1 << 20);
  const StoredPages pages(PageStore::open(folder_ / "a.talus"), cache);
  QueryCost cost;
  EXPECT_THROW(static_cast<void>(pages.shared({0, 0, 0}, 5, cost)), Failure);
  EXPECT_EQ(cache->bytes(), 0u);
}

}  // namespace
}  // namespace talus
