#include "rosbridge_json.hpp"

#include <algorithm>

namespace metier::virtual_edo {
namespace {

// Copying JSON goes one call deeper for each level.
constexpr int kDeepest = 32;

constexpr std::int64_t kLargestCount = 1'000'000'000;

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

std::string requestId(const Json& request) {
    const auto id = request.find("id");
    if (id == request.end() || id->is_null()) {
        return {};
    }
    return id->is_string() ? id->get<std::string>() : id->is_number() ? id->dump() : "";
}

Result<std::string> requiredText(const Json& request, const char* field) {
    if (!request.contains(field)) {
        return fail(Errc::invalid_argument,
                    fmt::format("Expected a {} field but none was found.", field));
    }
    return optionalText(request, field);
}

Result<std::string> optionalText(const Json& request, const char* field) {
    const auto value = request.find(field);
    if (value == request.end()) {
        return std::string();
    }
    if (!value->is_string()) {
        return fail(Errc::invalid_argument,
                    fmt::format("Expected field {} to be one of <type 'str'>.", field));
    }
    return value->get<std::string>();
}

Result<std::int64_t> optionalCount(const Json& request, const char* field) {
    const auto value = request.find(field);
    if (value == request.end() || value->is_null()) {
        return 0;
    }
    if (!value->is_number_integer()) {
        return fail(Errc::invalid_argument,
                    fmt::format("Expected field {} to be one of <type 'int'>.", field));
    }
    if (value->is_number_unsigned()) {
        return static_cast<std::int64_t>(
            std::min(value->get<std::uint64_t>(), static_cast<std::uint64_t>(kLargestCount)));
    }
    return std::max<std::int64_t>(value->get<std::int64_t>(), 0);
}

}  // namespace metier::virtual_edo
