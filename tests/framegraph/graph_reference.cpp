#include "tests/framegraph/graph_reference.hpp"

#include "framegraph/model/expression.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace dermis::testing {
namespace {

bool is_slot(const ResourceDeclaration& resource) {
  return resource.origin == Origin::imported || resource.exported;
}

// Indexed by mip, then by layer.
using Contents = std::vector<std::optional<Pixels>>;

Contents undefined(const ResourceDeclaration& resource) {
  return Contents(size_t{resource.mips} * resource.layers);
}

// Returns the indices of the subresources in the range.
std::vector<size_t> numbers(const ResourceDeclaration& resource, const ImageRange& image_range) {
  std::vector<size_t> result;
  for (uint32_t m = image_range.first_mip;
       m < (image_range.mips == 0 ? resource.mips : image_range.first_mip + image_range.mips); ++m)
    for (uint32_t l = image_range.first_layer;
         l < (image_range.layers == 0 ? resource.layers
                                      : uint32_t{image_range.first_layer} + image_range.layers);
         ++l)
      result.push_back(m * resource.layers + l);
  return result;
}

} // namespace

Interpretation graph_reference(const Graph& graph, const PassTypeRegistry& pass_types,
                               uint32_t frames, uint64_t contents, uint64_t cuts) {
  std::vector<SettingValue> settings;
  for (const SettingDeclaration& setting : graph.settings)
    settings.push_back(setting.default_value);
  // contents_of[r][f] is resource r at the end of frame f, or its current state in the frame that
  // runs.
  std::vector<std::vector<Contents>> contents_of(graph.resources.size());
  Interpretation out(frames);
  for (uint32_t frame = 0; frame < frames; ++frame) {
    uint32_t slot = 0;
    for (size_t r = 0; r < graph.resources.size(); ++r) {
      const bool import = graph.resources[r].origin == Origin::imported;
      contents_of[r].push_back(undefined(graph.resources[r]));
      if (import) contents_of[r].back().assign(1, host_pixels(contents, frame, slot));
      slot += is_slot(graph.resources[r]) ? 1 : 0;
    }
    // Returns whether enough frames were written since the last cut.
    const auto in_history = [&](const PortBinding& binding) {
      const HistoryDeclaration& history = graph.resources[binding.resource.value].history;
      const bool cuts_count = history.on_cut == HistoryDeclaration::OnCut::invalidate;
      for (uint32_t back = 0; back < binding.frames_back; ++back)
        if (back == frame || (cuts_count && (cuts >> (frame - back) & 1u) != 0)) return false;
      return true;
    };
    const auto read = [&](const PortBinding& binding, std::vector<PlaceholderInput>& inputs) {
      const ResourceDeclaration& resource = graph.resources[binding.resource.value];
      if (!in_history(binding)) { // Histories start from zero.
        inputs.insert(inputs.end(), numbers(resource, binding.range).size(),
                      {binding.port, Pixels{}});
        return;
      }
      const Contents& found = contents_of[binding.resource.value][frame - binding.frames_back];
      if (binding.range.whole()) // The subresources of the resource that is read instead.
        for (const auto& pixels : found) {
          EXPECT_TRUE(pixels.has_value()) << resource.name;
          inputs.push_back({binding.port, pixels.value_or(Pixels{})});
        }
      else
        for (const size_t number : numbers(resource, binding.range)) {
          EXPECT_TRUE(found[number].has_value()) << resource.name;
          inputs.push_back({binding.port, found[number].value_or(Pixels{})});
        }
    };
    for (uint32_t p = 0; p < graph.passes.size(); ++p) {
      const PassDeclaration& pass = graph.passes[p];
      if (pass.when.valid() && !evaluate(graph, pass.when, settings)) {
        // Readers of a disabled pass see this resource instead.
        for (const PassThrough& one : pass.otherwise)
          contents_of[one.output.value][frame] = contents_of[one.instead.value][frame];
        continue;
      }
      std::vector<PlaceholderInput> inputs;
      const auto reads = graph.reads(pass), writes = graph.writes(pass);
      for (size_t i = 0; i < reads.size(); ++i) {
        const PortBinding& binding = reads[i];
        if (binding.when == ReadWhen::history_valid && !in_history(binding)) continue;
        if (binding.when == ReadWhen::history_invalid && in_history(reads[i - 1])) continue;
        read(binding, inputs);
      }
      for (const PortBinding& binding : writes)
        if (usage_info(pass_types[pass.type].ports[binding.port].usage).reads)
          read(binding, inputs);
      std::stable_sort(
          inputs.begin(), inputs.end(),
          [](const PlaceholderInput& a, const PlaceholderInput& b) { return a.port < b.port; });
      for (const PortBinding& binding : writes) {
        uint32_t image_range = 0;
        for (const size_t number : numbers(graph.resources[binding.resource.value], binding.range))
          contents_of[binding.resource.value][frame][number] =
              placeholder(p, binding.port, image_range++, inputs);
      }
    }
    for (size_t r = 0; r < graph.resources.size(); ++r)
      if (is_slot(graph.resources[r]))
        out[frame].push_back(graph.resources[r].exported ? contents_of[r][frame].front()
                                                         : std::nullopt);
  }
  return out;
}

bool agrees(const Interpretation& found, const Interpretation& reference) {
  for (size_t frame = 0; frame < reference.size(); ++frame)
    for (size_t slot = 0; slot < reference[frame].size(); ++slot)
      if (reference[frame][slot] && found[frame][slot] != reference[frame][slot]) return false;
  return true;
}

} // namespace dermis::testing
