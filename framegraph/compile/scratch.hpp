#pragma once
// Memory of all phases, one member for each, kept between compilations. Internal to compile/.

#include "framegraph/compile/barriers.hpp"
#include "framegraph/compile/phases.hpp"
#include "framegraph/compile/placements.hpp"

namespace dermis {

struct CompileScratch {
  SizeScratch sizes;
  ActivationScratch activation;
  SubresourceScratch subresources;
  VersionScratch versions;
  CullScratch cull;
  BindErrorScratch bind_errors;
  QueueScratch queues;
  UsageScratch usages;
  FormatScratch formats;
  ScheduleScratch schedule;
  PassScratch passes;
  HistoryScratch histories;
  PlacementScratch placements;
  BarrierScratch barriers;
};

} // namespace dermis
