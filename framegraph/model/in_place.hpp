#pragma once
// Passes that read what they write: the one message for it, before settings are known and after.

#include <string>
#include <string_view>

namespace dermis {

struct InPlaceRace {
  std::string_view pass, reading_port, writing_port;
  std::string read, written; // as the pass names them
  std::string placeholder;   // what is read in place of `read`; "": nothing else
};
std::string text_of(const InPlaceRace& race);

} // namespace dermis
