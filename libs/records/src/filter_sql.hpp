#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "database.hpp"
#include "metier/records/store.hpp"

namespace metier::records {

/// Values of a statement's parameters.
class Values {
public:
    explicit Values(std::vector<Cell> values = {}) : all_(std::move(values)) {}

    /// \return the name of its parameter: "$1"
    std::string add(Cell value);
    const std::vector<Cell>& all() const noexcept { return all_; }

private:
    std::vector<Cell> all_;
};

// Conditions of a filter in SQL, each said once, here. One that takes all is TRUE.

/// Names, state and reason of a row of `kinds` or `history`.
std::string namesFit(const Filter& filter, Values& values);
/// Filter::text in the names of a row of `kinds` or `history`.
std::string namesContain(std::string_view text, Values& values);
/// Filter::text in the reason of a row of `notes` or `history`.
std::string reasonContains(std::string_view text, Values& values);
/// All of it, for a row of `history`.
std::string fits(const Filter& filter, Values& values);

}  // namespace metier::records
