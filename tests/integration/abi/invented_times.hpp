#pragma once
// A calibration for configs/graphs/skin.json that makes the choice equal on every machine.

namespace dermis::abi_test {

// Times of no real device: 1 ms per dispatch of the pyramid, less for all other passes.
inline constexpr const char* invented_times =
    R"({ "dermis_calibration": 2, "device": "invented", "costs": [
  { "work": "subsurface.sap_up level=1 variant=smooth storage=half", "base_us": 1000, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_up level=1 variant=base storage=half", "base_us": 500, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_up level=2 variant=smooth storage=half", "base_us": 1000, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_up level=2 variant=base storage=half", "base_us": 500, "group_us": 0, "spread": 0 },
  { "work": "subsurface.separable axis=horizontal taps=25 kernel=fitted", "base_us": 1000, "group_us": 0, "spread": 0 },
  { "work": "subsurface.separable axis=horizontal taps=11 kernel=fitted", "base_us": 400, "group_us": 0, "spread": 0 },
  { "work": "subsurface.classify", "base_us": 100, "group_us": 0, "spread": 0 },
  { "work": "subsurface.tile_list", "base_us": 100, "group_us": 0, "spread": 0 },
  { "work": "subsurface.setup texturing=post", "base_us": 100, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_setup texturing=post storage=half", "base_us": 100, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_down level=1 storage=half", "base_us": 100, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_down level=2 storage=half", "base_us": 100, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_gather variant=smooth storage=half", "base_us": 100, "group_us": 0, "spread": 0 },
  { "work": "subsurface.probe texturing=post tiles=8 interval=4", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.sap_gather_probed variant=smooth storage=half tiles=8 interval=4", "base_us": 0, "group_us": 0, "spread": 0 },
  { "work": "subsurface.combine texturing=post result=color", "base_us": 100, "group_us": 0, "spread": 0 } ] })";

} // namespace dermis::abi_test
