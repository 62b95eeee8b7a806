#pragma once
// Captured frames for apply and reference: all checked before output is written, read one at a
// time, and converted to types of the C interface.

#include "integration/tools/command/session.hpp"
#include "integration/tools/files/capture.hpp"

#include <dermis/dermis.h>

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

struct CapturedSequence {
  std::vector<std::filesystem::path> folders; // of the frames, in order
  std::vector<std::string> names;             // of the frames, for output folders
  std::filesystem::path profiles;             // folder of the profiles that frames name
  std::vector<std::string> roots;             // additional folders that may be read from
  uint64_t sanitised_values = 0;              // non-finite or negative values; replaced by 0
};

// Returns the folder of --profiles, or else configs/profiles.
std::filesystem::path profiles_folder(const std::string& option);

// Reads every frame once, so that all problems are reported before work begins. `profiles` "" means
// configs/profiles. Returns nullopt after reporting the problems.
std::optional<CapturedSequence> check_sequence(const Session& session, const std::string& folder,
                                               const std::string& profiles,
                                               const std::vector<std::string>& roots);
// Reads frame number `index` again. Returns nullopt if the frame changed and is no longer valid.
std::optional<CapturedFrame> load_frame(const CapturedSequence& sequence, size_t index);

// Warns if the folder of --out has images of an earlier run of `verb`. `images`: names of the
// images of a frame that the verb writes or removes.
void warn_of_earlier(std::string_view verb, const std::string& folder,
                     const CapturedSequence& sequence,
                     std::initializer_list<std::string_view> images);

// Returns the text of a profile file with exactly these numbers.
std::string profile_as_json(const subsurface::Profile& profile);

// Returns camera, rectangle and units, for depth in world units. Bindings, command buffer and frame
// numbers stay empty.
dermis_frame c_frame(const FrameDescription& frame);

// Add or remove the jitter. Captures store matrices without jitter; the C interface takes matrices
// with jitter.
subsurface::Matrix4 with_jitter(const subsurface::Matrix4& clip_from_view,
                                const FrameDescription& frame);
subsurface::Matrix4 without_jitter(const subsurface::Matrix4& clip_from_view,
                                   const FrameDescription& frame);

} // namespace dermis::tools
