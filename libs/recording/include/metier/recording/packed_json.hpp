#pragma once

#include <string>
#include <string_view>

namespace metier::recording {

/// JSON of what a ProgramRecorder tells as parameters, intermediate values and results; what its
/// records::Recorder must have as to_json.
/// \return null as text, if it is damaged
std::string packedJson(std::string_view packed);

}  // namespace metier::recording
