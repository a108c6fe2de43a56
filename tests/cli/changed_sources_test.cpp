// Inputs that change between an interruption and --resume, or while they are read.

#include "talus/talus.hpp"
#include "tests/cli/command.hpp"
#include "tests/support/stored_pages.hpp"

namespace talus::support {
namespace {

namespace fs = std::filesystem;

class ChangedSource : public Command {
 protected:
  void SetUp() override { raster = fit(fractal(2300, 1500, 6, 2000), SampleType::int16); }

  /// Runs an ingest until a tile is done, then `what` in the same shell.
  Outcome until_a_tile_is_done(const std::string& input, const std::string& what) const {
    RunOptions options;
    options.folder = folder.path().string();
    const std::string start = "rm -f said; " + std::string(TALUS_PROGRAM) + " ingest " + input +
                              " a.talus --threads 1 --memory 300MiB --progress=json 2>said & "
                              "while ! grep -q '\"samples\":[1-9]' said 2>/dev/null; do sleep 0.005; done; ";
    const Outcome outcome = run_program({"sh", "-c", start + what + "; wait $!"}, options);
    return outcome;
  }
  void interrupt(const std::string& input) const {
    for (int again = 0; again < 20; ++again) {
      fs::remove(folder / "a.talus");
      if (until_a_tile_is_done(input, "kill -INT $!").exit_code == 130) break;
    }
    ASSERT_TRUE(fs::exists(folder / "a.talus.part")) << "was not interrupted in time";
  }
  std::string said() const { return bytes_of(folder / "said"); }

  Terrain higher(double by) const {
    Terrain changed = raster;
    for (double& h : changed.values) h += by;
    return fit(changed, SampleType::int16);
  }
  void make_vrt(const std::string& name, const std::string& source) const {
    std::ofstream(folder / name) << "<VRTDataset rasterXSize='2300' rasterYSize='1500'><GeoTransform>0,1,0,0,0,-1"
                                    "</GeoTransform><VRTRasterBand dataType='Int16' band='1'><SimpleSource>"
                                    "<SourceFilename relativeToVRT='1'>"
                                 << source << "</SourceFilename><SourceBand>1</SourceBand></SimpleSource>"
                                 << "</VRTRasterBand></VRTDataset>";
  }
  void make_bil(const std::string& stem, const Terrain& terrain) const {
    std::string bytes;
    for (const double h : terrain.values) {
      const auto code = static_cast<std::uint16_t>(static_cast<std::int16_t>(h));
      bytes += static_cast<char>(code & 255u);
      bytes += static_cast<char>(code >> 8);
    }
    write_bytes(folder / (stem + ".bil"), bytes);
    make_hdr(stem, 0);
  }
  void make_hdr(const std::string& stem, int ulxmap) const {
    std::ofstream(folder / (stem + ".hdr"))
        << "NROWS 1500\nNCOLS 2300\nNBANDS 1\nNBITS 16\nPIXELTYPE SIGNEDINT\nBYTEORDER I\n"
           "LAYOUT BIL\nULXMAP "
        << ulxmap << "\nULYMAP 1500\nXDIM 1\nYDIM 1\n";
  }

  /// --resume after `change` names `file`, and no database comes of it.
  template <class Change>
  void expect_refused(const std::string& input, Change&& change, const std::string& file) {
    SCOPED_TRACE(input + ", " + file);
    interrupt(input);
    change();
    const Outcome outcome = talus({"ingest", input, "a.talus", "--resume"});
    EXPECT_NE(outcome.exit_code, done);
    EXPECT_EQ(outcome.signal, 0);
    EXPECT_THAT(outcome.err, ::testing::HasSubstr(file));
    EXPECT_THAT(outcome.err, ::testing::HasSubstr("--overwrite"));
    EXPECT_FALSE(fs::exists(folder / "a.talus"));
    fs::remove(folder / "a.talus.part");
    fs::remove(folder / "a.talus");
  }
};

TEST_F(ChangedSource, IsNamedByResumeWhateverFileBehindTheInputItIs) {
  const auto write = [&](const std::string& name, double by) { write_raster(higher(by), folder / name); };
  write("plain.tif", 0);
  expect_refused(
      "plain.tif", [&] { write("plain.tif", 500); }, "plain.tif");

  write("source.tif", 0);
  make_vrt("one.vrt", "source.tif");
  expect_refused(
      "one.vrt", [&] { write("source.tif", 500); }, "source.tif");
  make_vrt("two.vrt", "one.vrt");
  expect_refused(
      "two.vrt", [&] { write("source.tif", 1); }, "source.tif");
  expect_refused(
      "two.vrt", [&] { write("other.tif", 0), make_vrt("one.vrt", "other.tif"); }, "one.vrt");

  make_bil("raw", raster);
  expect_refused(
      "raw.bil", [&] { make_bil("raw", higher(500)); }, "raw.bil");
  expect_refused(
      "raw.bil", [&] { make_hdr("raw", 100); }, "raw.hdr");
  make_hdr("raw", 0);
  const std::string crs = R"(LOCAL_CS["elsewhere",UNIT["metre",1]])";
  expect_refused(
      "raw.bil", [&] { write_bytes(folder / "raw.prj", crs); }, "raw.prj");
}

TEST_F(ChangedSource, SideFilesCount) {
  make_raster("side.tif");
  const auto statistics = [&](int minimum) {
    std::ofstream(folder / "side.tif.aux.xml") << "<PAMDataset><PAMRasterBand band=\"1\"><Metadata><MDI key=\"NOTE\">"
                                               << minimum << "</MDI></Metadata></PAMRasterBand></PAMDataset>";
  };
  expect_refused(
      "side.tif", [&] { statistics(100); }, "side.tif.aux.xml");  // it has come
  expect_refused(
      "side.tif", [&] { statistics(1000); }, "side.tif.aux.xml");  // it has changed
  expect_refused(
      "side.tif", [&] { fs::remove(folder / "side.tif.aux.xml"); }, "side.tif.aux.xml");  // it is gone
  Terrain mask = raster;
  for (std::size_t i = 0; i < mask.values.size(); ++i) mask.values[i] = i % 7 == 0 ? 0 : 255;
  RasterOptions bytes;
  bytes.type = SampleType::uint8;
  expect_refused(
      "side.tif",
      [&] {
        write_raster(mask, folder / "mask.tif", bytes);
        fs::rename(folder / "mask.tif", folder / "side.tif.msk");
      },
      "side.tif.msk");
}

TEST_F(ChangedSource, OtherTimesOverTheSameBytesChangeNothing) {
  make_raster("source.tif");
  make_vrt("a.vrt", "source.tif");
  interrupt("a.vrt");
  fs::copy_file(folder / "source.tif", folder / "copy.tif");
  fs::rename(folder / "copy.tif", folder / "source.tif");  // another inode and other times
  fs::last_write_time(folder / "a.vrt", fs::file_time_type::clock::now() - std::chrono::hours(1000));
  const Outcome outcome = talus({"ingest", "a.vrt", "a.talus", "--resume"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "a.vrt"}).exit_code, done);
}

TEST_F(ChangedSource, IsNoticedWhenItIsRewrittenDuringTheIngest) {
  make_raster("source.tif");
  make_vrt("a.vrt", "source.tif");
  write_raster(higher(500), folder / "other.tif");
  for (const std::string how : {"cp other.tif source.tif", "mv other.tif source.tif", "rm source.tif",
                                "printf x | dd of=source.tif bs=1 seek=3000000 conv=notrunc 2>/dev/null"}) {
    SCOPED_TRACE(how);
    bool is_noticed = false;
    for (int again = 0; again < 20 && !is_noticed; ++again) {
      fs::remove(folder / "a.talus");
      make_raster("source.tif");
      write_raster(higher(500), folder / "other.tif");
      const Outcome outcome = until_a_tile_is_done("a.vrt", "kill -STOP $!; " + how + "; kill -CONT $!");
      is_noticed = outcome.exit_code == failed;
      if (is_noticed) break;
      // The change came when all had been read, and the last look was over: it is none of the database's business.
      ASSERT_EQ(outcome.exit_code, done) << said();
      const Snapshot now = Database::open(folder / "a.talus").snapshot();
      ASSERT_EQ(now.samples(now.description().extent).values, raster.values);
    }
    ASSERT_TRUE(is_noticed) << "in twenty tries";
    EXPECT_THAT(said(), ::testing::HasSubstr("source.tif"));
    EXPECT_FALSE(fs::exists(folder / "a.talus"));
    EXPECT_FALSE(fs::exists(folder / "a.talus.part")) << "some of it may be of the other file";
  }
}

TEST_F(ChangedSource, ThatHasOnlyNewTimesDoesNotStopTheIngest) {
  make_raster("source.tif");
  const Outcome outcome =
      until_a_tile_is_done("source.tif", "touch source.tif; cp source.tif b.tif; mv b.tif source.tif");
  EXPECT_EQ(outcome.exit_code, done) << said();
  EXPECT_EQ(talus({"verify", "a.talus", "--against", "source.tif"}).exit_code, done);
}

}  // namespace
}  // namespace talus::support
