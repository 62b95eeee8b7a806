#pragma once
// Formats the message for passes that read what they write. Used before and after settings are
// known.

#include <string>
#include <string_view>

namespace dermis {

struct InPlaceRace {
  std::string_view pass, reading_port, writing_port;
  std::string read, written; // as the pass names them
  std::string substitute;    // resource that replaces `read`; "": none
};
std::string text_of(const InPlaceRace& race);

} // namespace dermis
