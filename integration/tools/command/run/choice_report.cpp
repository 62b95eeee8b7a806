#include "integration/tools/command/run/choice_report.hpp"

#include "integration/tools/command/present.hpp"
#include "integration/tools/command/run/frontier_report.hpp"
#include "integration/tools/command/run/history_report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {

void ChoiceReport::add(uint32_t frame, const demo::FrameChoice& choice,
                       std::vector<demo::FrameHistory> histories, TileCosts costs,
                       std::vector<demo::FrameOutcome> frontier) {
  frames_.push_back({frame, choice, std::move(histories), std::move(costs), std::move(frontier)});
}

std::string describe_choice(const demo::FrameChoice& choice) {
  const uint32_t listed = choice.scattering_tiles + choice.copied_tiles + choice.uniform_tiles;
  std::string text = fmt::format("{}: {} tiles", choice.configuration, choice.scattering_tiles);
  if (choice.mean_d_px > 0) text += fmt::format(" (d {:.1f} px)", choice.mean_d_px);
  for (size_t k = 0; k < choice.sampled_tiles.size(); ++k)
    if (choice.sampled_tiles[k] > 0)
      text += fmt::format(", {} of them sampled x{}", choice.sampled_tiles[k], 1u << k);
  if (choice.uniform_tiles > 0) text += fmt::format(", uniform {}", choice.uniform_tiles);
  text += fmt::format(", copied {}, skipped {}: {:.2f} ms predicted", choice.copied_tiles,
                      choice.view_tiles - std::min(choice.view_tiles, listed), choice.predicted_ms);
  text +=
      choice.measured_ms < 0 ? ", not timed" : fmt::format(", {:.2f} measured", choice.measured_ms);
  if (choice.budget_ms > 0) text += fmt::format(", budget {:.2f}", choice.budget_ms);
  if (choice.budget_ms > 0)
    text += fmt::format("; expected RMSE of the scattered light {:.1e} ({})", choice.predicted_rmse,
                        choice.why);
  if (choice.probed_tiles > 0)
    text += choice.probed_tiles > 1
                ? fmt::format(", {:.1e} probed ({:.1e} to {:.1e})", choice.probed_rmse,
                              choice.probed_rmse_low, choice.probed_rmse_high)
                : fmt::format(", {:.1e} probed in one tile", choice.probed_rmse);
  if (choice.transmitted_rms > 0)
    text += fmt::format(", {:.2f} of light through thin parts", choice.transmitted_rms);
  if (!choice.next_better.empty())
    text += fmt::format("; next better {} would need {:.2f} ms more", choice.next_better,
                        choice.next_better_missing_ms);
  const bool in_part =
      choice.sample_units > 0 && choice.sampled_tiles == decltype(choice.sampled_tiles){};
  if (in_part)
    text += fmt::format("; {} of {} tiles that scatter fit the budget", choice.sample_units,
                        choice.sample_demand);
  else if (choice.sample_units < choice.sample_demand)
    text += fmt::format("; {} of {} requested sample units (8 samples per pixel of a tile) fit the "
                        "budget",
                        choice.sample_units, choice.sample_demand);
  if (!choice.miss.empty()) text += fmt::format("; over the budget: {}", choice.miss);
  return text;
}

std::string ChoiceReport::text() const {
  if (frames_.empty()) return "";
  const demo::FrameChoice& newest = frames_.back().choice;
  std::string text;
  if (newest.configurations > 1 && frames_.size() > 1) {
    std::vector<std::string> seen;
    for (const Frame& frame : frames_)
      if (std::find(seen.begin(), seen.end(), frame.choice.configuration) == seen.end())
        seen.push_back(frame.choice.configuration);
    for (const std::string& configuration : seen) {
      const auto count = std::count_if(frames_.begin(), frames_.end(), [&](const Frame& frame) {
        return frame.choice.configuration == configuration;
      });
      text += fmt::format("{} of {} frames ran {}\n", count, frames_.size(), configuration);
    }
  }
  return text + fmt::format("frame {}: {}\n", frames_.back().frame, describe_choice(newest)) +
         describe_tile_costs(frames_.back().costs) + describe_histories(frames_.back().histories) +
         describe_frontier(frames_.back().frontier);
}

void ChoiceReport::write(JsonWriter& writer) const {
  writer.open_array();
  for (const Frame& frame : frames_) {
    const demo::FrameChoice& choice = frame.choice;
    writer.open_object(true)
        .member("frame", frame.frame)
        .member("configuration", std::string_view(choice.configuration));
    writer.member("technique", std::string_view(choice.technique))
        .member("why", std::string_view(choice.why));
    writer.member("budget_ms", choice.budget_ms).member("predicted_ms", choice.predicted_ms);
    writer.member("predicted_margin_ms", choice.predicted_margin_ms).key("measured_ms");
    if (choice.measured_ms < 0)
      writer.null();
    else
      writer.value(choice.measured_ms);
    writer.member("calibrated_ms", choice.calibrated_ms);
    writer.member("predicted_rmse", choice.predicted_rmse).member("mean_d_px", choice.mean_d_px);
    if (choice.mean_relief >= 0) writer.member("mean_relief", choice.mean_relief);
    writer.member("view_tiles", choice.view_tiles)
        .member("scattering_tiles", choice.scattering_tiles);
    writer.member("copied_tiles", choice.copied_tiles).member("switches", choice.switches);
    writer.member("uniform_tiles", choice.uniform_tiles).member("dispatches", choice.dispatches);
    writer.member("groups", choice.groups).member("sample_units", choice.sample_units);
    writer.member("sample_demand", choice.sample_demand).key("sampled_tiles").open_array();
    for (const uint32_t tiles : choice.sampled_tiles)
      writer.value(tiles);
    writer.close();
    if (choice.probed_tiles > 0) writer.member("probed_tiles", choice.probed_tiles);
    if (choice.probed_tiles > 0) writer.member("probed_rmse", choice.probed_rmse);
    if (choice.transmitted_rms > 0) writer.member("transmitted_rms", choice.transmitted_rms);
    if (choice.probed_tiles > 1)
      writer.member("probed_rmse_low", choice.probed_rmse_low)
          .member("probed_rmse_high", choice.probed_rmse_high);
    if (!frame.costs.classes.empty()) {
      writer.key("tile_classes").open_array();
      for (const TileClass& one : frame.costs.classes)
        writer.open_object(true)
            .member("samples", one.samples)
            .member("tiles", one.tiles)
            .member("reads_per_pixel", one.reads)
            .close();
      writer.close().member("reads_per_sample", frame.costs.reads_per_sample);
      writer.member("reads_per_view", frame.costs.reads_per_view)
          .member("reads", frame.costs.total());
    }
    write_histories(writer.key("histories"), frame.histories);
    if (!frame.frontier.empty()) write_frontier(writer.key("frontier"), frame.frontier);
    writer.member("miss", std::string_view(choice.miss));
    writer.member("next_better", std::string_view(choice.next_better));
    writer.member("next_better_missing_ms", choice.next_better_missing_ms).close();
  }
  writer.close();
}

} // namespace dermis::tools
