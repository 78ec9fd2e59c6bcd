#pragma once

#include "metier/http/httplib.hpp"

#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "metier/base/error.hpp"

namespace metier::dashboard {

struct Reply;

/// {"error": {"code": "out_of_range", "message": "..."}} with the HTTP status that fits the code.
Reply errorReply(const Error& error);
Reply errorReply(int status, std::string_view code, std::string_view message);

/// An answer of the API.
struct Reply {
    Reply() = default;
    Reply(int http_status, nlohmann::json content)
        : status(http_status), body(std::move(content)) {}
    /// As errorReply(); METIER_TRY and METIER_ASSIGN answer by it.
    template <typename Failure>
    Reply(const tl::unexpected<Failure>& failed)  // NOLINT(google-explicit-constructor)
        : Reply(errorReply(failed.value())) {}

    int status = 200;
    nlohmann::json body = nlohmann::json::object();
};

/// Writes an answer that no cache keeps.
void write(const Reply& reply, httplib::Response& response);

/// A request's body. Errors: invalid_argument, if it is not a JSON object.
Result<nlohmann::json> parseBody(std::string_view body);

/// The text of that name in a JSON object.
/// Errors: invalid_argument, if there is none or it is longer than 1000 bytes.
Result<std::string> textIn(const nlohmann::json& object, const char* name);
/// The same; empty if there is none.
Result<std::string> textOrNone(const nlohmann::json& object, const char* name);

}  // namespace metier::dashboard
