#include "tests/framegraph/random_graph.hpp"

#include "framegraph/model/splitmix.hpp"

#include <fmt/format.h>

#include <map>

namespace dermis::testing {
namespace {

struct Random : SplitMix64 {
  uint32_t below(size_t limit) { return static_cast<uint32_t>(SplitMix64::below(limit)); }
  bool chance(uint32_t percent) { return below(100) < percent; }
};

struct Draft {
  GraphBuilder b;
  Random random;
  std::vector<std::string> readable; // Images with contents at this point of the file.
  std::vector<std::string> buffers;  // Buffers with contents at this point of the file.
  std::vector<std::string>
      // Histories readable at @-1 .. @-frames from the start; all of them are written by the end.
      histories;
  Sizes sizes = Sizes::mixed;
  uint32_t count = 0;
  Random division{0}; // A separate generator for histories.
  // The number of mips of each history whose mips are separate subresources.
  std::map<std::string, uint32_t> divided = {};

  std::string fresh(const char* stem) { return fmt::format("{}{}", stem, count++); }
  const std::string& any(const std::vector<std::string>& from) {
    return from[random.below(from.size())];
  }

  // Names a whole history, one mip, or one mip of its first layer.
  std::string some_of(const std::string& history) {
    const auto mips = divided.find(history);
    if (mips == divided.end() || division.chance(40)) return {};
    const uint32_t mip = division.below(mips->second);
    return fmt::format("#{}{}", mip, division.chance(30) ? "[0]" : "");
  }

  // Adds one pass per mip, which also reads the previous mip.
  void keep_mips(const std::string& history, uint32_t mips) {
    const auto frames = b.graph.resources[b.resource(history).value].history.frames;
    for (uint32_t m = 0; m < mips; ++m) {
      Bindings inputs{{"a", any(readable)}};
      if (m > 0 && division.chance(50)) inputs = {{"a", fmt::format("{}#{}", history, m - 1)}};
      const bool blend = division.chance(40);
      if (blend) inputs.emplace_back("own", fmt::format("{}#{}@-{}", history, m, frames));
      b.pass(fresh("keep"), blend ? "test.blend" : "test.shade", inputs,
             {{"out", fmt::format("{}#{}", history, m)}});
    }
  }

  Bindings reads(uint32_t maximum) {
    constexpr const char* ports[] = {"a", "b", "c"};
    Bindings result;
    for (uint32_t i = 0; i < maximum; ++i) {
      if (!histories.empty() && random.chance(25)) {
        const auto& history = any(histories);
        const auto frames = b.graph.resources[b.resource(history).value].history.frames;
        auto source = fmt::format("{}{}@-{}", history, some_of(history), 1 + random.below(frames));
        if (random.chance(40)) source += random.chance(50) ? "?" : "?" + any(readable);
        result.emplace_back(ports[i], source);
      } else if (random.chance(80)) {
        result.emplace_back(ports[i], any(readable));
      }
    }
    return result;
  }

  // Returns whether a source of a reading port may be (part of) `image` in this frame.
  static bool may_meet(const std::string& source, const std::string& image) {
    // The otherwise value, or the whole source: npos + 1 is 0.
    const std::string now = source.substr(source.find('?') + 1);
    const auto name = [](const std::string& text) {
      return text.substr(0, text.find_first_of("#[@"));
    };
    return now.find('@') == std::string::npos && name(now) == name(image);
  }

  std::string new_image() {
    const auto name = fresh("image");
    auto& declared = random.chance(15) ? b.exported(name) : b.image(name);
    // Sizes are one, four or nine pages of memory, so that several small images can reuse a large
    // one.
    const int64_t multiple = sizes == Sizes::mixed ? 1 + random.below(3) : 1;
    const int64_t divisor = 1 + random.below(3);
    declared.size.x = declared.size.y = {multiple, divisor};
    return name;
  }

  // Adds the pass that writes a history. Some of these passes read its oldest frame texel by texel.
  void keep(const std::string& history) {
    const auto frames = b.graph.resources[b.resource(history).value].history.frames;
    if (random.chance(40))
      b.pass(fresh("blend"), "test.blend",
             {{"a", any(readable)}, {"own", fmt::format("{}@-{}", history, frames)}},
             {{"out", history}});
    else
      b.pass(fresh("keep"), "test.shade", reads(3), {{"out", history}});
  }

  // Adds an image of several mips and layers that are written in one or several passes. Later
  // passes can read parts of it and write parts in place.
  void parts() {
    const auto name = fresh("parts");
    auto& declared = b.image(name);
    const int64_t multiple = sizes == Sizes::mixed ? 1 + random.below(2) : 1;
    const int64_t divisor = sizes == Sizes::mixed ? 1 : 4;
    declared.size.x = declared.size.y = {multiple, divisor};
    declared.mips = 1 + random.below(3);
    declared.layers = 1 + random.below(2);
    const uint32_t mips = declared.mips, layers = declared.layers;
    if (random.chance(20)) b.pass(fresh("fill"), "test.fill", {}, {{"target", name}});
    const bool filled = b.graph.passes.size() > 0 &&
                        b.graph.writes(b.graph.passes.back())[0].resource == b.resource(name);
    for (uint32_t m = 0; m < mips; ++m) {
      const bool by_layer = random.chance(50);
      for (uint32_t l = 0; l < (by_layer ? layers : 1); ++l) {
        const auto part = fmt::format("{}#{}{}", name, m, by_layer ? fmt::format("[{}]", l) : "");
        auto inputs = reads(2);
        if (m > 0)
          inputs.emplace_back("c",
                              fmt::format("{}#{}{}", name, m - 1, random.chance(50) ? "" : "[0]"));
        if (filled) {
          b.pass(fresh("change"), "test.update",
                 inputs.empty() ? Bindings{} : Bindings{{"a", inputs.back().second}},
                 {{"image", part}});
        } else {
          b.pass(fresh("mip"), "test.shade", inputs, {{"out", part}});
        }
      }
    }
    readable.push_back(name);
    readable.push_back(fmt::format("{}#{}", name, random.below(mips)));
    const uint32_t first_mip =
        // One statement per random number: compilers evaluate arguments in different orders.
        random.below(mips);
    readable.push_back(fmt::format("{}#{}..[{}]", name, first_mip, random.below(layers)));
  }

  void one_pass() {
    const auto name = fresh("pass");
    const uint32_t kind = random.below(10);
    if (random.chance(6)) return parts();
    if (kind == 0) {
      buffers.push_back(fresh("buffer"));
      b.buffer(buffers.back());
      b.pass(name, "test.fill", {}, {{"target", buffers.back()}});
    } else if (kind == 1 && !buffers.empty()) {
      b.pass(name, "test.count", {}, {{"tiles", any(buffers)}});
    } else if (kind == 2 && !buffers.empty()) {
      const auto out = new_image();
      const auto& tiles = any(buffers);
      b.pass(name, "test.tiles",
             {{"tiles", tiles},
              {"arguments", random.chance(70) ? tiles : any(buffers)},
              {"a", any(readable)}},
             {{"out", out}});
      readable.push_back(out);
    } else if (kind == 3) {
      // Generated first: compilers evaluate arguments in different orders.
      const std::string image = any(readable);
      Bindings inputs = reads(1);
      for (auto& [port, source] : inputs)
        if (may_meet(source, image)) port = "own";
      b.pass(name, "test.update", inputs, {{"image", image}});
    } else if (kind == 4) {
      buffers.push_back(fresh("buffer"));
      b.buffer(buffers.back());
      b.pass(name, "test.list", reads(1), {{"tiles", buffers.back()}});
    } else {
      const auto first = new_image();
      Bindings writes{{"out", first}};
      const auto inputs = reads(3);
      readable.push_back(first);
      if (random.chance(30)) {
        writes.emplace_back("out2", new_image());
        readable.push_back(writes.back().second);
      }
      b.pass(name, "test.shade", inputs, writes);
    }
  }
};

} // namespace

void draw_orders(GraphBuilder& builder, uint64_t seed) {
  Random random{seed};
  std::vector<PassDeclaration>& passes = builder.graph.passes;
  for (uint32_t later = 1; later < passes.size(); ++later)
    if (random.chance(30))
      passes[later].after.push_back({PassId{random.below(later)}, "random", {}});
}

GraphBuilder random_graph(uint64_t seed, Sizes sizes) {
  Draft draft{{}, {seed}, {}, {}, {}, sizes};
  draft.division = {~seed};
  const uint32_t imports = 1 + draft.random.below(3);
  for (uint32_t i = 0; i < imports; ++i) {
    draft.readable.push_back(draft.fresh("import"));
    draft.b.import(draft.readable.back()).exported = draft.random.chance(40);
  }
  const uint32_t histories = draft.random.below(3);
  for (uint32_t i = 0; i < histories; ++i) {
    draft.histories.push_back(draft.fresh("history"));
    auto& declared = draft.b.history(draft.histories.back(), 1 + draft.random.below(3));
    if (draft.random.chance(30)) declared.history.on_cut = HistoryDeclaration::OnCut::keep;
    if (!draft.division.chance(30)) continue;
    declared.mips = draft.divided[draft.histories.back()] = 2 + draft.division.below(2);
    declared.layers = 1 + draft.division.below(2);
  }
  const uint32_t passes = 2 + draft.random.below(20);
  for (uint32_t i = 0; i < passes; ++i)
    draft.one_pass();
  for (const auto& history : draft.histories)
    if (const auto mips = draft.divided.find(history); mips != draft.divided.end())
      draft.keep_mips(history, mips->second);
    else
      draft.keep(history);
  draft.b.exported("result");
  draft.b.pass("finish", "test.shade", draft.reads(3), {{"out", "result"}});
  for (PassDeclaration& pass : draft.b.graph.passes) // Has an effect only with two queues.
    pass.async = draft.random.chance(35);
  return std::move(draft.b);
}

} // namespace dermis::testing
