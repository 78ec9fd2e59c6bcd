#include "reply.hpp"

#include <fmt/format.h>

#include <string>

#include "outbox.hpp"

namespace metier::dashboard {
namespace {

constexpr std::size_t kLongestText = 1'000;
/// Deepest level of JSON that is accepted: copying and printing go one call deeper for each level.
constexpr int kDeepest = 32;

int statusOf(Errc code) {
    switch (code) {
        case Errc::invalid_argument:
        case Errc::type_mismatch:
            return 400;
        case Errc::access_denied:
            return 403;
        case Errc::not_found:
            return 404;
        case Errc::already_exists:
        case Errc::invalid_state:
        case Errc::locked:
        case Errc::resource_unavailable:
            return 409;
        case Errc::out_of_range:
        case Errc::unreachable:
        case Errc::limit_violated:
            return 422;
        case Errc::not_supported:
            return 501;
        case Errc::connection_lost:
            return 502;
        case Errc::timeout:
            return 504;
        default:
            return 500;
    }
}

}  // namespace

Reply errorReply(const Error& error) {
    return errorReply(statusOf(error.code), toString(error.code), error.message);
}

Reply errorReply(int status, std::string_view code, std::string_view message) {
    return {status, {{"error", {{"code", code}, {"message", message}}}}};
}

void write(const Reply& reply, httplib::Response& response) {
    response.status = reply.status;
    response.set_header("Cache-Control", "no-store");
    response.set_content(dump(reply.body), "application/json");
}

Result<nlohmann::json> parseBody(std::string_view body) {
    bool too_deep = false;
    const auto note = [&too_deep](int depth, nlohmann::json::parse_event_t /*event*/,
                                  nlohmann::json& /*value*/) {
        too_deep = too_deep || depth > kDeepest;
        return !too_deep;
    };
    auto parsed = nlohmann::json::parse(body, note, false);
    if (too_deep) {
        return fail(Errc::invalid_argument,
                    fmt::format("the body is more than {} levels deep", kDeepest));
    }
    if (!parsed.is_object()) {
        return fail(Errc::invalid_argument, "the body is to be a JSON object");
    }
    return parsed;
}

Result<std::string> textOrNone(const nlohmann::json& object, const char* name) {
    const auto found = object.find(name);
    if (found == object.end() || found->is_null()) {
        return std::string();
    }
    if (!found->is_string() || found->get_ref<const std::string&>().size() > kLongestText) {
        return fail(Errc::invalid_argument,
                    fmt::format("{}: a text of at most {} bytes expected", name, kLongestText));
    }
    return found->get<std::string>();
}

Result<std::string> textIn(const nlohmann::json& object, const char* name) {
    auto text = textOrNone(object, name);
    return text && text->empty() ? fail(Errc::invalid_argument, fmt::format("{} is missing", name))
                                 : text;
}

}  // namespace metier::dashboard
