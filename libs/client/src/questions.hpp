#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "metier/base/clock.hpp"
#include "metier/opcua/client.hpp"

namespace metier::client {

/// A failure that is found on this side.
inline opcua::Failure failureOf(Errc code, std::string text, opcua::StatusCode status) {
    return {{code, std::move(text)}, status, {}};
}
inline opcua::Failure failureOf(Errc code, std::string text) {
    return failureOf(code, std::move(text), opcua::statusFrom(code));
}

/// Requests to a server in which the answers decide about the next requests. A hostile server could
/// give more to ask for without end, or answer slowly: after 30 s, or 50,000 requests, everything
/// else fails with timeout.
///
/// Threading: as Client. Must end before it.
class Questions {
public:
    explicit Questions(opcua::Client& client) : client_(client) {}

    opcua::Answer<std::vector<opcua::Reference>> browse(opcua::BrowseQuery query) {
        METIER_TRY(next());
        return client_.browse(std::move(query));
    }
    opcua::Answer<opcua::Value> read(const opcua::NodeId& node,
                                     opcua::AttributeId attribute = opcua::AttributeId::value) {
        METIER_TRY(next());
        return client_.read(node, attribute);
    }
    opcua::Answer<std::vector<opcua::DataValue>> readMany(std::vector<opcua::ReadItem> items) {
        METIER_TRY(next());
        return client_.readMany(std::move(items));
    }

private:
    opcua::Answer<> next() {
        if (left_-- > 0 && std::chrono::steady_clock::now() < end_) {
            return {};
        }
        return tl::unexpected(failureOf(
            Errc::timeout, "the server goes on publishing more than anybody would look at"));
    }

    opcua::Client& client_;
    SteadyTime end_ = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    int left_ = 50'000;
};

}  // namespace metier::client
