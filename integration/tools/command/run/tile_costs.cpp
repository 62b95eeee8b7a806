#include "integration/tools/command/run/tile_costs.hpp"

#include "framegraph/compile/written_size.hpp"
#include "integration/tools/command/present.hpp"
#include "integration/tools/references/image_reads.hpp"
#include "passes/common/dispatch.hpp"
#include "passes/common/environment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace dermis::tools {
namespace {

constexpr double tile_pixels = double(subsurface::tile_side * subsurface::tile_side);

// Splits "technique=hybrid, variant=smooth" into settings.
void add_configuration(const Graph& graph, std::string_view configuration,
                       std::vector<NamedValue>& settings) {
  while (!configuration.empty()) {
    const size_t end = std::min(configuration.find(", "), configuration.size()),
                 equals = configuration.find('=');
    if (equals < end) {
      const std::string name(configuration.substr(0, equals));
      if (std::any_of(graph.settings.begin(), graph.settings.end(),
                      [&](const SettingDeclaration& one) { return one.name == name; }))
        settings.emplace_back(name,
                              std::string(configuration.substr(equals + 1, end - equals - 1)));
    }
    configuration.remove_prefix(std::min(end + 2, configuration.size()));
  }
}

// Returns the resource at a port of the pass.
std::optional<uint32_t> resource_at(const Plan& plan, const PlanPass& pass, const PassType& type,
                                    std::string_view port) {
  const int index = find_port(type, port, PortSide::read);
  for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a)
    if (plan.accesses[a].port == static_cast<uint32_t>(index)) return plan.accesses[a].resource;
  return std::nullopt;
}

// The tiles of an indirect pass.
enum class Tiles { all, with_samples, without_samples };

// Lists of tiles, by resource. Tiles next to those without samples, which are in both lists, are
// not counted as such.
std::map<uint32_t, Tiles> lists_of(const LoadedGraph& loaded, const Plan& plan) {
  std::map<uint32_t, Tiles> lists;
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = loaded.pass_types[pass.type];
    const auto tiles = resource_at(plan, pass, type, "tiles");
    if (tiles && resource_at(plan, pass, type, "samples_per_tile"))
      lists[*tiles] = Tiles::with_samples;
    for (const char* written : {"vertical_tiles", "horizontal_tiles"})
      for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a)
        if (type.ports[plan.accesses[a].port].name == written)
          lists[plan.accesses[a].resource] = Tiles::without_samples;
  }
  return lists;
}

} // namespace

double TileCosts::total() const {
  return std::accumulate(classes.begin(), classes.end(), reads_per_view,
                         [](double sum, const TileClass& one) {
                           return sum + tile_pixels * double(one.tiles) * one.reads;
                         });
}

TileCosts tile_costs(const LoadedGraph& loaded, const Size& size, PixelGrid grid,
                     std::span<const NamedValue> settings, const demo::FrameChoice& choice) {
  std::vector<NamedValue> values(settings.begin(), settings.end());
  add_configuration(loaded.graph, choice.configuration, values);
  Diagnostics scratch; // not reported: the frame ran, so the graph compiles
  CompileChoices choices = read_choices(loaded.graph, values);
  choices.pixel_grid = grid;
  const auto compiled = compile_generic(loaded, size, choices, scratch);
  TileCosts out;
  if (!compiled) return out;
  const Plan& plan = compiled->plan;
  const std::vector<float> tables = subsurface::make_shared_sap_tables({true, true});
  const double d = choice.mean_d_px;
  // Reads per pixel of every scattering tile, of a tile without samples, and of a tile with samples
  // in addition to those of each sample.
  double everywhere = 0, without_samples = 0, with_samples = 0;
  double first_step = 0; // samples per pixel
  const std::map<uint32_t, Tiles> lists = lists_of(loaded, plan);
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = loaded.pass_types[pass.type];
    std::vector<SettingValue> own;
    double finer = 1; // level 0 texels per texel of the pass
    for (size_t i = 0; i < type.settings.size(); ++i) {
      own.push_back(plan.settings[pass.first_setting + i].value);
      if (type.settings[i].name == "level")
        finer = double(pixels_per_texel(grid, static_cast<uint32_t>(own.back().integer)));
    }
    subsurface::ReadsInput input{
        own, std::vector<bool>(type.ports.size(), false), {d, d, d}, tables};
    for (uint32_t a = 0; a < pass.access_count; ++a)
      input.bound[plan.accesses[pass.first_access + a].port] = true;
    const auto reads = subsurface::image_reads(type, input);
    if (!reads) continue;
    const auto list = lists.find(resource_at(plan, pass, type, "tiles").value_or(~0u));
    const Tiles tiles = list == lists.end() ? Tiles::all : list->second;
    if (tiles == Tiles::with_samples && reads->samples > 0) { // at twice the first step's samples
      input.sampled_fraction = 0;
      const double without = subsurface::image_reads(type, input)->per_invocation;
      out.reads_per_sample = (reads->per_invocation - without) / reads->samples;
      first_step = reads->samples / 2;
      with_samples += without;
    } else if (type.dispatch.domain == DispatchRule::Domain::indirect) {
      double& sum = tiles == Tiles::all            ? everywhere
                    : tiles == Tiles::with_samples ? with_samples
                                                   : without_samples;
      sum += reads->per_invocation / finer;
    } else if (type.dispatch.domain == DispatchRule::Domain::written_image) {
      const TexelSize written = first_written_size(plan, pass, type);
      out.reads_per_view += reads->per_invocation * double(written.width) * written.height;
    } else {
      out.reads_per_view += reads->per_invocation * tile_pixels * double(choice.view_tiles);
    }
  }
  if (first_step <= 0) return out;
  const uint64_t sampled =
      std::accumulate(choice.sampled_tiles.begin(), choice.sampled_tiles.end(), uint64_t{0});
  out.classes.push_back(
      {0, choice.scattering_tiles - std::min<uint64_t>(choice.scattering_tiles, sampled),
       everywhere + without_samples});
  for (size_t k = 0; k < choice.sampled_tiles.size(); ++k) {
    const auto samples = static_cast<uint32_t>(first_step) << k;
    out.classes.push_back({samples, choice.sampled_tiles[k],
                           everywhere + with_samples + double(samples) * out.reads_per_sample});
  }
  return out;
}

std::string describe_tile_costs(const TileCosts& costs) {
  if (costs.classes.empty()) return "";
  Table table;
  table.columns = {{"samples per pixel, m", true},
                   {"tiles, w", true},
                   {"S(m), reads per pixel", true},
                   {"w S(m), M reads", true}};
  for (const TileClass& one : costs.classes)
    table.rows.push_back(
        {fmt::format("{}", one.samples), fmt::format("{}", one.tiles),
         fmt::format("{:.1f}", one.reads),
         fmt::format("{:.3f}", tile_pixels * double(one.tiles) * one.reads * 1e-6)});
  return format_table(table) +
         fmt::format(
             "M(d) = {:.1f} reads per sample, O(n) = {:.3f} M reads, T'(n) = {:.3f} M reads\n",
             costs.reads_per_sample, costs.reads_per_view * 1e-6, costs.total() * 1e-6);
}

} // namespace dermis::tools
