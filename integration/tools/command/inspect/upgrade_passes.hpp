#pragma once
// Converts passes of version 1 whose ports version 2 replaced by others.

#include "integration/tools/command/inspect/upgrade_edits.hpp"

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

// Resources that a file has to declare in addition, by name: the entry of "added_ports" in
// docs/renames.json.
using AddedResources = std::map<std::string, std::string_view>;

// subsurface.separable reads the light and the view depth that subsurface.separable_setup writes,
// in place of light, material and depth. `passes`: the passes of the file, in order.
void upgrade_separable(TextEdits& edits, const std::vector<NodeId>& passes, AddedResources& added);
// The surface-aware pyramid keeps only r and g of a level's light in the image at its port `light`.
void upgrade_level_light(TextEdits& edits, const std::vector<NodeId>& passes);
// Filtered importance sampling reads levels 1 to 8 as mips of one image.
void upgrade_levels(TextEdits& edits, const std::vector<NodeId>& passes, AddedResources& added);
// subsurface.tile_variance reads the levels and the depth that the file's subsurface.afis_tiles
// reads, and writes tile_d.
void upgrade_tile_variance(TextEdits& edits, const std::vector<NodeId>& passes,
                           AddedResources& added);

} // namespace dermis::tools
