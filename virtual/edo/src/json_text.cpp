#include "json_text.hpp"

namespace metier::virtual_edo {
namespace {

// Copying JSON goes one call deeper for each level.
constexpr int kDeepest = 32;

}  // namespace

Json parseJson(std::string_view text) {
    bool too_deep = false;
    const auto note = [&too_deep](int depth, Json::parse_event_t event, Json& /*value*/) {
        const bool begins =
            event == Json::parse_event_t::object_start || event == Json::parse_event_t::array_start;
        too_deep = too_deep || (begins && depth >= kDeepest);
        return !too_deep;
    };
    auto parsed = Json::parse(text, note, false);
    return too_deep ? Json(Json::value_t::discarded) : parsed;
}

std::string toText(const Json& message) {
    return message.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace metier::virtual_edo
