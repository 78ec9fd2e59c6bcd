#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "database.hpp"
#include "metier/records/execution_row.hpp"

namespace metier::records {

/// Executions of the view `history` that meet `condition`, a WHERE clause without that word.
Result<std::vector<ExecutionRow>> readExecutions(Database& database, std::string_view condition,
                                                 const std::vector<Cell>& values = {});

/// Kinds that are in the store, by all their texts; they are never removed.
using KindCache = std::unordered_map<std::string, std::int64_t>;

/// Writes rows of executions within a transaction.
class RowWriter {
public:
    RowWriter(Database& database, KindCache& kinds) : database_(database), kinds_(kinds) {}

    /// Takes `count` revisions, which are later than all that others can see; others that write
    /// wait until the end of the transaction. Before anything else.
    Result<void> takeRevisions(std::int64_t count);
    /// Inserts it and gives it its number if that is 0; else updates what can change.
    Result<void> save(ExecutionRow& execution);
    /// The number of an execution that may be in the store already; 0: it is not.
    Result<std::int64_t> numberOf(const ExecutionRow& execution);
    Result<void> addPart(std::int64_t part, const std::string& events, const Bytes& samples);

private:
    Result<std::int64_t> kindOf(const ExecutionRow& execution);
    Result<std::int64_t> noteOf(const std::string& text);
    Result<std::int64_t> insertOrFind(std::string_view insert, std::string_view find,
                                      std::span<const Argument> values);
    Result<void> insert(ExecutionRow& execution, std::int64_t kind, std::int64_t note);
    Result<void> update(const ExecutionRow& execution, std::int64_t kind, std::int64_t note);

    Database& database_;
    KindCache& kinds_;
    std::int64_t revision_ = 0;
};

}  // namespace metier::records
