#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "either_database.hpp"
#include "metier/records/store.hpp"
#include "recorded.hpp"

namespace metier::records {

/// A store that recorders of the test write into, in both databases.
class EitherStore : public EitherDatabase {
protected:
    std::unique_ptr<Store> store() const {
        auto opened = Store::open(url_);
        if (!opened) {
            throw std::runtime_error(opened.error().message);
        }
        return std::move(*opened);
    }
    /// Executions of two servers; "a" to "f" start one after another, one a second.
    void recordSix() const {
        const auto ur5 = recorderOf(url_);
        const auto edo = recorderOf(url_, "urn:test:edo");
        int second = 0;
        for (const auto* id : {"a", "b", "c", "d", "e", "f"}) {
            auto execution = moveOf(id, at(1'000 * second));
            const bool even = second++ % 2 == 0;
            execution.skill = even ? "JointPtpMoveSkill" : "CartesianLinearMoveSkill";
            execution.user = second > 3 ? "ben" : "anna";
            execution.server_name = even ? "ur5" : "edo";
            recordOne(even ? *ur5 : *edo, execution,
                      second == 3 ? halted(at(9'000), "axis 2: 3.5 rad/s over limit 3.1 rad/s")
                                  : finished(at(9'000)));
            ASSERT_TRUE((even ? *ur5 : *edo).flush(soon()));
        }
    }
    std::vector<std::string> ids(const Filter& filter, const Page& page = {}) const {
        const auto listing = store()->list(filter, page);
        EXPECT_TRUE(listing) << listing.error().message;
        std::vector<std::string> result;
        for (const auto& execution : listing->executions) {
            result.push_back(execution.id);
        }
        return result;
    }
};

}  // namespace metier::records
