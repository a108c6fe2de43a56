// What the program says to bad input, and that it leaves everything as it was.

#include <chrono>
#include <limits>

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/cli/command.hpp"

namespace talus::support {
namespace {

class BadInput : public Command {
 protected:
  /// Runs, expects a refusal, and that the folder is as it was.
  void expect_refused(const std::vector<std::string>& arguments, const std::vector<int>& exit_codes,
                      const std::vector<std::string>& named) const {
    const auto before = contents();
    const auto start = std::chrono::steady_clock::now();
    const Outcome outcome = talus(arguments);
    SCOPED_TRACE("talus " + ::testing::PrintToString(arguments) + ": " + outcome.err);
    expect_refusal(outcome, exit_codes, named);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
    std::string changed;
    for (const auto& [name, bytes] : contents()) {
      if (!before.contains(name) || before.at(name) != bytes) changed += name + " ";
    }
    for (const auto& [name, bytes] : before) {
      if (!std::filesystem::exists(folder / name)) changed += name + " (gone) ";
    }
    EXPECT_EQ(changed, "") << "left behind or changed";
    EXPECT_FALSE(std::filesystem::exists(folder / "out.talus-lock"));
  }
  void write_vrt(const std::string& name, const std::string& size, const std::string& band) const {
    write_bytes(folder / name, "<VRTDataset " + size + ">" + band + "</VRTDataset>");
  }
  static std::string source(const std::string& file, bool relative) {
    return std::string("<VRTRasterBand dataType=\"Int16\" band=\"1\"><SimpleSource><SourceFilename relativeToVRT=\"") +
           (relative ? "1" : "0") + "\">" + file + "</SourceFilename><SourceBand>1</SourceBand>" +
           "<SrcRect xOff=\"0\" yOff=\"0\" xSize=\"90\" ySize=\"70\"/><DstRect xOff=\"0\" yOff=\"0\" xSize=\"90\" "
           "ySize=\"70\"/>" +
           "</SimpleSource></VRTRasterBand>";
  }
  static constexpr const char* usual_size = "rasterXSize=\"90\" rasterYSize=\"70\"";
};

// ---- ingest ----------------------------------------------------------------------------------------

TEST_F(BadInput, NoSuchFile) { expect_refused({"ingest", "missing.tif", "out.talus"}, {failed}, {"missing.tif"}); }

TEST_F(BadInput, AFolder) {
  std::filesystem::create_directory(folder / "somewhere");
  expect_refused({"ingest", "somewhere", "out.talus"}, {failed, usage}, {"somewhere"});
}

TEST_F(BadInput, NotARaster) {
  write_bytes(folder / "notes.txt", "the mountain is high\n");
  expect_refused({"ingest", "notes.txt", "out.talus"}, {failed}, {"notes.txt"});
}

TEST_F(BadInput, AnEmptyFile) {
  write_bytes(folder / "empty.tif", "");
  expect_refused({"ingest", "empty.tif", "out.talus"}, {failed}, {"empty.tif"});
}

TEST_F(BadInput, ATruncatedRaster) {
  make_raster("whole.tif");
  const std::string bytes = bytes_of(folder / "whole.tif");
  for (const std::size_t keep : {std::size_t{4}, std::size_t{100}, bytes.size() / 2, bytes.size() - 900}) {
    write_bytes(folder / "part.tif", bytes.substr(0, keep));
    expect_refused({"ingest", "part.tif", "out.talus"}, {failed}, {"part.tif"});
  }
}

TEST_F(BadInput, NoBands) {
  write_vrt("bare.vrt", usual_size, "");
  expect_refused({"ingest", "bare.vrt", "out.talus"}, {failed, usage}, {"bare.vrt"});
}

TEST_F(BadInput, AllVoid) {
  raster = hole(raster, 0, 0, 100, 100);
  make_raster("void.tif");
  expect_refused({"ingest", "void.tif", "out.talus"}, {usage}, {"void.tif"});
}

TEST_F(BadInput, ComplexNumbers) {
  write_vrt("complex.vrt", usual_size, "<VRTRasterBand dataType=\"CFloat32\" band=\"1\"/>");
  expect_refused({"ingest", "complex.vrt", "out.talus"}, {failed}, {"complex.vrt", "CFloat32"});
}

TEST_F(BadInput, HeightsThatAreNone) {
  for (const double value : {1e7, -1e7, 1e300, std::numeric_limits<double>::infinity()}) {
    raster.at(33, 22) = value;
    RasterOptions options;
    options.type = SampleType::float64;
    make_raster("high.tif", options);
    expect_refused({"ingest", "high.tif", "out.talus"}, {usage}, {"high.tif"});
  }
}

TEST_F(BadInput, ARotatedRaster) {
  RasterOptions options;
  options.geotransform = {0, 1, 0.5, 0, 0.5, -1};
  make_raster("rotated.tif", options);
  expect_refused({"ingest", "rotated.tif", "out.talus"}, {failed}, {"rotated.tif"});
}

TEST_F(BadInput, SizesNobodyHas) {
  for (const char* absurd :
       {"rasterXSize=\"0\" rasterYSize=\"70\"", "rasterXSize=\"-5\" rasterYSize=\"70\"",
        "rasterXSize=\"2147483647\" rasterYSize=\"2147483647\"", "rasterXSize=\"2000000\" rasterYSize=\"2000000\"",
        "rasterXSize=\"99999999999999\" rasterYSize=\"1\""}) {
    SCOPED_TRACE(absurd);
    write_vrt("absurd.vrt", absurd, "<VRTRasterBand dataType=\"Int16\" band=\"1\"/>");
    expect_refused({"ingest", "absurd.vrt", "out.talus"}, {failed, usage}, {"absurd.vrt"});
  }
}

TEST_F(BadInput, ASizeThatIsOnlyClaimed) {
  // A little TIFF that says it is 200,000 samples wide and as high: believed, it would take 80 GB.
  make_raster("little.tif");
  std::string bytes = bytes_of(folder / "little.tif");
  const auto at = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(bytes[i])}; };
  const std::size_t entries = at(4) | at(5) << 8 | at(6) << 16 | at(7) << 24;
  const std::size_t count = at(entries) | at(entries + 1) << 8;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t entry = entries + 2 + 12 * i;
    const std::size_t tag = at(entry) | at(entry + 1) << 8;
    if (tag != 256 && tag != 257) continue;  // width, height
    bytes[entry + 2] = 4;                    // as 32 bits
    for (std::size_t b = 0; b < 4; ++b) bytes[entry + 8 + b] = static_cast<char>(200000 >> (8 * b) & 255);
  }
  write_bytes(folder / "little.tif", bytes);
  expect_refused({"ingest", "little.tif", "out.talus"}, {failed, usage}, {"little.tif"});
}

TEST_F(BadInput, ADatabaseThatIsThereStays) {
  make_raster("a.tif");
  make_database("out.talus");
  expect_refused({"ingest", "a.tif", "out.talus"}, {usage}, {"out.talus", "overwrite"});
  expect_refused({"ingest", "missing.tif", "out.talus", "--overwrite"}, {failed}, {"missing.tif"});
  write_bytes(folder / "notes.txt", "the mountain is high\n");
  expect_refused({"ingest", "notes.txt", "out.talus", "--overwrite"}, {failed}, {"notes.txt"});
}

TEST_F(BadInput, NoFolderForTheDatabase) {
  make_raster("a.tif");
  expect_refused({"ingest", "a.tif", "nowhere/out.talus"}, {failed}, {"nowhere"});
}

TEST_F(BadInput, TheDatabaseIsAFolder) {
  make_raster("a.tif");
  std::filesystem::create_directory(folder / "out.talus");
  expect_refused({"ingest", "a.tif", "out.talus"}, {failed, usage}, {"out.talus"});
  expect_refused({"ingest", "a.tif", "out.talus", "--overwrite"}, {failed, usage}, {"out.talus"});
}

// ---- rasters that point elsewhere ------------------------------------------------------------------

/// A server that nobody may call.
class QuietServer {
 public:
  QuietServer() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof(address);
    if (bind(socket_, reinterpret_cast<sockaddr*>(&address), length) != 0 || listen(socket_, 8) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length) != 0) {
      throw std::runtime_error("no socket to listen on");
    }
    url = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/a.tif";
  }
  ~QuietServer() { close(socket_); }
  [[nodiscard]] bool was_called() const {
    const int call = accept(socket_, nullptr, nullptr);
    if (call >= 0) close(call);
    return call >= 0;
  }
  std::string url;

 private:
  int socket_;
};

TEST_F(BadInput, AVrtThatWouldOpenTheNetwork) {
  const QuietServer server;
  for (const std::string prefix : {"/vsicurl/", "/vsicurl_streaming/", "/vsizip//vsicurl/", "/vsicurl?url=", ""}) {
    for (const bool relative : {false, true}) {
      SCOPED_TRACE(prefix);
      write_vrt("hostile.vrt", usual_size, source(prefix + server.url, relative));
      expect_refused({"ingest", "hostile.vrt", "out.talus"}, {failed, usage}, {"hostile.vrt"});
      EXPECT_FALSE(server.was_called());
    }
  }
  write_bytes(folder / "wms.xml",
              "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>" + server.url +
                  "</ServerUrl></Service><DataWindow><SizeX>90</SizeX><SizeY>70</SizeY></DataWindow></GDAL_WMS>");
  expect_refused({"ingest", "wms.xml", "out.talus"}, {failed, usage}, {"wms.xml"});
  EXPECT_FALSE(server.was_called());
}

TEST_F(BadInput, ANameThatIsAnAddress) {
  const QuietServer server;
  for (const std::string& name : {"/vsicurl/" + server.url, server.url, "WMS:" + server.url}) {
    expect_refused({"ingest", name, "out.talus"}, {failed, usage}, {server.url.substr(7)});
    EXPECT_FALSE(server.was_called());
  }
}

TEST_F(BadInput, AVrtThatReadsElsewhere) {
  const TempFolder elsewhere;
  write_raster(raster, elsewhere / "secret.tif");
  std::filesystem::create_directory(folder / "inner");
  make_raster("outer.tif");
  const std::string absolute = (elsewhere / "secret.tif").string();
  for (const auto& [file, relative] :
       {std::pair(absolute, false), std::pair(absolute, true), std::pair(std::string("../outer.tif"), true),
        std::pair(std::string("../../../../../../../etc/passwd"), true)}) {
    SCOPED_TRACE(file);
    write_vrt("inner/hostile.vrt", usual_size, source(file, relative));
    expect_refused({"ingest", "inner/hostile.vrt", "out.talus"}, {failed, usage}, {"hostile.vrt"});
  }
}

TEST_F(BadInput, AVrtWhoseSourceIsALinkElsewhere) {
  const TempFolder elsewhere;
  write_raster(raster, elsewhere / "secret.tif");
  std::filesystem::create_symlink(elsewhere / "secret.tif", folder / "link.tif");
  write_vrt("hostile.vrt", usual_size, source("link.tif", true));
  expect_refused({"ingest", "hostile.vrt", "out.talus"}, {failed, usage}, {"hostile.vrt"});
}

TEST_F(BadInput, AVrtWithinAVrtThatReadsElsewhere) {
  const TempFolder elsewhere;
  write_raster(raster, elsewhere / "secret.tif");
  write_vrt("inner.vrt", usual_size, source((elsewhere / "secret.tif").string(), false));
  write_vrt("outer.vrt", usual_size, source("inner.vrt", true));
  expect_refused({"ingest", "outer.vrt", "out.talus"}, {failed, usage}, {"vrt"});
}

TEST_F(BadInput, AVrtOfItself) {
  write_vrt("loop.vrt", usual_size, source("loop.vrt", true));
  expect_refused({"ingest", "loop.vrt", "out.talus"}, {failed, usage}, {"loop.vrt"});
}

TEST_F(BadInput, AVrtWhoseSourceIsMissing) {
  write_vrt("lonely.vrt", usual_size, source("missing.tif", true));
  expect_refused({"ingest", "lonely.vrt", "out.talus"}, {failed}, {"missing.tif"});
}

TEST_F(BadInput, NotAVrtBesideItsTiles) {
  make_raster("tile.tif");
  write_vrt("mosaic.vrt", usual_size, source("tile.tif", true));
  const Outcome outcome = talus({"ingest", "mosaic.vrt", "out.talus"});
  EXPECT_EQ(outcome.exit_code, done) << outcome.err;
}

// ---- query -----------------------------------------------------------------------------------------

class BadQuery : public BadInput {
 protected:
  void SetUp() override {
    make_database("a.talus");
    write_bytes(folder / "kept.ply", "an older answer");
  }
  void expect_query_refused(std::vector<std::string> more, const std::vector<int>& exit_codes,
                            const std::vector<std::string>& named) const {
    std::vector<std::string> arguments{"query", "a.talus", "-o", "kept.ply"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(arguments, exit_codes, named);
  }
};

TEST_F(BadQuery, TolerancesThatAreNone) {
  for (const char* tolerance : {"-1", "nan", "NaN", "-0.001", "-inf", "much", "", "1m", "1,5"}) {
    SCOPED_TRACE(tolerance);
    expect_query_refused({std::string("--tolerance=") + tolerance}, {usage}, {"tolerance"});
  }
  expect_query_refused({}, {usage}, {"tolerance"});
}

TEST_F(BadQuery, RectanglesThatAreNone) {
  for (const char* bbox : {"20,-20,10,-10", "10,-10,20,-20", "10,-20,10,-10", "nan,-20,20,-10", "1000,-20,1010,-10",
                           "10,10,20,20", "1,2,3", "1,2,3,4,5", "a,b,c,d", "", "10;-20;20;-10", "inf,-20,inf,-10"}) {
    SCOPED_TRACE(bbox);
    expect_query_refused({"--tolerance=1", std::string("--bbox=") + bbox}, {usage}, {});
  }
  expect_query_refused({"--tolerance=1", "--bbox=1000,-20,1010,-10"}, {usage}, {"1000"});
}

TEST_F(BadQuery, OutputsThatCannotBeWritten) {
  expect_refused({"query", "a.talus", "--tolerance=1", "-o", "nowhere/out.ply"}, {failed}, {"nowhere"});
  expect_refused({"query", "a.talus", "--tolerance=1", "-o", "out.xyz"}, {usage}, {"out.xyz"});
  expect_refused({"query", "a.talus", "--tolerance=1", "-o", "out"}, {usage}, {"out"});
  std::filesystem::create_directory(folder / "folder.ply");
  expect_refused({"query", "a.talus", "--tolerance=1", "-o", "folder.ply"}, {failed, usage}, {"folder.ply"});
}

TEST_F(BadQuery, AnOutputThatIsTheDatabase) {
  std::filesystem::rename(folder / "a.talus", folder / "a.ply");
  std::filesystem::create_hard_link(folder / "a.ply", folder / "b.obj");
  for (const std::string output : {"a.ply", "./a.ply", "b.obj"}) {
    expect_refused({"query", "a.ply", "--tolerance=1", "-o", output}, {usage}, {output, "input", "would be lost"});
  }
}

TEST_F(BadQuery, NamesThatAreEmpty) {
  make_raster("a.tif");
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"ingest", "", "out.talus"},
                                                                     {"ingest", "a.tif", ""},
                                                                     {"info", ""},
                                                                     {"query", "", "--tolerance=1"},
                                                                     {"query", "a.talus", "--tolerance=1", "-o", ""},
                                                                     {"verify", ""},
                                                                     {"verify", "a.talus", "--against", ""}}) {
    expect_refused(arguments, {usage}, {"file name"});
  }
}

TEST_F(BadQuery, DatabasesThatAreNone) {
  write_bytes(folder / "notes.talus", "the mountain is high\n");
  write_bytes(folder / "empty.talus", "");
  write_bytes(folder / "zeros.talus", std::string(65536, '\0'));
  make_raster("raster.tif");
  for (const std::string command : {"query", "info", "verify"}) {
    const auto with = [&](const std::string& database) {
      return command == "query" ? std::vector<std::string>{command, database, "--tolerance=1", "-o", "kept.ply"}
                                : std::vector<std::string>{command, database};
    };
    expect_refused(with("missing.talus"), {failed}, {"missing.talus"});
    for (const char* database : {"notes.talus", "empty.talus", "zeros.talus", "raster.tif"}) {
      expect_refused(with(database), {damaged}, {database});
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "missing.talus"));
  }
}

TEST_F(BadQuery, WordsThatMeanNothing) {
  for (const auto& arguments : std::vector<std::vector<std::string>>{{"dance"},
                                                                     {"query"},
                                                                     {"ingest"},
                                                                     {"ingest", "a.tif"},
                                                                     {"info"},
                                                                     {"info", "a.talus", "--loudly"},
                                                                     {"verify", "a.talus", "--tolerance=1"}}) {
    const auto before = contents();
    const Outcome outcome = talus(arguments);
    EXPECT_EQ(outcome.exit_code, usage) << ::testing::PrintToString(arguments) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err, "");
    EXPECT_EQ(contents(), before);
  }
}

TEST_F(BadQuery, AgainstARasterThatIsAnother) {
  raster.at(40, 30) += 1;
  make_raster("other.tif");
  const Outcome other = talus({"verify", "a.talus", "--against", "other.tif"});
  EXPECT_EQ(other.exit_code, differs) << other.out << other.err;
  EXPECT_THAT(other.out + other.err, ::testing::HasSubstr("40"));
  raster = crop(raster, 0, 0, 50, 50);
  make_raster("smaller.tif");
  const Outcome smaller = talus({"verify", "a.talus", "--against", "smaller.tif"});
  EXPECT_TRUE(smaller.exit_code == usage || smaller.exit_code == damaged) << smaller.exit_code;
  EXPECT_THAT(smaller.out + smaller.err, ::testing::HasSubstr("smaller.tif"));
  expect_refused({"verify", "a.talus", "--against", "missing.tif"}, {failed}, {"missing.tif"});
  raster = fit(fractal(90, 70, 4, 600), SampleType::int16);
  RasterOptions another_crs;
  another_crs.crs = "EPSG:32633";
  make_raster("another_crs.tif", another_crs);
  expect_refused({"verify", "a.talus", "--against", "another_crs.tif"}, {usage}, {"another_crs.tif", "another CRS"});
}

}  // namespace
}  // namespace talus::support
