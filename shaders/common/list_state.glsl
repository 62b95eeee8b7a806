// State of a list of tiles to which the groups of one dispatch append, in the buffer `list_state`.
// The order of the groups varies, and so does the order of the list. The group that ends last
// writes the arguments of dispatches over the list, and sets the state to 0 again for a later list.
#ifndef DERMIS_LIST_STATE_GLSL
#define DERMIS_LIST_STATE_GLSL

// Word l: tiles of level l that are listed. Lists without levels have level 0 only.
const int state_ended = 4;    // groups that ended
const int state_scatters = 5; // 1 if any tile scatters
// Words that start at 0, by subsurface.classify. The others have one tile of level 4 each.
const int state_words = 8;

// Returns the number of groups of the dispatch.
uint list_groups() { return gl_NumWorkGroups.x * gl_NumWorkGroups.y; }

#endif
