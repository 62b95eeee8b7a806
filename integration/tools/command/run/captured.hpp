#pragma once
// Captured frames as apply and reference want them: checked before anything is written, read one at a time,
// in the words of the C interface.

#include "integration/tools/command/session.hpp"
#include "integration/tools/files/capture.hpp"

#include <dermis/dermis.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct CapturedSequence {
  std::vector<std::filesystem::path> folders; // of the frames, in order
  std::vector<std::string> names;             // of the frames, for output folders
  std::filesystem::path profiles;             // folder of the profiles that frames name
  std::vector<std::string> roots;             // that else may be read from
  uint64_t sanitised_values = 0;              // not finite or negative; taken as 0
};

// Folder of the profiles that frames name: what --profiles says, else configs/profiles.
std::filesystem::path profiles_folder(const std::string& option);

// Reads every frame once, so that all problems are said before work begins. `profiles` "": configs/profiles.
// nullopt when it has been said what is wrong.
std::optional<CapturedSequence> check_sequence(const Session& session, const std::string& folder,
                                               const std::string& profiles,
                                               const std::vector<std::string>& roots);
// Frame number `index` again; nullopt if it is no longer what it was.
std::optional<CapturedFrame> load_frame(const CapturedSequence& sequence, size_t index);

// The text of a profile file with exactly these numbers.
std::string profile_as_json(const subsurface::Profile& profile);

// Camera, rectangle and units, for depth in world units; bindings, command buffer and frame numbers stay
// empty.
dermis_frame c_frame(const FrameDescription& frame);

// A capture's matrices are without jitter, those of the C interface with it.
subsurface::Matrix4 with_jitter(const subsurface::Matrix4& clip_from_view, const FrameDescription& frame);
subsurface::Matrix4 without_jitter(const subsurface::Matrix4& clip_from_view, const FrameDescription& frame);

} // namespace dermis::tools
