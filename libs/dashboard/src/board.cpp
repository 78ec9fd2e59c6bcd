#include "board.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace metier::dashboard {

using nlohmann::json;

namespace {

json toJson(const std::string& key, const SkillState& state) {
    json shown{{"key", key},
               {"state", state.state},
               {"sub_state", state.sub_state},
               {"step", state.step},
               {"progress", nullptr},
               {"reason", state.reason},
               {"reason_text", state.reason_text},
               {"execution", state.execution},
               {"since", state.since}};
    if (state.progress) {
        shown["progress"] = *state.progress;
    }
    return shown;
}

json toJson(const std::string& key, const ControlState& state, const std::string& tab) {
    json shown{{"key", key},
               {"server", state.server},
               {"controller", state.controller},
               {"owner", state.owner},
               {"mine", !state.owner.empty() && state.held_by == tab}};
    if (state.lease_ms > 0.0) {
        shown["lease_ms"] = state.lease_ms;
        shown["until"] = state.until;
    }
    return shown;
}

}  // namespace

double secondsOf(UtcTime time) {
    constexpr double kThousand = 1e3;
    const auto whole = std::chrono::floor<std::chrono::milliseconds>(time.time_since_epoch());
    return static_cast<double>(whole.count()) / kThousand;
}

Board::Board(json cell, const Clock& clock) : cell_(std::move(cell)), clock_(clock) {}

void Board::onWatched(std::function<void(bool)> callback) {
    on_watched_ = std::move(callback);
}

void Board::tellWatched(bool watched) {
    if (on_watched_) {
        on_watched_(watched);
    }
}

std::shared_ptr<Outbox> Board::openTab(const std::string& tab, std::size_t most_bytes) {
    auto outbox = std::make_shared<Outbox>(most_bytes);
    bool first = false;
    {
        const std::lock_guard lock(mutex_);
        first = tabs_.empty();
        outbox->push(makeMessage("hello", {{"tab", tab}}));
        outbox->push(makeMessage("snapshot", snapshotFor(tab)));
        tabs_.push_back({tab, outbox});
    }
    if (first) {
        tellWatched(true);
    }
    return outbox;
}

void Board::closeTab(const std::string& tab) {
    bool last = false;
    {
        const std::lock_guard lock(mutex_);
        const auto gone = std::erase_if(tabs_, [&](const Tab& one) { return one.id == tab; });
        last = gone > 0 && tabs_.empty();
    }
    if (last) {
        tellWatched(false);
    }
}

bool Board::hasTab(const std::string& tab) const {
    const std::lock_guard lock(mutex_);
    return std::any_of(tabs_.begin(), tabs_.end(), [&](const Tab& one) { return one.id == tab; });
}

void Board::closeAll() {
    const std::lock_guard lock(mutex_);
    for (const auto& tab : tabs_) {
        tab.outbox->close();
    }
}

void Board::send(const Message& message) {
    for (const auto& tab : tabs_) {
        tab.outbox->push(message);
    }
}

void Board::addServer(const std::string& key, const std::string& name, const std::string& url) {
    const std::lock_guard lock(mutex_);
    if (servers_.contains(key)) {
        return;
    }
    order_.push_back(key);
    auto& server = servers_[key];
    server.name = name;
    server.url = url;
    server.error = "not connected yet";
    send(makeMessage("cell", json::object()));
}

void Board::setOffer(const std::string& key, ServerShown offer) {
    const std::lock_guard lock(mutex_);
    auto& server = servers_.at(key);
    const bool same = server.skills == offer.skills && server.arms == offer.arms &&
                      server.gripper == offer.gripper && server.uses == offer.uses &&
                      server.application_uri == offer.application_uri;
    offer.name = server.name;
    offer.url = server.url;
    offer.connected = true;
    server = std::move(offer);
    if (!same) {
        send(makeMessage("cell", json::object()));
    }
    send(makeMessage("server", {{"key", key}, {"connected", true}, {"error", nullptr}}));
    for (auto& [name, control] : controls_) {
        // The server itself shows who has its leases.
        if (control.server == key && !control.held_as.empty() && control.owner.empty()) {
            control.owner = control.held_as;
            sendControl(name, control);
        }
    }
}

void Board::setDisconnected(const std::string& key, const std::string& error) {
    const std::lock_guard lock(mutex_);
    auto& server = servers_.at(key);
    if (!server.connected && server.error == error) {
        return;
    }
    server.connected = false;
    server.error = error;
    send(makeMessage("server", {{"key", key}, {"connected", false}, {"error", error}}));
    for (const auto& skill : server.skills) {
        const auto name = skill.at("key").get<std::string>();
        auto& state = skills_[name];
        state = SkillState{};
        send(makeMessage("skill", toJson(name, state)));
    }
    for (auto& [name, control] : controls_) {
        if (control.server == key) {
            control.owner.clear();
            sendControl(name, control);
        }
    }
}

void Board::changeSkill(const std::string& key, const std::function<void(SkillState&)>& change) {
    const std::lock_guard lock(mutex_);
    auto& state = skills_[key];
    const auto before = state;
    change(state);
    if (state != before) {
        send(makeMessage("skill", toJson(key, state)));
    }
}

std::optional<SkillState> Board::skill(const std::string& key) const {
    const std::lock_guard lock(mutex_);
    const auto found = skills_.find(key);
    return found == skills_.end() ? std::nullopt : std::optional(found->second);
}

void Board::changeControl(const std::string& key,
                          const std::function<void(ControlState&)>& change) {
    const std::lock_guard lock(mutex_);
    auto& state = controls_[key];
    const auto before = state;
    change(state);
    if (state != before) {
        sendControl(key, state);
    }
}

void Board::sendControl(const std::string& key, const ControlState& state) {
    for (const auto& tab : tabs_) {
        tab.outbox->push(makeMessage("control", toJson(key, state, tab.id)));
    }
}

void Board::raise(const Alarm& alarm) {
    const std::lock_guard lock(mutex_);
    send(makeMessage("alarm",
                     {{"server", alarm.server},
                      {"severity", alarm.severity},
                      {"message", alarm.message},
                      {"time", alarm.time > 0.0 ? alarm.time : secondsOf(clock_.utcNow())}}));
}

void Board::noteRecord(std::int64_t number) {
    const std::lock_guard lock(mutex_);
    send(makeMessage("execution", {{"number", number}}));
}

void Board::setParts(const json& parts) {
    const std::lock_guard lock(mutex_);
    const auto before = std::exchange(parts_, parts);
    bool same = before.size() == parts.size();
    for (const auto& [name, part] : parts.items()) {
        same = same && before.contains(name) && before.at(name).at("size") == part.at("size");
        live_.setPart(name, part.at("pose"));
    }
    live_.keepParts(parts);
    if (!same) {
        send(makeMessage("cell", json::object()));
    }
}

void Board::changeLive(const std::function<void(LiveValues&)>& change) {
    const std::lock_guard lock(mutex_);
    change(live_);
}

void Board::tick() {
    constexpr std::chrono::seconds kBeat{1};
    const auto now = clock_.now();
    const std::lock_guard lock(mutex_);
    if (auto changes = live_.changes(clock_.utcNow()); !changes.is_null()) {
        send(makeMessage("live", changes));
        last_sent_ = now;
    } else if (now - last_sent_ >= kBeat) {
        send(makeMessage("beat", {{"t", secondsOf(clock_.utcNow())}}));
        last_sent_ = now;
    }
}

json Board::snapshotFor(const std::string& tab) const {
    json snapshot{{"t", secondsOf(clock_.utcNow())},
                  {"servers", json::array()},
                  {"skills", json::array()},
                  {"controls", json::array()},
                  {"live", live_.all(clock_.utcNow())}};
    for (const auto& key : order_) {
        const auto& server = servers_.at(key);
        snapshot["servers"].push_back({{"key", key},
                                       {"connected", server.connected},
                                       {"error", server.connected ? json() : json(server.error)}});
    }
    for (const auto& [key, state] : skills_) {
        snapshot["skills"].push_back(toJson(key, state));
    }
    for (const auto& [key, state] : controls_) {
        snapshot["controls"].push_back(toJson(key, state, tab));
    }
    return snapshot;
}

json Board::serversJson() const {
    auto servers = json::array();
    for (const auto& key : order_) {
        const auto& server = servers_.at(key);
        servers.push_back({{"key", key},
                           {"name", server.name},
                           {"url", server.url},
                           {"application_uri", server.application_uri},
                           {"connected", server.connected},
                           {"error", server.connected ? json() : json(server.error)},
                           {"arm", server.arm},
                           {"gripper", server.gripper},
                           {"uses", server.uses},
                           {"skills", server.skills}});
    }
    return servers;
}

std::string Board::armOf(const std::string& application_uri, const std::string& controller,
                         const std::string& skill) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [key, server] : servers_) {
        for (const auto& one :
             server.application_uri == application_uri ? server.skills : json::array()) {
            if (one.at("name") == skill && one.at("controller") == controller &&
                one.at("arm").is_string()) {
                return one.at("arm").get<std::string>();
            }
        }
    }
    return {};
}

json Board::cell() const {
    const std::lock_guard lock(mutex_);
    auto cell = cell_;
    cell["servers"] = serversJson();
    cell["arms"] = json::array();
    for (const auto& key : order_) {
        for (const auto& arm : servers_.at(key).arms) {
            cell["arms"].push_back(arm);
        }
    }
    if (cell["world"].is_object()) {
        cell["world"]["parts"] = json::array();
        for (const auto& [name, part] : parts_.items()) {
            cell["world"]["parts"].push_back(part);
            cell["world"]["parts"].back()["name"] = name;
        }
    }
    return cell;
}

}  // namespace metier::dashboard
