#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "metier/opcua/client.hpp"
#include "metier/opcua/server.hpp"

namespace metier::opcua::testing {

/// Records that the hook of a server got, passed from its thread to the test's.
class Records {
public:
    std::function<void(const AuditRecord&)> hook() {
        return [this](const AuditRecord& record) {
            const std::lock_guard lock(mutex_);
            records_.push_back(record);
            changed_.notify_all();
        };
    }
    std::vector<AuditRecord> all() {
        const std::lock_guard lock(mutex_);
        return records_;
    }
    std::vector<AuditRecord> of(AuditKind kind) {
        auto records = all();
        std::erase_if(records, [&](const auto& record) { return record.kind != kind; });
        return records;
    }
    /// Those of a kind, when there are so many. At the deadline those that there are.
    std::vector<AuditRecord> await(AuditKind kind, std::size_t count) {
        std::unique_lock lock(mutex_);
        changed_.wait_for(lock, std::chrono::seconds(10), [&] {
            return static_cast<std::size_t>(std::count_if(
                       records_.begin(), records_.end(),
                       [&](const auto& record) { return record.kind == kind; })) >= count;
        });
        lock.unlock();
        return of(kind);
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<AuditRecord> records_;
};

inline const NodeId kArm{2, "Arm"};
inline const NodeId kStart{2, "Arm.Start"};
inline const NodeId kBeat{2, "Arm.Beat"};
inline const NodeId kTell{2, "Arm.Tell"};

/// A server of the test whose hook keeps its records. It has methods below an Arm: Start(What:
/// BaseDataType), which refuses "refuse"; Beat(), which renews; Tell(), which only reports.
class AuditedServer : public ::testing::Test {
protected:
    static constexpr const char* kServerUri = "urn:test:server";

    void serve(std::optional<ServerSecurity> security = {});
    /// Lets in, with the password "secret", users that are called as their roles.
    void serveClosed();
    static const security::Identity& clientIdentity();
    static security::Identity identityOf(const std::string& name);
    Answer<std::unique_ptr<Client>> connect(const std::string& user,
                                            const std::string& password = "secret",
                                            const security::Identity& identity = clientIdentity());
    std::unique_ptr<Client> connected(const std::string& user);

    Records records_;
    std::filesystem::path folder_;
    std::unique_ptr<Server> server_;

private:
    void trustIn(const std::string& who, const security::Identity& peer);
};

}  // namespace metier::opcua::testing
