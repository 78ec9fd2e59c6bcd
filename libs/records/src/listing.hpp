#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "database.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

inline constexpr std::size_t kLargestPage = 10'000;

/// Finds the newest executions that fit a filter.
///
/// What the filter says of names, states and reasons is answered by the few rows of `kinds`, what
/// it says of texts by those of `notes` as well. Of each that fits, an index has the newest
/// executions ready: no more rows are looked at than are wanted, whatever the filter.
class Search {
public:
    Search(Database& database, const Filter& filter, const Page& page);

    /// Numbers, newest start first, up to Page::count + 1.
    Result<std::vector<std::int64_t>> run();

private:
    using Found = std::pair<std::int64_t, std::int64_t>;  // started, number

    Result<bool> findBounds();
    Result<std::vector<std::int64_t>> kinds(bool with_text);
    Result<std::vector<std::int64_t>> notes();
    Result<void> takeAll();
    Result<void> takeChildren(const std::string& of_kinds);
    Result<void> takeKinds();
    Result<void> takeText();
    Result<void> takeNotes(const std::string& of_kinds);
    Result<void> takeOfEach(const std::string& column, const std::vector<std::int64_t>& values,
                            const std::string& condition);
    Result<void> take(const std::string& sql, std::vector<Cell> more = {});
    static std::string newest(const std::string& condition);
    bool namesKinds() const;

    Database& database_;
    const Filter& filter_;
    const std::size_t count_;
    const std::int64_t before_;
    Found upper_{};           // exclusive
    std::int64_t lower_ = 0;  // started, inclusive
    std::set<Found, std::greater<>> found_;
};

}  // namespace metier::records
