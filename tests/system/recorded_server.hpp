#pragma once

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "metier/base/queue.hpp"
#include "metier/records/store.hpp"
#include "metier_program.hpp"

namespace metier::system_tests {

/// A file of records that servers write, and this test reads.
class RecordFile {
public:
    /// \param folder that exists
    explicit RecordFile(std::filesystem::path folder) : file_(std::move(folder) / "records.db") {}

    const std::filesystem::path& path() const { return file_; }
    /// Arguments of `metier serve`.
    std::vector<std::string> serving(std::vector<std::string> more = {}) const {
        more.insert(more.end(), {"--port", "0", "--records", file_.string()});
        return more;
    }
    /// Throws if there is none.
    std::unique_ptr<records::Store> open() const {
        auto store = records::Store::open(file_.string());
        if (!store) {
            throw std::runtime_error(store.error().message);
        }
        return std::move(*store);
    }
    /// The newest record for which it says true, once there is one; throws after a minute.
    records::ExecutionRow await(const records::Filter& filter,
                                const std::function<bool(const records::ExecutionRow&)>& is) const {
        const auto deadline = inAMinute();
        Queue<int> nothing(1);
        while (std::chrono::steady_clock::now() < deadline) {
            if (auto found = find(filter, is)) {
                return *found;
            }
            static_cast<void>(
                nothing.popUntil(std::chrono::steady_clock::now() + std::chrono::milliseconds(50)));
        }
        throw std::runtime_error("there is no such record of " + filter.skill);
    }
    /// Waits until so many of that skill are over; throws after a minute.
    void awaitEnds(const std::string& skill, std::size_t count) const {
        const auto deadline = inAMinute();
        while (countOfEnds(skill) < count) {
            if (std::chrono::steady_clock::now() > deadline) {
                throw std::runtime_error("there are too few records of " + skill);
            }
        }
    }
    /// The newest one of that skill that is over.
    records::ExecutionRow awaitEnd(const std::string& skill) const {
        return await({.skill = skill}, [](const auto& record) { return record.isOver(); });
    }

private:
    std::size_t countOfEnds(const std::string& skill) const {
        const auto store = records::Store::open(file_.string());
        const auto listed = store ? (*store)->list({.skill = skill}, {})
                                  : Result<records::Listing>(fail(store.error()));
        return listed ? static_cast<std::size_t>(
                            std::count_if(listed->executions.begin(), listed->executions.end(),
                                          [](const auto& record) { return record.isOver(); }))
                      : 0;
    }
    std::optional<records::ExecutionRow> find(
        const records::Filter& filter,
        const std::function<bool(const records::ExecutionRow&)>& is) const {
        const auto store = records::Store::open(file_.string());
        const auto listed =
            store ? (*store)->list(filter, {}) : Result<records::Listing>(fail(store.error()));
        if (listed) {
            for (const auto& record : listed->executions) {
                if (is(record)) {
                    return record;
                }
            }
        }
        return std::nullopt;
    }

    std::filesystem::path file_;
};

}  // namespace metier::system_tests
