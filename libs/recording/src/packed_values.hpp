#pragma once

#include <string>
#include <string_view>

#include "metier/recording/packed_json.hpp"
#include "metier/skill/value.hpp"

namespace metier::recording {

// Values as bytes: packing one is a copy, where telling it as JSON takes a microsecond or more.
// packedJson() makes JSON of them on whichever thread, of whichever process, has the time.

/// Replaces `packed`, whose memory is used again.
void pack(const skill::ValueMap& values, std::string& packed);
std::string packed(const skill::Value& value);
/// JSON that is to stay as it is.
std::string packedText(std::string_view json);

}  // namespace metier::recording
