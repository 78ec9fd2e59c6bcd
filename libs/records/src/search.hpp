#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "database.hpp"
#include "filter_sql.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

inline constexpr std::size_t kLargestPage = 10'000;

/// Finds the newest executions that fit a filter.
///
/// The few rows of `kinds` answer what the filter says of names, states and reasons, those of
/// `notes` what it says of texts as well. An index has the newest executions of each ready: no more
/// rows are looked at than are wanted, whatever the filter.
class Search {
public:
    Search(Database& database, const Filter& filter, const Page& page);

    /// Numbers, newest start first, up to Page::count + 1.
    Result<std::vector<std::int64_t>> run();

private:
    using Found = std::pair<std::int64_t, std::int64_t>;  // started, number
    using Numbers = std::vector<std::int64_t>;

    Result<bool> findBounds();
    Result<Numbers> kinds(const std::string& condition, const Values& values);
    Result<void> takeChildren();
    Result<void> takeKinds();
    Result<void> takeText();
    Result<void> takeNotes(const std::string& of_kinds);
    Result<void> takeOfEach(const std::string& column, const Numbers& numbers,
                            const std::string& condition);
    Result<void> take(const std::string& sql, const Values& values);
    Values bounds() const;
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
