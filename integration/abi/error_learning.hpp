#pragma once
// Measured errors in the choice by budget: which frames are probed, and what a probed frame teaches
// the error correction.

#include "integration/abi/chooser.hpp"

namespace dermis::abi {

// Returns whether probes can tell the configuration's error. Their reference only sees the screen,
// so light that rays find beyond it is not an error.
bool is_probed(const choice::ErrorModel& errors, const choice::Configuration& configuration);
// Returns the technique whose correction applies. Samples of tiles change a technique's error by
// almost the same factor on all scenes, so both have one correction. Selected tiles show the
// technique that probes measure in all tiles.
int32_t corrected_technique(const choice::ErrorCorrection& correction,
                            const choice::Configuration& configuration);
// Learns the ratio of the error that the probe measured in a frame to the error that the table
// predicts. Allocates nothing.
void learn_error(Chooser& chooser, const choice::Configuration& configuration,
                 const FrameChoice& of_frame);
// Returns whether the error of what runs is being measured: the newest recorded frame belongs to
// the first ones of a technique whose error was not known.
bool is_learning(const Chooser& chooser, const CompiledGraph& compiled_graph);
// Decides whether the error of a frame with this content is probed in any case, and whether its
// error is the technique's. Expects FrameChoice::cut. `scatters`: there is something to probe.
void plan_probe(FrameChoice& frame, const Chooser& chooser,
                const choice::Configuration& configuration, const choice::FrameKey& key,
                bool scatters);
// Corrects the plan of a frame in which a history is invalid.
void restart_histories(FrameChoice& frame, const choice::Configuration& configuration);

} // namespace dermis::abi
