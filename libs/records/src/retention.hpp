#pragma once

#include <cstdint>
#include <optional>

#include "database.hpp"
#include "metier/base/clock.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// Removes executions that are too old or too many, a part in each step.
class RetentionRun {
public:
    RetentionRun(const Retention& keep, UtcTime now) : keep_(keep), now_(now) {}

    /// \return whether there is more to do
    Result<bool> step(Database& database);
    std::uint64_t removed() const noexcept { return removed_; }

private:
    Result<std::uint64_t> excess(Database& database) const;
    Result<std::uint64_t> removeOldest(Database& database, UtcTime before, std::uint64_t most);
    Result<bool> finish(Database& database) const;

    const Retention keep_;
    const UtcTime now_;
    bool age_done_ = false;
    std::optional<std::uint64_t> excess_;  // executions that are still too much
    std::uint64_t removed_ = 0;
};

}  // namespace metier::records
