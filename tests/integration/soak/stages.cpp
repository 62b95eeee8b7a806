#include "tests/integration/soak/stage.hpp"

namespace dermis::abi_test {

namespace {

constexpr double largest_ratio = 4.0; // papers/subsurface_residual.comp

} // namespace

// `afis_guided` weights the control of earlier frames against samples, and `accumulate` scales
// earlier light by the factor by which its tile became brighter, so neither is a mean of the
// surface's light. Their wide bounds only detect diverging light.
std::vector<StageDesc> soak_stages() {
  const std::vector<std::string> samples = {"2", "8", "16"};
  return {
      {"skin",
       "skin",
       {},
       {{"technique",
         {"\"sap\"", "\"hybrid\"", "\"afis\"", "\"separable\"", "\"partial\"", "\"off\""}},
        {"variant", {"\"base\"", "\"smooth\"", "\"half\""}},
        {"history", {"\"velocity\"", "\"camera\"", "\"off\""}},
        {"taps", {"\"11\"", "\"17\"", "\"25\""}},
        {"below", {"0", "0.93", "2"}},
        {"sample_weight", {"0", "0.05", "16"}},
        {"lod_bias", {"-8", "-1.5", "4"}}}},
      {"residual",
       "sap_residual",
       {},
       {{"variant", {"\"base\"", "\"smooth\""}},
        {"samples", samples},
        {"below", {"0", "0.985", "2"}},
        {"sample_weight", {"0", "2", "16"}},
        {"alpha", {"0.01", "0.2", "1"}},
        {"eager", {"0", "8", "64"}}},
       true,
       largest_ratio * (1.0 + soak_rounding)},
      {"guided",
       "afis_guided",
       {},
       {{"guidance", {"\"split_half\"", "\"spvg\"", "\"ccv\"", "\"ocv\"", "\"ocv_seed\""}},
        {"max_samples", {"8", "16", "32"}},
        {"kappa", {"0", "0.2", "1"}},
        {"eta", {"0.001", "0.2", "1"}}},
       true,
       4.0,
       0.1},
      {"accumulated",
       "burley",
       {"accumulate.json"},
       {{"accumulate_weight", {"0.001", "0.1", "1"}}, {"accumulate_clip", {"0", "1.5", "64"}}},
       true,
       8.0,
       1.0},
      {"by_tile",
       "hybrid_afis_separable",
       {},
       {{"samples", samples},
        {"min_contrast", {"0", "0.01", "4"}},
        {"history", {"\"off\"", "\"camera\"", "\"velocity\""}},
        {"taps", {"\"11\"", "\"25\""}}},
       true,
       8.0,
       1.0},
      {"blended", "sap_blend", {}, {{"variant", {"\"base\"", "\"smooth\""}}}},
  };
}

} // namespace dermis::abi_test
