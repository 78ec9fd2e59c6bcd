#include "skill_survey.hpp"

#include <algorithm>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "metier/opcua/text.hpp"

namespace metier::app {
namespace {

constexpr std::size_t kAtOnce = 32;

opcua::ClientOptions optionsFor(std::chrono::milliseconds limit) {
    opcua::ClientOptions options;
    options.application_name = "metier survey";
    options.connect_timeout = limit;
    options.call_timeout = limit;
    return options;
}

opcua::Answer<std::vector<SurveyedSkill>> askSkills(opcua::Client& client,
                                                    const IsWanted& is_wanted) {
    auto found = skill_client::findSkills(client);
    if (!found) {
        return tl::unexpected(std::move(found.error()));
    }
    std::vector<SurveyedSkill> skills;
    std::map<opcua::NodeId, ArmFigures> arms;  // by controller
    for (auto& address : *found) {
        auto types = skill_client::typeNames(client, address);
        if (!types) {
            return tl::unexpected(std::move(types.error()));
        }
        SurveyedSkill skill{std::move(address), std::move(*types)};
        if (!is_wanted(skill)) {
            continue;
        }
        if (const auto* controller = skill.address.controller()) {
            const auto [arm, is_new] = arms.try_emplace(controller->node);
            if (is_new) {
                arm->second = figuresOfArm(client, skill.address);
            }
            skill.arm = arm->second;
        }
        skills.push_back(std::move(skill));
    }
    return skills;
}

/// The questions to one server, which another thread may cut short.
class Interview {
public:
    Result<std::vector<SurveyedSkill>> ask(const std::string& url, const IsWanted& is_wanted,
                                           std::chrono::milliseconds limit) {
        auto client = opcua::Client::connect(url, optionsFor(limit));
        if (!client) {
            return fail(client.error().code, opcua::sanitise(client.error().message));
        }
        {
            const std::lock_guard lock(mutex_);
            if (cut_) {
                return late();
            }
            client_ = std::move(*client);
        }
        auto skills = askSkills(*client_, is_wanted);
        const std::lock_guard lock(mutex_);
        if (skills && !cut_) {
            return std::move(*skills);
        }
        return cut_ ? late() : fail(skills.error().code, opcua::sanitise(skills.error().message));
    }

    void cut() {
        opcua::Client* client = nullptr;
        {
            const std::lock_guard lock(mutex_);
            cut_ = true;
            client = client_.get();
        }
        if (client != nullptr) {
            static_cast<void>(client->close());  // what waits for an answer ends
        }
    }

private:
    static tl::unexpected<Error> late() { return fail(Errc::timeout, "it did not answer in time"); }

    std::mutex mutex_;
    bool cut_ = false;
    std::unique_ptr<opcua::Client> client_;
};

/// Servers that are asked at the same time, each by a thread of its own.
class Round {
public:
    Round(std::vector<discovery::FoundServer> servers, const IsWanted& is_wanted,
          std::chrono::milliseconds limit)
        : servers_(std::move(servers)),
          interviews_(servers_.size()),
          answers_(servers_.size()),
          open_(servers_.size()) {
        for (std::size_t i = 0; i < servers_.size(); ++i) {
            threads_.emplace_back([this, i, &is_wanted, limit] {
                auto answer = interviews_[i].ask(servers_[i].url, is_wanted, limit);
                const std::lock_guard lock(mutex_);
                answers_[i] = std::move(answer);
                --open_;
                ended_.notify_all();
            });
        }
    }

    std::vector<SurveyedServer> take(std::chrono::steady_clock::time_point deadline) {
        await(deadline);
        threads_.clear();  // all end now
        std::vector<SurveyedServer> result;
        for (std::size_t i = 0; i < servers_.size(); ++i) {
            result.push_back({std::move(servers_[i]), std::move(*answers_[i])});
        }
        return result;
    }

private:
    /// At the deadline those that are left are cut short, all at the same time.
    void await(std::chrono::steady_clock::time_point deadline) {
        std::vector<std::jthread> cutters;
        std::unique_lock lock(mutex_);
        ended_.wait_until(lock, deadline, [this] { return open_ == 0; });
        for (std::size_t i = 0; i < servers_.size(); ++i) {
            if (!answers_[i]) {
                cutters.emplace_back([this, i] { interviews_[i].cut(); });
            }
        }
        lock.unlock();
        cutters.clear();
    }

    std::vector<discovery::FoundServer> servers_;
    std::vector<Interview> interviews_;
    std::vector<std::optional<Result<std::vector<SurveyedSkill>>>> answers_;
    std::size_t open_;
    std::mutex mutex_;
    std::condition_variable ended_;
    std::vector<std::jthread> threads_;
};

}  // namespace

std::vector<SurveyedServer> survey(const std::vector<discovery::FoundServer>& servers,
                                   const IsWanted& is_wanted, std::chrono::milliseconds limit) {
    std::vector<SurveyedServer> result;
    for (std::size_t begin = 0; begin < servers.size(); begin += kAtOnce) {
        const auto first = servers.begin() + static_cast<std::ptrdiff_t>(begin);
        const auto count = std::min(kAtOnce, servers.size() - begin);
        Round round({first, first + static_cast<std::ptrdiff_t>(count)}, is_wanted, limit);
        auto answers = round.take(std::chrono::steady_clock::now() + limit);
        std::move(answers.begin(), answers.end(), std::back_inserter(result));
    }
    return result;
}

bool isA(const SurveyedSkill& skill, const std::string& type) {
    const auto matches = [&type](const std::string& name) {
        return name == type || name == type + "Type";
    };
    return std::any_of(skill.types.begin(), skill.types.end(), matches) ||
           matches(skill.address.name) || matches(skill.address.name + "Type");
}

}  // namespace metier::app
