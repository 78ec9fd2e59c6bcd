#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "live_values.hpp"
#include "metier/base/clock.hpp"
#include "outbox.hpp"

namespace metier::dashboard {

/// Present state of a skill.
struct SkillState {
    std::string state =
        "Unknown";  ///< Halted, Ready, Running, Suspended; Unknown without its server
    std::string sub_state{};
    std::string step{};                ///< present step of a sequence
    std::optional<double> progress{};  ///< 0 to 1
    std::string reason{};
    std::string reason_text{};
    std::string execution{};  ///< id of the present or the last one
    double since = 0.0;       ///< begin of the state, s since 1970 UTC; 0: not published

    bool operator==(const SkillState&) const = default;
};

/// Holder of control over a controller's skills.
struct ControlState {
    std::string server{};
    std::string controller{};
    std::string owner{};    ///< name that the holder gives itself; empty: nobody
    double lease_ms = 0.0;  ///< left when it was read; 0: no lease
    double until = 0.0;     ///< when it ends without a heartbeat, s since 1970 UTC; 0: no lease
    std::string held_by{};  ///< tab of this dashboard that holds it; empty: none
    /// Name of that tab, if only this page knows that it has control; else empty.
    std::string held_as{};

    bool operator==(const ControlState&) const = default;
};

/// Content of a server, as far as it publishes it.
struct ServerShown {
    std::string name{};
    std::string url{};
    std::string application_uri{};
    bool connected = false;
    std::string error{};                              ///< why there is no connection
    nlohmann::json skills = nlohmann::json::array();  ///< as served
    nlohmann::json arms = nlohmann::json::array();    ///< its own, as served
    nlohmann::json arm{};                             ///< key of the first of them, or null
    nlohmann::json gripper{};                         ///< null: none
    std::set<std::string> uses{};  ///< names of other servers whose skills its own use
};

struct Alarm {
    std::string server{};
    int severity = 0;  ///< 1 to 1000, as OPC 10000-5 grades it
    std::string message{};
    double time = 0.0;  ///< s since 1970 UTC; 0: now
};

/// s since 1970 UTC, to the millisecond; 0 for the epoch.
double secondsOf(UtcTime time);

/// Everything that tabs are shown, and the tabs.
///
/// Each change is sent to all tabs at once; nothing waits for any of them. A tab that is opened
/// gets all there is first, and then every change since. Threading: any.
class Board {
public:
    /// \param cell  name, and whatever else is fixed, as /api/cell has it
    /// \param clock must outlive this
    Board(nlohmann::json cell, const Clock& clock);

    /// Sets the callback for the first tab that comes and the last one that goes, on the thread
    /// that opened or closed it. Call it before the first tab.
    void onWatched(std::function<void(bool watched)> callback);
    /// \param most_bytes that may wait for it
    std::shared_ptr<Outbox> openTab(const std::string& tab, std::size_t most_bytes);
    void closeTab(const std::string& tab);
    bool hasTab(const std::string& tab) const;
    void closeAll();

    /// A server that is to be shown, not connected yet.
    void addServer(const std::string& key, const std::string& name, const std::string& url);
    /// It was asked what it offers; it is connected.
    void setOffer(const std::string& key, ServerShown offer);
    void setDisconnected(const std::string& key, const std::string& error);

    void changeSkill(const std::string& key, const std::function<void(SkillState&)>& change);
    std::optional<SkillState> skill(const std::string& key) const;
    void changeControl(const std::string& key, const std::function<void(ControlState&)>& change);
    void raise(const Alarm& alarm);
    /// A record is new or has changed.
    void noteRecord(std::int64_t number);

    /// Parts of the virtual world, by name: {pose, size, held_by}, as far as known.
    void setParts(const nlohmann::json& parts);
    /// Values that change all the time; sent by tick().
    void changeLive(const std::function<void(LiveValues&)>& change);
    /// Sends what has changed of them since the last call; a beat, if nothing did for a second.
    void tick();

    nlohmann::json cell() const;
    /// Key of the arm that a skill moves; empty: none, or not known.
    /// \param application_uri of its server
    std::string armOf(const std::string& application_uri, const std::string& controller,
                      const std::string& skill) const;

private:
    struct Tab {
        std::string id;
        std::shared_ptr<Outbox> outbox;  // shared with the thread that sends
    };

    void send(const Message& message);
    void sendControl(const std::string& key, const ControlState& state);
    nlohmann::json snapshotFor(const std::string& tab) const;
    nlohmann::json serversJson() const;
    void tellWatched(bool watched);

    const nlohmann::json cell_;
    const Clock& clock_;
    std::function<void(bool)> on_watched_;

    mutable std::mutex mutex_;  // guards all that follows
    std::vector<Tab> tabs_;
    std::vector<std::string> order_;  // names of the servers
    std::map<std::string, ServerShown> servers_;
    std::map<std::string, SkillState> skills_;
    std::map<std::string, ControlState> controls_;
    nlohmann::json parts_ = nlohmann::json::object();
    LiveValues live_;
    SteadyTime last_sent_{};
};

}  // namespace metier::dashboard
