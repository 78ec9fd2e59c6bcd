#include "json_text.hpp"

namespace metier::virtual_edo {
namespace {

// Copying JSON goes one call deeper for each level.
constexpr int kDeepest = 32;

bool isTooDeep(std::string_view text) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char character = text[i];
        if (in_string && character == '\\') {
            ++i;
        } else if (character == '"') {
            in_string = !in_string;
        } else if (!in_string && (character == '{' || character == '[')) {
            if (++depth > kDeepest) {
                return true;
            }
        } else if (!in_string && (character == '}' || character == ']')) {
            --depth;
        }
    }
    return false;
}

}  // namespace

Json parseJson(std::string_view text) {
    if (isTooDeep(text)) {
        return Json(Json::value_t::discarded);
    }
    return Json::parse(text, nullptr, false);
}

std::string toText(const Json& message) {
    return message.dump(-1, ' ', true, Json::error_handler_t::replace);
}

}  // namespace metier::virtual_edo
