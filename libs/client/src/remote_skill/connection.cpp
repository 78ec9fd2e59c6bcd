#include "remote_skill/connection.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "device_lock.hpp"
#include "remote_skill/remote_used_skill.hpp"

namespace metier::client {

using client::AsyncSkill;
using client::SkillAddress;

void UsedSkillLink::post(std::function<void(RemoteUsedSkill&)> work) {
    executor_->post([self = shared_from_this(), work = std::move(work)] {
        if (self->used_ != nullptr) {
            work(*self->used_);
        }
    });
}

Connection::Connection(RemoteServerOptions options, std::shared_ptr<opcua::Client> client)
    : options_(std::move(options)), client_(std::move(client)) {
    watch(*client_);
    thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

Connection::~Connection() {
    thread_.request_stop();
    thread_ = {};
    jobs_.clear();
    client_.reset();  // its thread may report a loss until here
}

opcua::Answer<std::unique_ptr<opcua::Client>> Connection::connect(
    const RemoteServerOptions& options) {
    opcua::ClientOptions client;
    client.application_name = options.application_name;
    client.session_timeout = options.session_timeout;
    client.security = options.security;
    return opcua::Client::connect(options.url, client);
}

void Connection::watch(opcua::Client& client) {
    client.onConnectionLost([this, &client](const opcua::Failure& failure) {
        noteLoss(client, failure.message.empty() ? "the connection is lost" : failure.message);
    });
}

Result<std::shared_ptr<OpenSkill>> Connection::open(const SkillAddress& address,
                                                    const std::shared_ptr<UsedSkillLink>& link) {
    const auto client = present();
    METIER_ASSIGN(auto skill,
                  AsyncSkill::open(*client, address, watchFor(*client, link), locksOf(*client)));
    const auto controller = address.controllerName();
    auto name = controller.empty() ? address.name : fmt::format("{}/{}", controller, address.name);
    const std::lock_guard lock(mutex_);
    const bool known =
        std::any_of(uses_.begin(), uses_.end(), [&](const Use& use) { return use.link == link; });
    if (!known) {
        uses_.push_back({std::move(name), link});
    }
    return std::make_shared<OpenSkill>(OpenSkill{client, std::move(skill)});
}

/// Made anew with each client; it ends with the last skill of that client.
std::shared_ptr<DeviceLocks> Connection::locksOf(opcua::Client& client) {
    const std::lock_guard lock(mutex_);
    auto locks = locked_client_ == &client ? locks_.lock() : nullptr;
    if (!locks) {
        locks = std::make_shared<DeviceLocks>(client);
        locks_ = locks;
        locked_client_ = &client;
    }
    return locks;
}

AsyncSkill::Watch Connection::watchFor(const opcua::Client& client,
                                       const std::shared_ptr<UsedSkillLink>& link) {
    return {.on_transition =
                [link](const skill::TransitionEvent& event) {
                    link->post([event](RemoteUsedSkill& used) { used.onTransition(event); });
                },
            .on_stopping =
                [link](const skill::StoppingEvent& event) {
                    link->post([event](RemoteUsedSkill& used) { used.onStopping(event); });
                },
            .on_missed = [link] { link->post([](RemoteUsedSkill& used) { used.onMissed(); }); },
            .on_ended = [this, &client](const std::string& why) { noteLoss(client, why); }};
}

void Connection::noteLoss(const opcua::Client& client, const std::string& why) {
    {
        const std::lock_guard lock(mutex_);
        if (client_.get() != &client || loss_noted_) {
            return;  // another one has taken its place, or it was heard of in another way before
        }
        loss_noted_ = true;
        lost_ = why;
        if (!away_since_) {
            away_since_ = std::chrono::steady_clock::now();
        }
    }
    changed_.notify_all();
}

std::shared_ptr<opcua::Client> Connection::present() const {
    const std::lock_guard lock(mutex_);
    return client_;
}

void Connection::run(std::function<void()> job) {
    {
        const std::lock_guard lock(mutex_);
        jobs_.push_back(std::move(job));
    }
    changed_.notify_all();
}

std::optional<SteadyTime> Connection::awaySince() const {
    const std::lock_guard lock(mutex_);
    return away_since_;
}

void Connection::work(const std::stop_token& stop) {
    bool connected = true;
    while (!stop.stop_requested()) {
        std::vector<std::function<void()>> jobs;
        std::string lost;
        {
            std::unique_lock lock(mutex_);
            const auto due = [this] { return !jobs_.empty() || !lost_.empty(); };
            if (connected) {
                changed_.wait(lock, stop, due);
            } else {
                changed_.wait_for(lock, stop, options_.retry_interval, due);
            }
            jobs = std::exchange(jobs_, {});
            lost = std::exchange(lost_, {});
        }
        for (auto& job : jobs) {
            job();
        }
        jobs.clear();
        if (!lost.empty()) {
            connected = false;
            lose(lost);
        }
        if (!connected && !stop.stop_requested()) {
            connected = reconnect();
        }
    }
}

void Connection::warn(std::string& last, std::string text) const {
    const auto level = text == last ? spdlog::level::debug : spdlog::level::warn;
    const bool named = text.find(options_.url) != std::string::npos;
    spdlog::log(level, "{}{}{}", named ? "" : options_.url, named ? "" : ": ", text);
    last = std::move(text);
}

void Connection::lose(const std::string& why) {
    warn(reported_loss_, why + "; connecting again");
    std::vector<Use> uses;
    {
        const std::lock_guard lock(mutex_);
        uses = uses_;
    }
    for (const auto& use : uses) {
        use.link->post([why](RemoteUsedSkill& used) { used.lost(why); });
    }
}

std::function<void()> Connection::adoptionOf(const Use& use) {
    const auto address = client::findSkill(*client_, use.skill);
    auto skill = address ? open(*address, use.link)
                         : Result<std::shared_ptr<OpenSkill>>(fail(address.error()));
    const auto now = skill ? (*skill)->skill.now() : opcua::Answer<AsyncSkill::Now>();
    if (!skill || !now) {
        warn(reported_attempt_, fmt::format("{} is not there yet: {}", use.skill,
                                            skill ? now.error().message : skill.error().message));
        return nullptr;
    }
    return [link = use.link, skill = std::move(*skill), now = *now] {
        link->post([skill, now](RemoteUsedSkill& used) { used.adopt(skill, now); });
    };
}

bool Connection::reconnect() {
    auto client = connect(options_);
    if (!client) {
        warn(reported_attempt_, client.error().message);
        return false;
    }
    std::shared_ptr<opcua::Client> former = std::move(*client);
    std::vector<Use> uses;
    {
        const std::lock_guard lock(mutex_);
        client_.swap(former);
        lost_.clear();  // the loss of the former connection
        loss_noted_ = false;
        uses = uses_;
    }
    watch(*present());
    former.reset();  // without the lock: its thread may still report a loss
    // All or none: a used skill that was notified would begin, and be notified again in the next
    // attempt.
    std::vector<std::function<void()>> adoptions;
    for (const auto& use : uses) {
        adoptions.push_back(adoptionOf(use));
        if (adoptions.back() == nullptr) {
            return false;
        }
    }
    {  // before a used skill shows that it is there
        const std::lock_guard lock(mutex_);
        if (lost_.empty()) {
            away_since_.reset();
        }
    }
    for (const auto& adopt : adoptions) {
        adopt();
    }
    spdlog::warn("{}: connected again", options_.url);  // as loud as the report of the loss
    reported_loss_.clear();
    reported_attempt_.clear();
    return true;
}

}  // namespace metier::client
