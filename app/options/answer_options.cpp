#include "app/options/answer_options.hpp"

namespace talus::app {
namespace {

const Names<Border>& borders() {
  static const Names<Border> names{{"constrain", Border::constrain}, {"cover", Border::cover}, {"clip", Border::clip}};
  return names;
}

}  // namespace

void add_stream_options(Command& command, StreamOptions& options) {
  command.number(
      "--bands", options.stripes, "N",
      "Cut each level of an .rqt file into N pieces, so that N threads can read it. 0, the default: one piece "
      "for each 65,536 vertices",
      0, 4096);
}

void add_height_options(Command& command, Heights& heights) {
  command.choice(
      "--heights", heights.kind,
      Names<HeightKind>{{"exact", HeightKind::exact},
                        {"bounded", HeightKind::bounded},
                        {"fitted", HeightKind::fitted},
                        {"dense", HeightKind::dense}},
      "Heights of the vertices. The bound holds for each.\n"
      "exact (default): as in the source\n"
      "bounded: rounded to multiples of a quantum, for smaller .rqt files\n"
      "fitted: moved within the tolerance, for the fewest vertices\n"
      "dense: nearly all samples, rounded as far as the tolerance allows. The smallest .rqt file where a mesh "
      "needs most samples");
  command.option("--quantum", heights.quantum, kMetresAboveZero, "M",
                 "With --heights bounded: the quantum in metres. Increments with the same quantum then fit the answer. "
                 "Without it Talus chooses one, and no increment fits. With --heights fitted: a smaller quantum mostly "
                 "needs fewer vertices and more bytes; the default is half the tolerance");
}

void add_border_option(Command& command, Border& border) {
  command.choice("--border", border, borders(),
                 "How the mesh ends at the rectangle.\n"
                 "constrain (default): its sides are edges\n"
                 "cover: whole triangles reach beyond\n"
                 "clip: these, cut at the rectangle");
}

const char* name_of(Border border) { return name_in(borders(), border); }

}  // namespace talus::app
