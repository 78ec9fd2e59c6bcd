#include "rosbridge.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "rosbridge_json.hpp"

namespace metier::virtual_edo {
namespace {

/// Most things of one kind that a client may have open.
constexpr std::size_t kMost = 256;

constexpr std::array<std::string_view, 4> kLevels{"none", "error", "warning", "info"};

/// Ends one use of a topic, or all of them if the id is empty.
template <typename Uses, typename IdsOf>
void endUse(Uses& uses, const std::string& topic, const std::string& id, IdsOf ids_of) {
    const auto use = uses.find(topic);
    if (use == uses.end()) {
        return;
    }
    ids_of(use->second).erase(id);
    if (id.empty() || ids_of(use->second).empty()) {
        uses.erase(use);
    }
}

}  // namespace

Rosbridge::Rosbridge(const MessageTypes& types, RosGraph graph, UtcTime started)
    : types_(types), graph_(std::move(graph)) {
    serveRosApi(graph_, [this, started] {
        return started + std::chrono::duration_cast<UtcTime::duration>(now_.time_since_epoch());
    });
}

Rosbridge::ClientId Rosbridge::addClient(Send send) {
    clients_[++last_id_].send = std::move(send);
    return last_id_;
}

void Rosbridge::removeClient(ClientId id) {
    clients_.erase(id);
}

void Rosbridge::receive(ClientId id, std::string_view text) {
    const auto client = clients_.find(id);
    if (client != clients_.end()) {
        receiveFrom(client->second, text);
    }
}

void Rosbridge::receiveFrom(Client& client, std::string_view text) {
    const Json request = parseJson(text);
    if (!request.is_object()) {
        // The real bridge waits for the rest of the JSON, which never comes in a message of its
        // own.
        sendStatus(client, "a message is one JSON object", Json::object());
        return;
    }
    if (auto done = perform(client, request); !done) {
        sendStatus(client, done.error().message, request);
    }
}

Result<void> Rosbridge::perform(Client& client, const Json& request) {
    static const std::map<std::string, Operation, std::less<>> kOperations{
        {"advertise", &Rosbridge::advertise},     {"unadvertise", &Rosbridge::unadvertise},
        {"publish", &Rosbridge::publishFrom},     {"subscribe", &Rosbridge::subscribe},
        {"unsubscribe", &Rosbridge::unsubscribe}, {"call_service", &Rosbridge::callService},
        {"set_level", &Rosbridge::setLevel},      {"status_level", &Rosbridge::setLevel},
        {"fragment", &Rosbridge::takeFragment},
    };
    const auto name = optionalText(request, "op");
    if (!request.contains("op") || !name) {
        return fail(Errc::invalid_argument,
                    "Received a message without an op. All messages "
                    "require 'op' field");
    }
    const auto operation = kOperations.find(*name);
    if (operation == kOperations.end()) {
        return fail(Errc::not_supported, fmt::format("Unknown operation: {}", *name));
    }
    const auto size = request.find("fragment_size");
    if (size != request.end() && size->is_number_unsigned() && size->get<std::uint64_t>() > 0) {
        client.fragment_size = size->get<std::size_t>();
    }
    auto done = (this->*operation->second)(client, request);
    if (!done) {
        done.error().message = *name + ": " + done.error().message;
    }
    return done;
}

Result<void> Rosbridge::establish(const std::string& topic, const Json& request) {
    METIER_ASSIGN(const auto type, optionalText(request, "type"));
    const auto known = graph_.topics.find(topic);
    if (known != graph_.topics.end()) {
        if (!type.empty() && type != known->second) {
            return fail(Errc::type_mismatch,
                        fmt::format("Tried to register topic {} with type {} but it is already "
                                    "established with type {}",
                                    topic, type, known->second));
        }
        return {};
    }
    if (type.empty()) {
        return fail(Errc::not_found,
                    fmt::format("Cannot infer topic type for topic {} as it is not "
                                "yet advertised",
                                topic));
    }
    if (!types_.has(type) || graph_.topics.size() > kMost) {
        return fail(Errc::not_found, fmt::format("Unable to import {}", type));
    }
    graph_.topics.emplace(topic, type);
    return {};
}

Result<void> Rosbridge::advertise(Client& client, const Json& request) {
    METIER_ASSIGN(const auto topic, requiredText(request, "topic"));
    METIER_TRY(requiredText(request, "type"));
    METIER_TRY(establish(topic, request));
    auto& ids = client.advertised[topic];
    if (ids.size() < kMost) {
        ids.insert(requestId(request));
    }
    return {};
}

Result<void> Rosbridge::unadvertise(Client& client, const Json& request) {
    METIER_ASSIGN(const auto topic, requiredText(request, "topic"));
    endUse(
        client.advertised, topic, requestId(request), [](auto& ids) -> auto& { return ids; });
    return {};
}

Result<void> Rosbridge::publishFrom(Client&, const Json& request) {
    METIER_ASSIGN(const auto topic, requiredText(request, "topic"));
    METIER_TRY(establish(topic, request));
    METIER_ASSIGN(const auto message,
                  types_.complete(graph_.topics.find(topic)->second,
                                  request.contains("msg") ? request["msg"] : Json::object()));
    publish(topic, message);
    graph_.on_message(topic, message);
    return {};
}

Result<void> Rosbridge::subscribe(Client& client, const Json& request) {
    METIER_ASSIGN(const auto topic, requiredText(request, "topic"));
    METIER_ASSIGN(const auto throttle, optionalCount(request, "throttle_rate"));
    METIER_ASSIGN(const auto queue, optionalCount(request, "queue_length"));
    METIER_ASSIGN(const auto compression, optionalText(request, "compression"));
    METIER_TRY(establish(topic, request));
    auto& wishes = client.subscriptions[topic].wishes;
    if (wishes.size() < kMost) {
        wishes[requestId(request)] = {.throttle_ms = throttle, .queue_length = queue};
    }
    if (!compression.empty() && compression != "none") {
        // Clients recognise a compressed message by its op, so they understand an uncompressed one.
        sendStatus(client,
                   fmt::format("subscribe: there is no compression {}: {} is sent without",
                               compression, topic),
                   request);
    }
    return {};
}

Result<void> Rosbridge::unsubscribe(Client& client, const Json& request) {
    METIER_ASSIGN(const auto topic, requiredText(request, "topic"));
    endUse(
        client.subscriptions, topic, requestId(request),
        [](auto& subscription) -> auto& { return subscription.wishes; });
    return {};
}

Result<void> Rosbridge::callService(Client& client, const Json& request) {
    METIER_ASSIGN(const auto named, requiredText(request, "service"));
    const std::string service = named.substr(0, named.find('#'));
    const auto answer = call(service, request.contains("args") ? request["args"] : Json::object());
    Json response{{"op", "service_response"}, {"service", named}};
    response["values"] = answer ? *answer : Json(answer.error().message);
    response["result"] = answer.has_value();
    if (request.contains("id") && request["id"].is_primitive()) {
        response["id"] = request["id"];
    }
    send(client, toText(response));
    if (!answer) {
        return fail(answer.error());
    }
    return {};
}

Result<Json> Rosbridge::call(const std::string& service, const Json& arguments) const {
    // A name without slash begins at the root, as on the robot: newer roslib calls rosapi/topics.
    const auto known = graph_.services.find(service.starts_with('/') ? service : '/' + service);
    if (known == graph_.services.end()) {
        return fail(Errc::not_found, fmt::format("Service {} does not exist", service));
    }
    METIER_ASSIGN(const auto whole,
                  types_.completeArguments(known->second.type + ".Request", arguments));
    const auto answer = known->second.call(whole);
    return answer ? types_.complete(known->second.type + ".Response", *answer) : answer;
}

Result<void> Rosbridge::setLevel(Client& client, const Json& request) {
    METIER_ASSIGN(const auto level, requiredText(request, "level"));
    const auto* const known = std::find(kLevels.begin(), kLevels.end(), level);
    if (known == kLevels.end()) {
        return fail(Errc::invalid_argument, "level is none, error, warning or info");
    }
    client.level = static_cast<int>(known - kLevels.begin());
    return {};
}

Result<void> Rosbridge::takeFragment(Client& client, const Json& request) {
    const auto data = requiredText(request, "data");
    const auto number = optionalCount(request, "num");
    const auto total = optionalCount(request, "total");
    const std::string id = requestId(request);
    if (!data || !number || !total || id.empty() || *total < 1 || *number >= *total ||
        static_cast<std::size_t>(*total) > kMost ||
        (client.fragments.size() >= kMost && !client.fragments.contains(id))) {
        return fail(Errc::invalid_argument,
                    "needs id, data, num and total, num below total, total "
                    "at most 256");
    }
    auto& parts = client.fragments[id];
    parts.resize(static_cast<std::size_t>(*total));
    parts[static_cast<std::size_t>(*number)] = *data;
    if (std::any_of(parts.begin(), parts.end(), [](const auto& part) { return !part; })) {
        return {};
    }
    std::string whole;
    for (const auto& part : parts) {
        whole += *part;
    }
    client.fragments.erase(id);
    const Json message = parseJson(whole);
    if (!message.is_object() || optionalText(message, "op").value_or("fragment") == "fragment") {
        return fail(Errc::invalid_argument, "the fragments are no message together");
    }
    return perform(client, message);
}

}  // namespace metier::virtual_edo
